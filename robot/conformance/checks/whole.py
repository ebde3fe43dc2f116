"""Checks of everything that was heard in a run; so they come last."""

from robot.conformance.check import Chapter
from robot.conformance.checks.catalogue import known_joints
from robot.conformance.heard import Heard
from robot.conformance.probe import SLACK, Probe
from robot.conformance.verdicts import NotApplicableError, UnmetError
from robot.protocol import messages as m

WHOLE = Chapter("Everything heard", 0)

OVER_LIMIT = 0.02
"""How far a joint may seem to be beyond its limits [rad]: rounding, and the noise of its sensor."""

OVER_SPEED = 0.05
"""How much farther than its speed allows a joint may seem to have moved [rad]: noise, twice."""

WINDOW = 0.2
"""Shortest time between two STATEs by which a speed is judged [s]."""

MOTIONS_MOST = 12
"""Motions that are played at most; of more, each second or third and so on."""

MOVES_FOR = 4.0
"""How long all of them are looked at together [s]."""

MOVES_EACH = 0.3
"""How long each is looked at, at least [s]."""


@WHOLE.must_of(2)
def sends_valid_frames(robot: Probe) -> None:
    """All that the robot sends is whole frames, of a robot's messages in the version agreed."""
    robot.fresh()
    robot.live(0.3)
    wrong = robot.log.faults.get("frame", [])
    if wrong:
        raise UnmetError(
            "only whole frames of a robot's messages",
            f"{robot.log.counts['frame']} that are none; {_examples(wrong)}",
        )


@WHOLE.must_of(5)
def own_session_in_header(robot: Probe) -> None:
    """Whatever the robot sends but GONE bears the session of its last WELCOME."""
    robot.fresh()
    robot.live(0.2)
    robot.again()
    robot.live(0.2)
    faults = robot.log.faults.get("session", [])
    if faults:
        count = robot.log.counts["session"]
        raise UnmetError(f"session {robot.session} or that before", f"{count} × {faults[0]}")


@WHOLE.must_of(7)
def state_possible(robot: Probe) -> None:
    """Every STATE shows moods, motions and sounds of the catalogue, and joints that there are."""
    welcome = robot.fresh()
    robot.live(0.3)
    for _, state in robot.log.states:
        counts = {"mood": welcome.moods, "motion": welcome.motions, "sound": welcome.sounds}
        for word, count in counts.items():
            index = getattr(state, word)
            none = m.NOTHING if word != "mood" or not count else -1
            if index >= count and index != none:
                raise UnmetError(f"STATE with a {word} below {count}", f"{word}={index}")
        if any(state.joints[welcome.joints :]):
            beyond = state.joints[welcome.joints :]
            raise UnmetError(f"0 for joints from {welcome.joints} on", f"{beyond}")
        if state.flags & ~(m.CHARGING | m.STILL | m.LIMP | m.RECKONED):
            raise UnmetError("STATE with no flags but 0 to 3", f"flags={state.flags}")


@WHOLE.must_of(7)
def joints_within_limits(robot: Probe) -> None:
    """No joint is ever beyond the limits of the catalogue."""
    joints = _moved(robot)
    for _, state in robot.log.states:
        for index, joint in enumerate(joints):
            angle = state.joints[index]
            if not joint.low - OVER_LIMIT <= angle <= joint.high + OVER_LIMIT:
                raise UnmetError(
                    f"joint {index} ({joint.name}) from {joint.low} to {joint.high} rad",
                    f"{angle} rad",
                )


@WHOLE.must_of(7)
def joints_within_speed(robot: Probe) -> str:
    """No joint moves faster than the speed in the catalogue, whatever the robot is told."""
    joints = _moved(robot)
    fastest = 0.0
    for (then, before), (now, after) in _windows(robot):
        for index, joint in enumerate(joints):
            way = abs(after.joints[index] - before.joints[index])
            most = joint.speed * (now - then + SLACK) + OVER_SPEED
            fastest = max(fastest, (way - OVER_SPEED) / (joint.speed * (now - then + SLACK)))
            if way > most:
                raise UnmetError(
                    f"joint {index} ({joint.name}) at most {joint.speed} rad/s",
                    f"{way:.3f} rad in {1000 * (now - then):.0f} ms",
                )
    return f"the fastest at {100 * max(fastest, 0.0):.0f} % of its own"


def _examples(wrong: list[Heard]) -> str:
    return "; ".join(str(heard) for heard in wrong)


def _moved(robot: Probe) -> list[m.Joint]:
    """Make the robot move, and return its joints."""
    joints = known_joints(robot)
    if not joints:
        raise NotApplicableError("it has no joints")
    if robot.moved:
        return joints
    welcome = robot.fresh()
    motions = [*range(welcome.motions)][:: -(-welcome.motions // MOTIONS_MOST) or 1]
    half = len(motions) // 2
    each = max(MOVES_FOR / (2 + len(motions)), MOVES_EACH)
    for emotion, some in (((1.0, 1.0), motions[:half]), ((-1.0, -1.0), motions[half:])):
        robot.express(*emotion)
        robot.live(each)
        for motion in some:
            robot.command(m.Play(robot.next_number(), m.ITEM_MOTION, motion))
            robot.live(each)
    robot.moved = True
    return joints


def _windows(robot: Probe) -> list[tuple[tuple[float, m.State], tuple[float, m.State]]]:
    """Return pairs of STATEs that are a little apart."""
    pairs = []
    first = 0
    states = robot.log.states
    for index, (at, state) in enumerate(states):
        while first < index and at - states[first + 1][0] >= WINDOW:
            first += 1
        if at - states[first][0] >= WINDOW:
            pairs.append((states[first], (at, state)))
    return pairs
