from cubeling.robot.network.arbiter import HOLD_S as HOLD_S
from cubeling.robot.network.bus import Bus as Bus, BusState as BusState, Message as Message
from cubeling.robot.network.client import BusClient as BusClient
from cubeling.robot.network.endpoint import Endpoint as Endpoint
from cubeling.robot.network.memory import MemoryBroker as MemoryBroker, MemoryBus as MemoryBus
from cubeling.robot.network.messages import (
    MAX_ENTRIES as MAX_ENTRIES,
    AckMessage as AckMessage,
    ActionMessage as ActionMessage,
    EmotionMessage as EmotionMessage,
    StateMessage as StateMessage,
    StatusMessage as StatusMessage,
)
from cubeling.robot.network.mqtt.access import Address as Address, Credentials as Credentials
from cubeling.robot.network.mqtt.bus import MqttBus as MqttBus
from cubeling.robot.network.node import RobotNode as RobotNode
from cubeling.robot.network.player import MAX_AGE_S as MAX_AGE_S, Player as Player
from cubeling.robot.network.roster import (
    OnMessage as OnMessage,
    Roster as Roster,
    RosterEntry as RosterEntry,
)
from cubeling.robot.network.topics import (
    ANY_NAME as ANY_NAME,
    DEFAULT_SITE as DEFAULT_SITE,
    FURTHER as FURTHER,
    Member as Member,
    Pattern as Pattern,
    Role as Role,
    check_name as check_name,
)
