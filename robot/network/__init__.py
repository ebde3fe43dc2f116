"""Characters and robots in several places: players, robots' nodes, and the bus between them.

>>> from robot import Emotion
>>> broker, ann = MemoryBroker(), Member("hall", "player", "ann")
>>> bus = broker.bus()
>>> station = Station(Player(ann, session=1), bus, clock=lambda: 0.0)
>>> station.endpoint.feel(Emotion(0.8, 0.5), "happy")
>>> bus.open()
>>> station.turn()
>>> sorted(topic.rpartition("/")[2] for topic in broker.retained)
['emotion', 'status']
>>> station.close()
"""

from robot.network.bus import Bus, BusState, Letter
from robot.network.endpoint import Endpoint
from robot.network.memory import MemoryBroker, MemoryBus
from robot.network.mqtt.access import Address, Credentials
from robot.network.mqtt.bus import MqttBus
from robot.network.node import RobotNode
from robot.network.player import Player
from robot.network.roster import Roster, Seen
from robot.network.station import Station
from robot.network.topics import Member, Pattern, check_name

__all__ = [
    "Address",
    "Bus",
    "BusState",
    "Credentials",
    "Endpoint",
    "Letter",
    "Member",
    "MemoryBroker",
    "MemoryBus",
    "MqttBus",
    "Pattern",
    "Player",
    "RobotNode",
    "Roster",
    "Seen",
    "Station",
    "check_name",
]
