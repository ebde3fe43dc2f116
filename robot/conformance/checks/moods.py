"""Checks of section 6: the robot shows the mood that the host names."""

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.errors import CheckFailed, NotApplicableError
from cubeling.robot.conformance.probe import (
    EFFECT_WITHIN_S,
    EMOTION_TOLERANCE,
    EMOTION_WITHIN_S,
    Probe,
    emotion_distance,
)
from cubeling.robot.protocol import messages as m

MOODS = CheckGroup("Moods", 6)

_EMOTION = (0.8, 0.6)


@MOODS.must
def named_mood_shown_at_once(probe: Probe) -> None:
    """A named mood is shown within 250 ms, however far the emotion is, and from then on.

    The emotion of that EXPRESS is shown all the same.
    """
    mood = mood_to_name(probe)
    probe.open_neutral_session()
    probe.express(*_EMOTION, mood)
    expect_mood(probe, mood, "EXPRESS with it")
    for state in expect_emotion(probe, _EMOTION, "EXPRESS"):
        if state.mood != mood:
            raise CheckFailed(f"mood {mood} until another is named", f"mood={state.mood}")


@MOODS.must
def mood_255_leaves_the_choice(probe: Probe) -> None:
    """After 255 the robot chooses the mood as if none had been named before."""
    last = mood_to_name(probe)
    probe.open_neutral_session()
    probe.express(*_EMOTION)
    own = expect_emotion(probe, _EMOTION, "EXPRESS")[-1].mood
    other = 0 if own else last  # 0 if possible: the robot's choice started from it
    probe.express(*_EMOTION, other)
    expect_mood(probe, other, "EXPRESS with it")
    probe.express(*_EMOTION)
    expected = f"mood {own}, its own choice for {_EMOTION}, after 255"
    probe.expect_state(lambda state: state.mood == own, EMOTION_WITHIN_S, expected, "mood")


@MOODS.must
def stop_ends_a_named_mood(probe: Probe) -> None:
    """After STOP a named mood ends: the robot shows its first mood within 250 ms."""
    mood = mood_to_name(probe)
    probe.express(*_EMOTION, mood)
    expect_mood(probe, mood, "EXPRESS with it")
    probe.command(m.Stop(probe.next_number()))
    expect_mood(probe, 0, "STOP")


def mood_to_name(probe: Probe) -> int:
    """Open a session and return a mood to name; raises NotApplicableError if there is none."""
    welcome = probe.open_session()
    if probe.version < 2 or welcome.moods < 2:
        raise NotApplicableError("it speaks version 1, or has fewer than two moods")
    return welcome.moods - 1


def expect_mood(probe: Probe, mood: int, after: str) -> None:
    """Wait for a STATE with a mood, at most 250 ms."""
    expected = f"STATE(mood={mood}) after {after}"
    probe.expect_state(lambda state: state.mood == mood, EFFECT_WITHIN_S, expected, "mood")


def expect_emotion(probe: Probe, emotion: tuple[float, float], after: str) -> list[m.State]:
    """Return the STATEs until an emotion is shown, at most 5 s."""
    return probe.expect_state(
        lambda state: emotion_distance(state, *emotion) < EMOTION_TOLERANCE,
        EMOTION_WITHIN_S,
        f"{emotion} shown after {after}",
        "valence", "arousal",
    )  # fmt: skip
