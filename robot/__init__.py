"""From an emotion to bytes on a wire, and telemetry back.

>>> from cubeling import robot
>>> with robot.connect("sim:cubeling") as dino:
...     dino.express(robot.Emotion(valence=0.8, arousal=0.5))
...     dino.telemetry.commanded.label
'happy'
"""

from cubeling.affect import Emotion
from cubeling.robot import drivers as drivers  # registers the protocols
from cubeling.robot.contract.catalogue import Catalogue, JointLimits
from cubeling.robot.contract.telemetry import (
    ClockEstimate,
    LinkCounts,
    LinkState,
    LogLine,
    Telemetry,
)
from cubeling.robot.errors import RobotError
from cubeling.robot.link.connection import connect
from cubeling.robot.link.linked_robot import Robot
from cubeling.robot.link.ports import SerialPort, serial_ports
from cubeling.robot.link.transport import SCHEMES
from cubeling.robot.simulators.cubeling.simulator import Simulator
from cubeling.robot.simulators.memory import open_simulated
from cubeling.robot.simulators.port import SimulatedPort
from cubeling.robot.simulators.stepped import SteppedRobot

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
