from cubeling.robot.conformance.channel import (
    Channel as Channel,
    PortChannel as PortChannel,
    SimulatedChannel as SimulatedChannel,
)
from cubeling.robot.conformance.check import Check as Check
from cubeling.robot.conformance.suite import (
    CheckResult as CheckResult,
    ConformanceReport as ConformanceReport,
    all_checks as all_checks,
    run_checks as run_checks,
    select_checks as select_checks,
)
