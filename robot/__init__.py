"""From an emotion to bytes on a wire, and telemetry back.

>>> import robot
>>> with robot.connect("sim:cubeling") as dino:
...     dino.express(robot.Emotion(valence=0.8, arousal=0.5))
...     dino.telemetry.commanded.label
'happy'
"""

from affect import Emotion
from robot import drivers as drivers  # registers the protocols
from robot.contract.catalogue import Catalogue, JointLimits
from robot.contract.telemetry import ClockEstimate, LinkCounts, LinkState, LogLine, Telemetry
from robot.errors import RobotError
from robot.link.connection import connect
from robot.link.linked_robot import Robot
from robot.link.ports import SerialPort, serial_ports
from robot.link.transport import SCHEMES
from robot.simulators.cubeling.simulator import Simulator
from robot.simulators.memory import open_simulated
from robot.simulators.port import SimulatedPort
from robot.simulators.stepped import SteppedRobot

SCHEMES["sim"] = open_simulated

__all__ = [
    "Catalogue",
    "ClockEstimate",
    "Emotion",
    "JointLimits",
    "LinkCounts",
    "LinkState",
    "LogLine",
    "Robot",
    "RobotError",
    "SerialPort",
    "SimulatedPort",
    "Simulator",
    "SteppedRobot",
    "Telemetry",
    "connect",
    "serial_ports",
]
