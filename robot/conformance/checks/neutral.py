"""Checks of section 7: a robot without its host goes to neutral."""

from robot.conformance.check import Chapter
from robot.conformance.checks.failsafe import ALONE, NOT_BEFORE
from robot.conformance.checks.playing import WORDS, lasting, play, see, shown
from robot.conformance.checks.stopping import STILL_TOLERANCE, known_pose, moved, see_pose
from robot.conformance.probe import ACTS_WITHIN, NEUTRAL, SHOWN_WITHIN, Probe
from robot.conformance.verdicts import NotApplicableError, UnmetError
from robot.protocol import messages as m

NEUTRALITY = Chapter("Going to neutral", 7)

CALMED = 4
"""A way to neutral that is so many times as fast as the way from there is a jump."""

RESTED = 0.5
"""How long a robot is looked at that should not move [s]."""

WOKEN = 0.1
"""How much longer than the failsafe's time a stopped robot is left alone [s]."""

STIRRED = 0.25
"""How far from (0, 0) an emotion must be before its way back is looked at."""


@NEUTRALITY.must
def failsafe_goes_to_neutral(robot: Probe) -> None:
    """After the failsafe motion and sound end, and (0, 0) and the first mood are shown."""
    played = _stirred(robot)
    robot.hear(ALONE)
    robot.again()
    _becomes_neutral(robot, played, "the failsafe")


@NEUTRALITY.must
def failsafe_acts_in_time(robot: Probe) -> None:
    """The way to neutral has begun 500 ms after the last message, not at the next greeting."""
    robot.calm()
    robot.express(0.4, 0.4)
    _reaches(robot, 0.4)  # all of it, so that it does not go on rising in the silence
    begin = robot.live(ACTS_WITHIN)[-1]
    robot.hear(ALONE + 0.5)
    robot.again()
    now = robot.beat("HELLO")
    before = max(abs(begin.valence), abs(begin.arousal))
    after = max(abs(now.valence), abs(now.arousal))
    if after > before - NEUTRAL:
        raise UnmetError(
            f"an emotion nearer to (0, 0) than {before} after 1 s of silence", f"{after}"
        )


@NEUTRALITY.must
def failsafe_does_not_jump(robot: Probe) -> None:
    """After the failsafe the emotion goes to (0, 0) at the robot's own speed."""
    robot.calm()
    robot.express(0.8, 0.8)
    begin = robot.now
    _reaches(robot, 0.8)
    there = robot.now - begin
    last = robot.now
    robot.hear(ALONE)
    robot.again()
    state = robot.beat("HELLO")
    back = robot.now - last - NOT_BEFORE
    left = max(abs(state.valence), abs(state.arousal))
    if left < NEUTRAL and there > CALMED * back:
        raise UnmetError(
            f"an emotion on its way to (0, 0) {1000 * back:.0f} ms after the failsafe; "
            f"the way from there took {1000 * there:.0f} ms",
            f"({state.valence}, {state.arousal})",
        )


@NEUTRALITY.must
def failsafe_ends_the_movement(robot: Probe) -> str | None:
    """A robot that keeps still when it is neutral comes to rest after the failsafe too."""
    motion = lasting(robot, m.ITEM_MOTION)[m.ITEM_MOTION]
    if moved(robot.live(RESTED)) > STILL_TOLERANCE:
        return "it moves when it is neutral, as it may"
    play(robot, m.ITEM_MOTION, motion)
    robot.hear(ALONE)
    robot.again()
    end = robot.now + SHOWN_WITHIN
    while (way := moved(robot.live(RESTED))) > STILL_TOLERANCE:
        if robot.now > end:
            raise UnmetError(
                f"joints at rest within {SHOWN_WITHIN:.0f} s after a motion and the failsafe",
                f"one that moves by {way:.3f} rad in {1000 * RESTED:.0f} ms",
            )
    return None


@NEUTRALITY.must
def bye_goes_to_neutral(robot: Probe) -> None:
    """After BYE motion and sound end, and (0, 0) and the first mood are shown."""
    played = _stirred(robot)
    robot.say(m.Bye())
    robot.again()
    _becomes_neutral(robot, played, "BYE")


@NEUTRALITY.must
def another_host_goes_to_neutral(robot: Probe) -> None:
    """When another host greets, motion and sound end; (0, 0) and the first mood are shown."""
    played = _stirred(robot)
    robot.fresh()
    _becomes_neutral(robot, played, "HELLO of another host")


@NEUTRALITY.must
def same_host_keeps_the_emotion(robot: Probe) -> None:
    """When the same host greets again in time, the emotion stays: a short break changes nothing."""
    robot.fresh()
    robot.express(0.6, 0.6)
    _reaches(robot, 0.6)
    robot.again()
    for state in robot.live(0.5):
        if abs(state.valence - 0.6) > NEUTRAL:
            raise UnmetError("valence 0.6 in the next session of its host", f"{state.valence}")


@NEUTRALITY.must_of(5)
def same_host_keeps_the_motion(robot: Probe) -> None:
    """When the same host greets again in time, motion and sound go on."""
    try:
        indices = lasting(robot, m.ITEM_MOTION, m.ITEM_SOUND)
    except NotApplicableError:
        indices = lasting(robot, m.ITEM_MOTION)
    for item, index in indices.items():
        play(robot, item, index)
        see(robot, item, index, "PLAY")
    robot.again()
    state = robot.live(ACTS_WITHIN)[-1]
    for item, index in indices.items():
        if shown(state, item) != index:
            raise UnmetError(
                f"{WORDS[item]} {index} going on in the next session of its host",
                f"{WORDS[item]}={shown(state, item)}",
            )


@NEUTRALITY.must
def stopped_keeps_still(robot: Probe) -> None:
    """A robot that was stopped keeps still when the session ends, and for another host."""
    known_pose(robot)
    robot.fresh()
    robot.command(m.Stop(robot.next_number()))
    see_pose(robot, "STOP", within=SHOWN_WITHIN)
    for way in ("the failsafe", "BYE", "HELLO of another host"):
        if way == "HELLO of another host":
            robot.fresh()
        else:
            if way == "BYE":
                robot.say(m.Bye())
            robot.hear(ALONE + WOKEN)
            robot.again()
        see_pose(robot, f"STOP and {way}", within=0.0)
        state = robot.live(ACTS_WITHIN)[-1]
        if not state.flags & m.STILL:
            raise UnmetError(f"flag 1 after STOP and {way}", f"flags={state.flags}")
        see_pose(robot, f"STOP and {way}", within=0.0)


def _stirred(robot: Probe) -> dict[int, int]:
    """Make the robot show something, and play a motion and a sound if it has them.

    Returns what is played, by item; the only motion or sound may be the robot's own.
    """
    welcome = robot.fresh()
    robot.express(0.8, 0.8, welcome.moods - 1 if _names_moods(robot) else m.NOTHING)
    _reaches(robot, STIRRED)
    played = {}
    for item, count in ((m.ITEM_MOTION, welcome.motions), (m.ITEM_SOUND, welcome.sounds)):
        if count > 1:
            played[item] = count - 1
            play(robot, item, count - 1)
    return played


def _names_moods(robot: Probe) -> bool:
    return robot.version >= 2 and robot.welcome is not None and robot.welcome.moods > 1


def _reaches(robot: Probe, valence: float) -> None:
    last = robot.live(SHOWN_WITHIN, lambda state: state.valence >= valence - 0.01)[-1].valence
    if last < valence - 0.01:
        raise UnmetError(f"valence {valence} within {SHOWN_WITHIN:.0f} s after EXPRESS", f"{last}")


def _becomes_neutral(robot: Probe, played: dict[int, int], after: str) -> None:
    """See that nothing goes on of what `_stirred` began."""
    assert robot.welcome is not None
    moods = (0,) if robot.welcome.moods else (0, m.NOTHING)
    named = _names_moods(robot)
    acts = robot.now + ACTS_WITHIN

    def neutral(state: m.State) -> bool:
        if robot.now < acts:
            return False
        for item, index in played.items():
            if shown(state, item) == index:
                raise UnmetError(f"the end of {WORDS[item]} {index} after {after}", "none")
        if state.flags & m.STILL:
            raise UnmetError(f"flag 1 clear after {after}: nobody stopped it", "flag 1")
        if named and state.mood:
            raise UnmetError(
                f"mood 0 within {1000 * ACTS_WITHIN:.0f} ms after {after}", f"mood={state.mood}"
            )
        return max(abs(state.valence), abs(state.arousal)) < NEUTRAL and state.mood in moods

    last = robot.live(SHOWN_WITHIN, neutral)[-1]
    if not neutral(last):
        raise UnmetError(
            f"emotion (0, 0) and mood 0 within {SHOWN_WITHIN:.0f} s after {after}",
            f"({last.valence}, {last.arousal}) and mood {last.mood}",
        )
