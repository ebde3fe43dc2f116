"""Checks of section 7: a robot without its host goes to neutral."""

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.checks.catalogue import ITEM_WORDS
from cubeling.robot.conformance.checks.failsafe import FAILSAFE_NOT_BEFORE_S, SILENCE_S
from cubeling.robot.conformance.checks.moods import expect_emotion
from cubeling.robot.conformance.checks.playing import (
    expect_still_played,
    long_entries,
    play,
    played_item,
    start,
)
from cubeling.robot.conformance.checks.stopping import (
    REST_TOLERANCE_RAD,
    expect_stop_pose,
    known_stop_pose,
    largest_movement,
)
from cubeling.robot.conformance.errors import CheckFailed, NotApplicableError
from cubeling.robot.conformance.probe import (
    EFFECT_WITHIN_S,
    EMOTION_CHANGE,
    EMOTION_WITHIN_S,
    Probe,
    emotion_distance,
    is_neutral,
)
from cubeling.robot.protocol import messages as m

NEUTRALITY = CheckGroup("Going to neutral", 7)

MAX_SPEED_RATIO = 4
"""A way to neutral that is faster than the way from there by this factor is a jump."""

REST_S = 0.5
"""Time in which a robot at rest must not move [s]."""

EXTRA_SILENCE_S = 0.1
"""Silence for a stopped robot beyond the failsafe's [s]."""

MIN_VALENCE = 0.25
"""Smallest valence from which the way to neutral is tested."""


@NEUTRALITY.must
def failsafe_goes_to_neutral(probe: Probe) -> None:
    """After the failsafe motion and sound end, and (0, 0) and the first mood are shown."""
    played = _excite(probe)
    probe.receive(SILENCE_S)
    probe.reopen_session()
    _expect_neutral(probe, played, "the failsafe")


@NEUTRALITY.must
def failsafe_acts_in_time(probe: Probe) -> None:
    """The way to neutral has begun 500 ms after the last message, not at the next HELLO."""
    probe.open_neutral_session()
    probe.express(0.4, 0.4)
    _expect_valence(probe, 0.4)  # all of it, so that it does not rise further in the silence
    begin = probe.keep_alive(EFFECT_WITHIN_S)[-1]
    probe.receive(SILENCE_S + 0.5)
    probe.reopen_session()
    before = emotion_distance(begin, 0.0, 0.0)
    after = emotion_distance(probe.beat("HELLO"), 0.0, 0.0)
    if after > before - EMOTION_CHANGE:
        expected = f"an emotion nearer to (0, 0) than {before} after 1 s of silence"
        raise CheckFailed(expected, f"{after}")


@NEUTRALITY.must
def failsafe_does_not_jump(probe: Probe) -> None:
    """After the failsafe the emotion goes to (0, 0) at the robot's own speed."""
    probe.open_neutral_session()
    probe.express(0.8, 0.8)
    begin = probe.now
    _expect_valence(probe, 0.8)
    last = probe.now
    rise_time = last - begin
    probe.receive(SILENCE_S)
    probe.reopen_session()
    state = probe.beat("HELLO")
    fall_time = probe.now - last - FAILSAFE_NOT_BEFORE_S
    if is_neutral(state) and rise_time > MAX_SPEED_RATIO * fall_time:
        raise CheckFailed(
            f"an emotion on its way to (0, 0) {1000 * fall_time:.0f} ms after the failsafe; "
            f"the way from there took {1000 * rise_time:.0f} ms",
            f"({state.valence}, {state.arousal})",
        )


@NEUTRALITY.must
def failsafe_ends_the_movement(probe: Probe) -> str | None:
    """A robot that rests when it is neutral comes to rest after the failsafe too."""
    motion = long_entries(probe, m.ITEM_MOTION)[m.ITEM_MOTION]
    if largest_movement(probe.keep_alive(REST_S)) > REST_TOLERANCE_RAD:
        return "it moves when it is neutral, as it may"
    start(probe, m.ITEM_MOTION, motion)
    probe.receive(SILENCE_S)
    probe.reopen_session()
    end = probe.now + EMOTION_WITHIN_S
    while (movement := largest_movement(probe.keep_alive(REST_S))) > REST_TOLERANCE_RAD:
        if probe.now > end:
            raise CheckFailed(
                f"joints at rest within {EMOTION_WITHIN_S:.0f} s after a motion and the failsafe",
                f"one that moves by {movement:.3f} rad in {1000 * REST_S:.0f} ms",
            )
    return None


@NEUTRALITY.must
def bye_goes_to_neutral(probe: Probe) -> None:
    """After BYE motion and sound end, and (0, 0) and the first mood are shown."""
    played = _excite(probe)
    probe.send(m.Bye())
    probe.reopen_session()
    _expect_neutral(probe, played, "BYE")


@NEUTRALITY.must
def another_host_goes_to_neutral(probe: Probe) -> None:
    """After HELLO of another host motion and sound end, and (0, 0) and the first mood are shown."""
    played = _excite(probe)
    probe.open_session()
    _expect_neutral(probe, played, "HELLO of another host")


@NEUTRALITY.must
def same_host_keeps_the_emotion(probe: Probe) -> None:
    """When the same host says HELLO again in time, the emotion stays."""
    probe.open_session()
    probe.express(0.6, 0.6)
    expect_emotion(probe, (0.6, 0.6), "EXPRESS")  # it may come from above
    probe.reopen_session()
    for state in probe.keep_alive(0.5):
        if abs(state.valence - 0.6) > EMOTION_CHANGE:
            raise CheckFailed("valence 0.6 in the next session of its host", f"{state.valence}")


@NEUTRALITY.must_of(5)
def same_host_keeps_the_motion(probe: Probe) -> None:
    """When the same host says HELLO again in time, motion and sound go on."""
    try:
        indices = long_entries(probe, m.ITEM_MOTION, m.ITEM_SOUND)
    except NotApplicableError:
        indices = long_entries(probe, m.ITEM_MOTION)
    for hello, after in (
        (probe.hello, "a repeated HELLO"), (probe.reopen_session, "the next HELLO of its host")
    ):  # fmt: skip
        for item, index in indices.items():
            play(probe, item, index)
        hello()
        state = probe.keep_alive(EFFECT_WITHIN_S)[-1]
        for item, index in indices.items():
            expect_still_played(state, item, index, after)


@NEUTRALITY.must
def stopped_robot_stays_still(probe: Probe) -> None:
    """A stopped robot stays still when the session ends, and for another host."""
    known_stop_pose(probe)
    probe.open_session()
    probe.command(m.Stop(probe.next_number()))
    expect_stop_pose(probe, "STOP", within=EMOTION_WITHIN_S)
    for end in ("the failsafe", "BYE", "HELLO of another host"):
        # Again, so that there is a command in force that the end of a session takes back.
        probe.command(m.Stop(probe.next_number()))
        if end == "HELLO of another host":
            probe.open_session()
        else:
            if end == "BYE":
                probe.send(m.Bye())
            probe.receive(SILENCE_S + EXTRA_SILENCE_S)
            probe.send(m.Beat(probe.next_beat()))
            probe.expect(m.Gone, f"STOP, {end}, BEAT")
            probe.reopen_session()
        expect_stop_pose(probe, f"STOP and {end}", within=0.0)
        state = probe.keep_alive(EFFECT_WITHIN_S)[-1]
        if not state.flags & m.FLAG_STILL:
            raise CheckFailed(f"flag 1 after STOP and {end}", f"flags={state.flags}")
        expect_stop_pose(probe, f"STOP and {end}", within=0.0)


def _excite(probe: Probe) -> dict[int, int]:
    """Show an emotion, and play a motion and a sound if the robot has more than one.

    Returns what is played, by item. A single motion or sound is left out: the robot may play it
    by itself.
    """
    welcome = probe.open_session()
    probe.express(0.8, 0.8, welcome.moods - 1 if _names_moods(probe) else m.NOTHING)
    _expect_valence(probe, MIN_VALENCE)
    played = {}
    for item, count in ((m.ITEM_MOTION, welcome.motions), (m.ITEM_SOUND, welcome.sounds)):
        if count > 1:
            played[item] = count - 1
            start(probe, item, count - 1)
    return played


def _names_moods(probe: Probe) -> bool:
    return probe.version >= 2 and probe.welcome is not None and probe.welcome.moods > 1


def _expect_valence(probe: Probe, valence: float) -> None:
    probe.expect_state(
        lambda state: state.valence >= valence - 0.01,
        EMOTION_WITHIN_S,
        f"valence {valence} after EXPRESS",
        "valence",
    )


def _expect_neutral(probe: Probe, played: dict[int, int], after: str) -> None:
    """Check that everything that `_excite` started ends."""
    assert probe.welcome is not None
    moods = (0,) if probe.welcome.moods else (0, m.NOTHING)
    named = _names_moods(probe)
    effect_due = probe.now + EFFECT_WITHIN_S

    def neutral(state: m.State) -> bool:
        if probe.now < effect_due:
            return False
        for item, index in played.items():
            if played_item(state, item) == index:
                raise CheckFailed(f"the end of {ITEM_WORDS[item]} {index} after {after}", "none")
        if state.flags & m.FLAG_STILL:
            raise CheckFailed(f"flag 1 clear after {after}: no STOP was sent", "flag 1")
        if named and state.mood:
            expected = f"mood 0 within {1000 * EFFECT_WITHIN_S:.0f} ms after {after}"
            raise CheckFailed(expected, f"mood={state.mood}")
        return is_neutral(state) and state.mood in moods

    expected = f"emotion (0, 0) and mood 0 after {after}"
    probe.expect_state(neutral, EMOTION_WITHIN_S, expected, "valence", "arousal", "mood")
