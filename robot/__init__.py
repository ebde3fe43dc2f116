"""From an emotion to bytes on a wire, and telemetry back.

>>> import robot
>>> with robot.connect("sim:cubeling") as dino:
...     dino.express(robot.Emotion(valence=0.8, arousal=0.5))
...     dino.telemetry.commanded.label
'happy'
"""

from robot.catalogue import Catalogue, JointLimits
from robot.connection import Robot, connect
from robot.emotion import Emotion
from robot.errors import RobotError
from robot.feeling.feelings import Feelings
from robot.feeling.labels import LABEL_SETS
from robot.feeling.mood import Mood, MoodLine
from robot.feeling.personality import Personality
from robot.ports import SerialPort, serial_ports
from robot.simulators.cubeling.simulator import Simulator
from robot.simulators.port import SimulatedPort
from robot.stepped import SteppedRobot
from robot.telemetry import LinkCounts, LinkState, Telemetry

__all__ = [
    "LABEL_SETS",
    "Catalogue",
    "Emotion",
    "Feelings",
    "JointLimits",
    "LinkCounts",
    "LinkState",
    "Mood",
    "MoodLine",
    "Personality",
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
