from cubeling.robot.contract.driver import DRIVERS as DRIVERS
from cubeling.robot.drivers.lines import LineReader as LineReader
