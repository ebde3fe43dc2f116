"""Checks of section 7: a robot without its host goes to neutral."""

from robot.conformance.check import Chapter
from robot.conformance.checks.failsafe import ALONE
from robot.conformance.probe import ACTS_WITHIN, NEUTRAL, SHOWN_WITHIN, Probe
from robot.conformance.verdicts import UnmetError
from robot.protocol import messages as m

NEUTRALITY = Chapter("Going to neutral", 7)

STIRRED = 0.25
"""How far from (0, 0) an emotion must be before its way back is looked at."""


@NEUTRALITY.must
def failsafe_goes_to_neutral(robot: Probe) -> None:
    """After the failsafe a motion ends, and what is shown goes to (0, 0) and the first mood."""
    _stirred(robot)
    robot.hear(ALONE)
    robot.again()
    _becomes_neutral(robot, "the failsafe")


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
def bye_goes_to_neutral(robot: Probe) -> None:
    """After BYE a motion ends, and what is shown goes to (0, 0) and the first mood."""
    _stirred(robot)
    robot.say(m.Bye())
    robot.again()
    _becomes_neutral(robot, "BYE")


@NEUTRALITY.must
def another_host_goes_to_neutral(robot: Probe) -> None:
    """When another host greets, a motion ends, and what is shown goes to (0, 0), the first mood."""
    _stirred(robot)
    robot.fresh()
    _becomes_neutral(robot, "HELLO of another host")


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


@NEUTRALITY.must
def stopped_keeps_still(robot: Probe) -> None:
    """A robot that was stopped keeps still when the session ends, by the failsafe or by BYE."""
    for way in ("the failsafe", "BYE"):
        robot.fresh()
        robot.command(m.Stop(robot.next_number()))
        if way == "BYE":
            robot.say(m.Bye())
        else:
            robot.hear(ALONE)
        robot.again()
        flags = robot.live(ACTS_WITHIN)[-1].flags
        if not flags & m.STILL:
            raise UnmetError(f"flag 1 after STOP and {way}", f"flags={flags}")


def _stirred(robot: Probe) -> None:
    """Make the robot show something, and play a motion if it has one."""
    welcome = robot.fresh()
    robot.express(0.8, 0.8)
    _reaches(robot, STIRRED)
    if welcome.motions:
        robot.command(m.Play(robot.next_number(), m.ITEM_MOTION, welcome.motions - 1))


def _reaches(robot: Probe, valence: float) -> None:
    last = robot.live(SHOWN_WITHIN, lambda state: state.valence >= valence - 0.01)[-1].valence
    if last < valence - 0.01:
        raise UnmetError(f"valence {valence} within {SHOWN_WITHIN:.0f} s after EXPRESS", f"{last}")


def _becomes_neutral(robot: Probe, after: str) -> None:
    """See that nothing goes on of what `_stirred` began."""
    assert robot.welcome is not None
    played = robot.welcome.motions - 1
    moods = (0,) if robot.welcome.moods else (0, m.NOTHING)
    begin = robot.now

    def neutral(state: m.State) -> bool:
        if played > 0 and state.motion == played and robot.now > begin + ACTS_WITHIN:
            raise UnmetError(f"the end of motion {played} after {after}", f"motion={played}")
        return max(abs(state.valence), abs(state.arousal)) < NEUTRAL and state.mood in moods

    last = robot.live(SHOWN_WITHIN, neutral)[-1]
    if not neutral(last):
        raise UnmetError(
            f"emotion (0, 0) and mood 0 within {SHOWN_WITHIN:.0f} s after {after}",
            f"({last.valence}, {last.arousal}) and mood {last.mood}",
        )
