"""Checks of section 6: the mood that a host names is the one that is shown."""

from functools import partial

from robot.conformance.check import Chapter
from robot.conformance.probe import ACTS_WITHIN, SHOWN_WITHIN, Probe
from robot.conformance.verdicts import NotApplicableError, UnmetError
from robot.protocol import messages as m

MOODS = Chapter("Moods", 6)

NEAR = 0.02
"""How close the emotion shown comes to the one asked for."""

_FELT = (0.8, 0.6)


@MOODS.must
def named_mood_shown_at_once(robot: Probe) -> None:
    """A mood that is named is shown within 250 ms, however far the emotion is, and from then on.

    The emotion of that EXPRESS is felt all the same.
    """
    mood = last_mood(robot)
    robot.calm()
    robot.express(*_FELT, mood)
    sees_mood(robot, mood, "EXPRESS with it")
    for state in _feels(robot, _FELT):
        if state.mood != mood:
            raise UnmetError(f"mood {mood} until another is named", f"mood={state.mood}")


@MOODS.must
def mood_255_leaves_the_choice(robot: Probe) -> None:
    """After 255 the robot chooses the mood as if none had been named before."""
    last = last_mood(robot)
    robot.calm()
    robot.express(*_FELT)
    own = _feels(robot, _FELT)[-1].mood
    other = 0 if own else last  # 0 where it can be: its choice came from there
    robot.express(*_FELT, other)
    sees_mood(robot, other, "EXPRESS with it")
    robot.express(*_FELT)
    mood = robot.live(SHOWN_WITHIN, lambda state: state.mood == own)[-1].mood
    if mood != own:
        raise UnmetError(f"mood {own}, its own choice for {_FELT}, after 255", f"mood={mood}")


@MOODS.must
def stop_ends_a_named_mood(robot: Probe) -> None:
    """A robot that was told a mood shows its first one within 250 ms after STOP."""
    mood = last_mood(robot)
    robot.express(*_FELT, mood)
    sees_mood(robot, mood, "EXPRESS with it")
    robot.command(m.Stop(robot.next_number()))
    sees_mood(robot, 0, "STOP")


def last_mood(robot: Probe) -> int:
    """Open a session and return a mood to name; raises NotApplicableError if there is none."""
    welcome = robot.fresh()
    if robot.version < 2 or welcome.moods < 2:
        raise NotApplicableError("it speaks version 1, or has fewer than two moods")
    return welcome.moods - 1


def sees_mood(robot: Probe, mood: int, after: str) -> None:
    """See a mood in STATE within 250 ms."""
    last = robot.live(ACTS_WITHIN, lambda state: state.mood == mood)[-1].mood
    if last != mood:
        raise UnmetError(
            f"STATE(mood={mood}) within {1000 * ACTS_WITHIN:.0f} ms after {after}", f"mood={last}"
        )


def _feels(robot: Probe, emotion: tuple[float, float]) -> list[m.State]:
    states = robot.live(SHOWN_WITHIN, partial(_shows, emotion=emotion))
    last = states[-1]
    if not _shows(last, emotion):
        raise UnmetError(
            f"{emotion} shown within {SHOWN_WITHIN:.0f} s after EXPRESS",
            f"({last.valence}, {last.arousal})",
        )
    return states


def _shows(state: m.State, emotion: tuple[float, float]) -> bool:
    return max(abs(state.valence - emotion[0]), abs(state.arousal - emotion[1])) < NEAR
