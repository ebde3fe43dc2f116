"""Checks of everything that the robot sent during the suite; so they come last."""

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.checks.catalogue import known_joints
from cubeling.robot.conformance.errors import CheckFailed, NotApplicableError
from cubeling.robot.conformance.probe import TIMING_SLACK_S, Probe
from cubeling.robot.conformance.received import Rule
from cubeling.robot.protocol import messages as m

RECORDED = CheckGroup("Everything received", 0)

LIMIT_TOLERANCE_RAD = 0.02
"""How far a joint may seem to be beyond its limits [rad]: rounding, and the noise of its sensor."""

SPEED_TOLERANCE_RAD = 0.05
"""How much farther than its speed allows a joint may seem to have moved [rad]: twice the noise."""

MAX_READ_LATE_S = 1.0
"""Longest time between two STATEs that the robot's clock is asked for [s]."""

SPEED_WINDOW_S = 0.2
"""Shortest time between two STATEs for the measurement of a speed [s]."""

MAX_MOTIONS = 12
"""Most motions played; of more, every second or third and so on."""

MOVING_TIME_S = 4.0
"""Time for all of them together [s]."""

MIN_MOTION_TIME_S = 0.3
"""Shortest time for each [s]."""


@RECORDED.must_of(2)
def sends_valid_frames(probe: Probe) -> None:
    """The robot sends only whole frames, with a robot's messages in the version agreed."""
    probe.open_session()
    probe.keep_alive(0.3)
    _expect_none(probe, "frame", "only valid frames of a robot's messages")


@RECORDED.must_of(2)
def frames_have_own_edges(probe: Probe) -> None:
    """Every frame has an edge before it and one after it: there are two between frames."""
    probe.open_session()
    probe.keep_alive(0.3)
    _expect_none(probe, "edges", "two edges between frames")


@RECORDED.should_of(3)
def texts_padded(probe: Probe) -> None:
    """Names and lines of the log are padded with zero bytes."""
    probe.open_session()
    _expect_none(probe, "padding", "texts that are padded with zero bytes")


@RECORDED.must_of(5)
def nothing_sent_unasked(probe: Probe) -> None:
    """Every WELCOME, JOINT, NAME, ACK and GONE answers a message, once, in their order."""
    probe.open_session()
    probe.express(0.0, 0.0)
    probe.keep_alive(0.3)
    _expect_none(probe, "unasked", "one answer to each message, in their order")


@RECORDED.must_of(5)
def own_session_in_header(probe: Probe) -> None:
    """All messages but GONE have the session of the robot's last WELCOME."""
    probe.open_session()
    probe.keep_alive(0.2)
    probe.reopen_session()
    probe.keep_alive(0.2)
    _expect_none(probe, "session", f"session {probe.session} or the last one")


@RECORDED.must_of(7)
def state_values_valid(probe: Probe) -> None:
    """Moods, motions, sounds and joints in STATE are those of the catalogue."""
    welcome = probe.open_session()
    probe.keep_alive(0.3)
    for _, state in probe.log.states:
        counts = {"mood": welcome.moods, "motion": welcome.motions, "sound": welcome.sounds}
        for word, count in counts.items():
            index = getattr(state, word)
            none = m.NOTHING if word != "mood" or not count else -1
            if index >= count and index != none:
                raise CheckFailed(f"STATE with a {word} below {count}", f"{word}={index}")
        beyond = state.joints[welcome.joints :]
        if any(beyond):
            raise CheckFailed(f"0 for joints from {welcome.joints} on", f"{beyond}")
        if state.flags & ~(m.FLAG_CHARGING | m.FLAG_STILL | m.FLAG_LIMP | m.FLAG_RECKONED):
            raise CheckFailed("STATE with no flags but 0 to 3", f"flags={state.flags}")


@RECORDED.must_of(7)
def joints_within_limits(probe: Probe) -> None:
    """No joint is ever beyond the limits in the catalogue."""
    joints = _move_all(probe)
    for _, state in probe.log.states:
        for index, joint in enumerate(joints):
            angle = state.joints[index]
            if not joint.low - LIMIT_TOLERANCE_RAD <= angle <= joint.high + LIMIT_TOLERANCE_RAD:
                raise CheckFailed(
                    f"joint {index} ({joint.name}) from {joint.low} to {joint.high} rad",
                    f"{angle} rad",
                )


@RECORDED.must_of(7)
def joints_within_speed(probe: Probe) -> str:
    """No joint moves faster than its speed in the catalogue, whatever is commanded."""
    joints = _move_all(probe)
    fastest = 0.0
    for (then, before), (now, after) in _state_pairs(probe):
        for index, joint in enumerate(joints):
            way = abs(after.joints[index] - before.joints[index])
            time = max(now - then, _robot_time(before, after))
            allowed = joint.speed * (time + TIMING_SLACK_S)
            if way > allowed + SPEED_TOLERANCE_RAD:
                raise CheckFailed(
                    f"joint {index} ({joint.name}) at most {joint.speed} rad/s",
                    f"{way:.3f} rad in {1000 * (now - then):.0f} ms",
                )
            if allowed:
                fastest = max(fastest, (way - SPEED_TOLERANCE_RAD) / allowed)
    return f"the fastest at {100 * max(fastest, 0.0):.0f} % of its own"


def _robot_time(before: m.State, after: m.State) -> float:
    """Return the time between two STATEs by the robot's clock [s]; 0 if it is not known.

    On a busy computer a STATE is read long after it was made, and the next one at once.
    """
    passed = ((after.time - before.time) & 0xFFFFFFFF) / 1000
    known = before.time and after.time and passed < MAX_READ_LATE_S
    return passed if known else 0.0


def _expect_none(probe: Probe, rule: Rule, expected: str) -> None:
    """Raise CheckFailed if a frame of the suite violated a rule."""
    count = probe.log.violation_counts.get(rule, 0)
    if count:
        examples = "; ".join(map(str, probe.log.violations[rule]))
        found = "another" if count == 1 else f"{count} others"
        raise CheckFailed(expected, f"{found}; {examples}")


def _move_all(probe: Probe) -> list[m.Joint]:
    """Move the robot, if no check did before, and return its joints."""
    joints = known_joints(probe)
    if not joints:
        raise NotApplicableError("it has no joints")
    if probe.has_moved:
        return joints
    welcome = probe.open_session()
    motions = [*range(welcome.motions)][:: -(-welcome.motions // MAX_MOTIONS) or 1]
    half = len(motions) // 2
    time = max(MOVING_TIME_S / (2 + len(motions)), MIN_MOTION_TIME_S)
    for emotion, some in (((1.0, 1.0), motions[:half]), ((-1.0, -1.0), motions[half:])):
        probe.express(*emotion)
        probe.keep_alive(time)
        for motion in some:
            probe.command(m.Play(probe.next_number(), m.ITEM_MOTION, motion))
            probe.keep_alive(time)
    probe.has_moved = True
    return joints


def _state_pairs(probe: Probe) -> list[tuple[tuple[float, m.State], tuple[float, m.State]]]:
    """Return pairs of timed STATEs that are at least `SPEED_WINDOW_S` apart."""
    pairs = []
    first = 0
    states = probe.log.states
    for index, (time, state) in enumerate(states):
        while first < index and time - states[first + 1][0] >= SPEED_WINDOW_S:
            first += 1
        if time - states[first][0] >= SPEED_WINDOW_S:
            pairs.append((states[first], (time, state)))
    return pairs
