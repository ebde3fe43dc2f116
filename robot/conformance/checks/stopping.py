"""Checks of section 6: STOP, and what ends it."""

from collections.abc import Sequence

from robot.conformance.check import Chapter
from robot.conformance.probe import ACTS_WITHIN, SHOWN_WITHIN, Probe
from robot.conformance.verdicts import NotApplicableError, UnmetError
from robot.protocol import messages as m

STOPPING = Chapter("Stop", 6)

RISE = 0.05
"""A change of the emotion shown that is no chance."""

STILL_TOLERANCE = 0.03
"""How far a joint that holds still may seem to move, by the noise of its sensor [rad]."""

STILL_FOR = 2.0
"""How long a stopped robot must be seen to rest [s]: so long that a slow sway is seen too."""

LOOK_FOR = 0.2
"""It is looked at in stretches of this length [s]."""


@STOPPING.must
def stop_stops(robot: Probe) -> None:
    """After STOP, STATE says within 250 ms that it is stopped and plays no motion and no sound."""
    welcome = robot.fresh()
    robot.express(0.5, 0.5)
    for item, count in ((m.ITEM_MOTION, welcome.motions), (m.ITEM_SOUND, welcome.sounds)):
        if count:
            robot.command(m.Play(robot.next_number(), item, count - 1))
    robot.live(0.1)
    robot.command(m.Stop(robot.next_number()))

    def stopped(state: m.State) -> bool:
        nothing = state.motion == state.sound == m.NOTHING
        return bool(state.flags & m.STILL) and nothing

    last = robot.live(ACTS_WITHIN, stopped)[-1]
    if not stopped(last):
        raise UnmetError(
            f"STATE with flag 1, motion=255, sound=255 within {1000 * ACTS_WITHIN:.0f} ms "
            "after STOP",
            f"flags={last.flags}, motion={last.motion}, sound={last.sound}",
        )


@STOPPING.must
def stop_holds_the_pose(robot: Probe) -> None:
    """After STOP the emotion shown goes to neutral, and the joints come to rest, within 5 s."""
    robot.fresh()
    robot.express(0.8, 0.6)
    robot.live(0.5)
    robot.command(m.Stop(robot.next_number()))
    robot.pose = _pose_at_rest(robot)


@STOPPING.must
def stop_takes_the_same_pose(robot: Probe) -> None:
    """The joints go to the same pose after every STOP, whatever the robot felt before."""
    known_pose(robot)
    robot.fresh()
    robot.express(-0.8, -0.4)
    robot.live(0.5)
    robot.command(m.Stop(robot.next_number()))
    see_pose(robot, "a second STOP", within=SHOWN_WITHIN)


@STOPPING.must
def express_after_stop(robot: Probe) -> None:
    """An EXPRESS after STOP ends the stop: the flag is clear, and the emotion moves."""
    robot.fresh()
    robot.command(m.Stop(robot.next_number()))
    before = robot.live(0.1)[-1].valence
    target = -0.8 if before > 0 else 0.8
    robot.express(target, 0.0)
    states = robot.live(1.0, lambda state: abs(state.valence - before) > RISE)
    if states[-1].flags & m.STILL or (states[-1].valence - before) * target <= 0:
        raise UnmetError(
            f"flag 1 clear, and valence going from {before} to {target}, after STOP and EXPRESS",
            f"flags={states[-1].flags}, valence={states[-1].valence}",
        )


@STOPPING.must
def play_after_stop(robot: Probe) -> None:
    """A PLAY after STOP ends the stop."""
    welcome = robot.fresh()
    if not welcome.motions:
        raise NotApplicableError("it has no motions")
    robot.command(m.Stop(robot.next_number()))
    robot.live(0.1)
    robot.command(m.Play(robot.next_number(), m.ITEM_MOTION, welcome.motions - 1))
    flags = robot.live(ACTS_WITHIN, lambda state: not state.flags & m.STILL)[-1].flags
    if flags & m.STILL:
        raise UnmetError("flag 1 clear after STOP and PLAY", f"flags={flags}")


def _pose_at_rest(robot: Probe) -> tuple[float, ...]:
    """Wait until a stopped robot rests, and return its joints [rad].

    Raises UnmetError if it does not begin to rest within 5 s.
    """
    looks: list[list[m.State]] = []
    end = robot.now + SHOWN_WITHIN + STILL_FOR
    while True:
        looks.append(robot.live(LOOK_FOR))
        last = looks[-1][-1]
        states = [state for look in looks[-round(STILL_FOR / LOOK_FOR) :] for state in look]
        way = moved(states)
        neutral = max(abs(last.valence), abs(last.arousal)) < RISE
        if len(looks) * LOOK_FOR >= STILL_FOR and way <= STILL_TOLERANCE and neutral:
            return tuple(sum(angles) / len(states) for angles in _by_joint(states))
        if robot.now > end:
            raise UnmetError(
                f"joints at rest and emotion (0, 0) within {SHOWN_WITHIN:.0f} s after STOP",
                f"a joint that moves by {way:.3f} rad in {STILL_FOR:.0f} s, "
                f"emotion ({last.valence}, {last.arousal})",
            )


def moved(states: Sequence[m.State]) -> float:
    """Return how far the joint that moved most has moved [rad]."""
    return max(max(angles) - min(angles) for angles in _by_joint(states))


def known_pose(robot: Probe) -> tuple[float, ...]:
    """Return the joints after STOP [rad]; the first call may stop the robot to see them."""
    if robot.pose is None:
        stop_holds_the_pose(robot)
    assert robot.pose is not None
    return robot.pose


def see_pose(robot: Probe, after: str, within: float) -> None:
    """See that the joints are where they are after STOP, within a time [s]."""
    pose = known_pose(robot)

    def off(state: m.State) -> list[int]:
        way = [abs(now - then) for then, now in zip(pose, state.joints, strict=True)]
        return [index for index, angle in enumerate(way) if angle > 2 * STILL_TOLERANCE]

    last = robot.live(within, lambda state: not off(state))[-1]
    for index in off(last):
        raise UnmetError(
            f"joint {index} at {pose[index]:.3f} rad after {after}, as after the first STOP",
            f"{last.joints[index]:.3f} rad",
        )


def _by_joint(states: Sequence[m.State]) -> list[tuple[float, ...]]:
    return list(zip(*(state.joints for state in states), strict=True))
