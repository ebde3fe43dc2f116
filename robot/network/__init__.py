"""Characters and robots on several computers: players, robot nodes, and the bus between them.

>>> from cubeling.robot import Emotion
>>> broker, ann = MemoryBroker(), Member("hall", "player", "ann")
>>> client = BusClient(Player(ann, session=1), broker.bus(), clock=lambda: 0.0)
>>> client.endpoint.feel(Emotion(0.8, 0.5, "happy"))
>>> client.bus.open()
>>> client.step()
>>> sorted(topic.rpartition("/")[2] for topic in broker.retained)
['emotion', 'status']
>>> client.close()
"""

from cubeling.robot.network.bus import Bus, BusState, Message
from cubeling.robot.network.client import BusClient
from cubeling.robot.network.endpoint import Endpoint
from cubeling.robot.network.memory import MemoryBroker, MemoryBus
from cubeling.robot.network.mqtt.access import Address, Credentials
from cubeling.robot.network.mqtt.bus import MqttBus
from cubeling.robot.network.node import RobotNode
from cubeling.robot.network.player import Player
from cubeling.robot.network.roster import Roster, RosterEntry
from cubeling.robot.network.topics import Member, Pattern, check_name

__all__ = [
    "Address",
    "Bus",
    "BusClient",
    "BusState",
    "Credentials",
    "Endpoint",
    "Member",
    "MemoryBroker",
    "MemoryBus",
    "Message",
    "MqttBus",
    "Pattern",
    "Player",
    "RobotNode",
    "Roster",
    "RosterEntry",
    "check_name",
]
