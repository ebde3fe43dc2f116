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

_FAR_VALENCE = 0.7
"""From this valence on the emotion shown is not near (0, 0)."""

_KEPT_S = 2.5
"""How long the emotion must stay once it is shown [s]."""


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


@MOODS.must_of(5)
def short_express_leaves_the_choice(probe: Probe) -> None:
    """The length of EXPRESS decides: 11 bytes leave the mood to the robot, 12 name one.

    The version of the session does not matter.
    """
    last = mood_to_name(probe)
    highest = probe.version
    probe.open_neutral_session()
    probe.express(*_EMOTION)
    own = expect_emotion(probe, _EMOTION, "EXPRESS")[-1].mood
    for version in {1, highest}:
        probe.hello(offer=version)
        for other in {0, last} - {own}:
            named = m.Express(probe.next_number(), *_EMOTION, other)
            probe.send(named, version=2)
            expect_mood(probe, other, f"EXPRESS of 12 bytes in a session of version {version}")
            short = m.Express(probe.next_number(), *_EMOTION)
            probe.send(short, version=1)
            expected = f"mood {own}, its own choice for {_EMOTION}, after EXPRESS of 11 bytes"
            probe.expect_state(lambda state: state.mood == own, EMOTION_WITHIN_S, expected, "mood")


@MOODS.must
def own_mood_follows_the_emotion_shown(probe: Probe) -> None:
    """A mood that was not named follows the emotion shown, also on the way to neutral."""
    probe.open_neutral_session()
    for end in ("EXPRESS (0, 0)", "BYE"):
        probe.express(*_EMOTION)
        if not expect_emotion(probe, _EMOTION, "EXPRESS")[-1].mood:
            raise NotApplicableError(f"its own choice for {_EMOTION} is its first mood")
        if end == "BYE":
            probe.send(m.Bye())
            probe.reopen_session()
        else:
            probe.express(0.0, 0.0)
        # Closer to neutral, a robot may well show its first mood.
        for state in probe.keep_alive(1.0, lambda state: state.valence < _FAR_VALENCE):
            if state.valence >= _FAR_VALENCE and not state.mood:
                expected = f"another mood than 0 at valence {state.valence} after {end}"
                raise CheckFailed(expected, "mood=0")


@MOODS.must
def emotion_and_mood_kept(probe: Probe) -> None:
    """PLAY and MOVE do not end the emotion, nor the mood that was named; nor does time."""
    welcome = probe.open_neutral_session()
    mood = last_mood(probe)
    probe.express(*_EMOTION, mood)
    commands: list[m.Command] = []
    if welcome.motions:
        commands.append(m.Play(probe.next_number(), m.ITEM_MOTION, welcome.motions - 1))
    if welcome.sounds:
        commands.append(m.Play(probe.next_number(), m.ITEM_SOUND, welcome.sounds - 1))
    if probe.takes_move:
        commands.append(m.Move(probe.next_number(), 0.0, 0, 0, (0.0,) * m.JOINTS_MAX))
    for command in commands:
        probe.send(command)
        probe.expect(m.Ack, "PLAY or MOVE", number=command.number)
    expect_emotion(probe, _EMOTION, "EXPRESS, and PLAY or MOVE")
    for state in probe.keep_alive(_KEPT_S):
        if mood not in (state.mood, m.NOTHING):
            raise CheckFailed(f"mood {mood} after PLAY or MOVE", f"mood={state.mood}")
        if emotion_distance(state, *_EMOTION) > EMOTION_TOLERANCE:
            shown = f"({state.valence}, {state.arousal})"
            raise CheckFailed(f"{_EMOTION} until another emotion is commanded", shown)


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
    probe.open_session()
    mood = last_mood(probe)
    if mood == m.NOTHING:
        raise NotApplicableError("it speaks version 1, or has fewer than two moods")
    return mood


def last_mood(probe: Probe) -> int:
    """Return the last mood in the open session; NOTHING if none but the first can be named."""
    moods = probe.welcome.moods if probe.welcome is not None and probe.version >= 2 else 0
    return moods - 1 if moods > 1 else m.NOTHING


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
