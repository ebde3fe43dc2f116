"""Ways of joints that MOVE commands, and what must be seen of them."""

from collections.abc import Sequence
from dataclasses import dataclass

from cubeling.robot.conformance.checks.catalogue import known_joints
from cubeling.robot.conformance.errors import CheckFailed, NotApplicableError
from cubeling.robot.conformance.probe import EFFECT_WITHIN_S, Probe
from cubeling.robot.protocol import messages as m, timing

MIN_RANGE_RAD = 0.2
"""Smallest range of a joint whose movement is told from the noise of its sensor [rad]."""

ANGLE_TOLERANCE_RAD = 0.05
"""Largest distance of a joint from its angle [rad]: servos and sensors are not exact."""

SPARE_TIME = 1.5
"""How much longer a way is to take than at the joint's top speed."""

MIN_DURATION_S = 0.6
"""Shortest duration of a tested way [s]."""

MAX_UNEVENNESS = 0.3
"""How much of its way a joint may be ahead or behind: servos start and stop slowly."""

FAR_RAD = 32.767
"""An angle beyond the limits of all joints [rad]."""

LEVEL = (0.0,) * m.JOINTS_MAX
"""Angles of a MOVE of no joint [rad]."""


@dataclass(frozen=True)
class Way:
    """A joint's way to an angle, for a test."""

    joint: m.Joint

    start: float
    """Its angle before [rad]."""

    goal: float
    """The angle that MOVE names [rad]."""

    duration: float
    """Time for the way [s]."""

    @property
    def bit(self) -> int:
        """Bit of the joint in the masks of MOVE and STATE."""
        return 1 << self.joint.index

    def command(self, number: int) -> m.Move:
        """Return the MOVE of this way."""
        return m.Move(number, self.duration, 0, self.bit, one_angle(self.joint.index, self.goal))


def movable_joints(probe: Probe) -> list[m.Joint]:
    """Open a session, and return the joints of a robot that takes MOVE."""
    joints = known_joints(probe)
    if not probe.open_session().abilities & m.ABILITY_MOVE:
        raise NotApplicableError("it does not take MOVE")
    return joints


def wide_joints(probe: Probe) -> list[m.Joint]:
    """Open a session, and return the joints whose movement is seen; there is one at least."""
    wide = [joint for joint in movable_joints(probe) if joint.high - joint.low >= MIN_RANGE_RAD]
    if not wide:
        raise NotApplicableError(f"no joint turns by {MIN_RANGE_RAD} rad")
    return wide


def choose_way(probe: Probe) -> Way:
    """Open a session, and return a way for the joint that crosses its range in the least time."""
    joint = min(wide_joints(probe), key=crossing_time)
    start = probe.beat("HELLO").joints[joint.index]
    share = 0.2 if start > (joint.low + joint.high) / 2 else 0.8
    goal = round(joint.low + share * (joint.high - joint.low), 3)
    least = abs(goal - start) / max(joint.speed, 1e-3)
    return Way(joint, start, goal, round(max(SPARE_TIME * least, MIN_DURATION_S), 3))


def expect_even(probe: Probe, way: Way, seconds: float) -> None:
    """Command a way, and expect for a time that the joint goes evenly [s]."""
    begin = probe.now
    probe.command(way.command(probe.next_number()))
    end = probe.now + seconds
    while probe.now < end:
        state = probe.keep_alive(timing.BEAT_EVERY)[-1]
        passed = (probe.now - begin) / way.duration
        gone = (state.joints[way.joint.index] - way.start) / (way.goal - way.start)
        if not passed - MAX_UNEVENNESS <= gone <= passed + MAX_UNEVENNESS:
            raise CheckFailed(
                f"joint {way.joint.index} {100 * passed:.0f} % of its way after so much of its "
                f"{way.duration:.1f} s",
                f"{100 * gone:.0f} %",
            )


def expect_angles(state: m.State, bits: int, angles: Sequence[float], after: str) -> None:
    """Expect that joints are held, each at its angle [rad]."""
    if state.held != bits:
        raise CheckFailed(f"held={bits} after {after}", f"held={state.held}")
    for index, (angle, now) in enumerate(zip(angles, state.joints, strict=True)):
        if bits >> index & 1 and abs(now - angle) > ANGLE_TOLERANCE_RAD:
            expected = f"joint {index} at {angle:.3f} rad after {after}"
            raise CheckFailed(expected, f"{now:.3f} rad")


def within_limits(joints: Sequence[m.Joint], angles: Sequence[float]) -> tuple[float, ...]:
    """Return angles for MOVE, each within its joint's limits [rad]."""
    known = [min(max(angle, one.low), one.high) for one, angle in zip(joints, angles, strict=False)]
    return (*known, *LEVEL)[: m.JOINTS_MAX]


def crossing_time(joint: m.Joint) -> float:
    """Return the time for a joint's whole range at its top speed [s]."""
    return (joint.high - joint.low) / max(joint.speed, 1e-3)


def begin_way(probe: Probe) -> Way:
    """Open a session, and let a joint begin its way."""
    way = choose_way(probe)
    probe.command(way.command(probe.next_number()))
    expect_held(probe, way.bit, "MOVE")
    return way


def expect_held(probe: Probe, bits: int, after: str) -> None:
    """Expect that STATE shows just these joints as held, within 250 ms."""
    expected = f"STATE(held={bits}) after {after}"
    probe.expect_state(lambda state: state.held == bits, EFFECT_WITHIN_S, expected, "held")


def one_angle(index: int, angle: float) -> tuple[float, ...]:
    """Return the angles of a MOVE of one joint [rad]."""
    return (*LEVEL[:index], angle, *LEVEL[index + 1 :])
