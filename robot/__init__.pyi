from cubeling.affect.emotion import Emotion as Emotion
from cubeling.robot.contract.catalogue import Catalogue as Catalogue, JointLimits as JointLimits
from cubeling.robot.contract.closeable import Closeable as Closeable
from cubeling.robot.contract.moves import joint_move as joint_move
from cubeling.robot.contract.port import Direction as Direction
from cubeling.robot.contract.telemetry import (
    ClockEstimate as ClockEstimate,
    LinkCounts as LinkCounts,
    LinkState as LinkState,
    LogLine as LogLine,
    Telemetry as Telemetry,
)
from cubeling.robot.errors import RobotError as RobotError
from cubeling.robot.link.connection import connect as connect, protocol_of as protocol_of
from cubeling.robot.link.linked_robot import Robot as Robot
from cubeling.robot.link.ports import SerialPort as SerialPort, serial_ports as serial_ports
from cubeling.robot.link.transport import opener as opener
from cubeling.robot.protocol import messages as messages, timing as timing
from cubeling.robot.protocol.clock import RobotClock as RobotClock
from cubeling.robot.protocol.fields import MessageError as MessageError
from cubeling.robot.protocol.schema import Sender as Sender, unpack as unpack
from cubeling.robot.protocol.wire import FrameReader as FrameReader
from cubeling.robot.simulators import Simulated as Simulated
from cubeling.robot.simulators.cubeling.simulator import Simulator as Simulator
from cubeling.robot.simulators.memory import simulator_of as simulator_of
from cubeling.robot.simulators.port import SimulatedPort as SimulatedPort
from cubeling.robot.simulators.stepped import SteppedRobot as SteppedRobot
