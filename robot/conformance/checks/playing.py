"""Checks of section 6: motions and sounds are played once, and at the same time."""

from math import inf

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.checks.catalogue import ITEM_WORDS
from cubeling.robot.conformance.checks.commands import refused_commands
from cubeling.robot.conformance.checks.moods import expect_emotion, last_mood
from cubeling.robot.conformance.errors import CheckFailed, NotApplicableError
from cubeling.robot.conformance.probe import (
    EFFECT_WITHIN_S,
    EMOTION_CHANGE,
    Probe,
    emotion_distance,
)
from cubeling.robot.protocol import messages as m, timing

PLAYING = CheckGroup("Motions and sounds", 6)

MAX_PLAY_TIME_S = 10.0
"""A motion or sound that takes longer than this does not end [s]."""

MIN_PLAY_TIME_S = 3 * EFFECT_WITHIN_S
"""Shortest motion or sound during which other commands can be tested [s]."""

POLL_EVERY_S = 0.010
"""Time between two BEATs that watch for a motion or sound [s]; a sound may be short."""

AGAIN_AFTER_S = 0.6
"""Time from a PLAY to the same one again [s]."""

EARLY_S = 0.45
"""How much earlier than measured it may end [s]: a slow line makes all seem to last longer."""

_EMOTION = (0.8, 0.6)

PLAYED_ITEMS = (m.ITEM_MOTION, m.ITEM_SOUND)
"""The items that PLAY can name."""


@PLAYING.must
def motion_played(probe: Probe) -> None:
    """STATE shows the motion of a PLAY within 250 ms."""
    _check_played(probe, m.ITEM_MOTION)


@PLAYING.must
def sound_played(probe: Probe) -> None:
    """STATE shows the sound of a PLAY within 250 ms."""
    _check_played(probe, m.ITEM_SOUND)


@PLAYING.should
def played_once(probe: Probe) -> str:
    """A motion or a sound is played once, and ends within 10 s."""
    durations = _known_durations(probe)
    for item, time in durations.items():
        if time > MAX_PLAY_TIME_S:
            expected = f"the end of a {ITEM_WORDS[item]} within {MAX_PLAY_TIME_S:.0f} s"
            raise CheckFailed(expected, "none")
    return ", ".join(f"a {ITEM_WORDS[item]} of {time:.1f} s" for item, time in durations.items())


@PLAYING.must
def old_play_without_effect(probe: Probe) -> None:
    """A PLAY whose number is not above the last one's plays nothing, and nothing again."""
    durations = _known_durations(probe)
    item = min(durations, key=lambda one: durations[one])
    probe.open_neutral_session()
    state = probe.beat("HELLO")
    played = _idle_entry(probe, state, item)
    first = m.Play(5, item, played)
    probe.command(first)
    for other in durations:
        exclude = played if other == item else m.NOTHING
        index = _idle_entry(probe, state, other, exclude)
        if index != m.NOTHING:
            for number in (5, 4):
                after = f"PLAY {number}, with 5 taken before"
                probe.send(m.Play(number, other, index))
                probe.expect(m.Ack, after, number=number)
                _expect_not_played(probe, other, index, after)
    if durations[item] > MAX_PLAY_TIME_S:
        return
    end = probe.now + durations[item] + MIN_PLAY_TIME_S
    while played_item(probe.beat("PLAY 5"), item) == played:  # a repeat might restart it
        if probe.now > end:
            raise CheckFailed(
                f"the end of {ITEM_WORDS[item]} {played} after {durations[item]:.1f} s, "
                "however often its PLAY is repeated",
                f"none after {durations[item] + MIN_PLAY_TIME_S:.1f} s",
            )
        probe.send(first)
        probe.expect(m.Ack, "PLAY 5 again", number=5)
        probe.receive(POLL_EVERY_S)
    probe.send(first)
    probe.expect(m.Ack, "PLAY 5 again", number=5)
    _expect_not_played(probe, item, played, "its end and a repeat of its PLAY")


@PLAYING.must
def motion_and_sound_together(probe: Probe) -> None:
    """Motion and sound do not end each other."""
    indices = long_entries(probe, m.ITEM_MOTION, m.ITEM_SOUND)
    for first, second in ((m.ITEM_MOTION, m.ITEM_SOUND), (m.ITEM_SOUND, m.ITEM_MOTION)):
        play(probe, first, indices[first])
        play(probe, second, indices[second])
        after = f"PLAY of a {ITEM_WORDS[second]}"
        expect_still_played(probe.beat(after), first, indices[first], after)


@PLAYING.must
def refused_play_ends_nothing(probe: Probe) -> None:
    """A refused PLAY does not end what is played."""
    index = long_entries(probe, m.ITEM_MOTION)[m.ITEM_MOTION]
    play(probe, m.ITEM_MOTION, index)
    probe.command(m.Play(probe.next_number(), m.ITEM_MOTION, m.NOTHING - 1), m.RESULT_REFUSED)
    state = probe.keep_alive(EFFECT_WITHIN_S)[-1]
    expect_still_played(state, m.ITEM_MOTION, index, "a refused PLAY")


@PLAYING.must
def refused_express_ends_nothing(probe: Probe) -> None:
    """A refused EXPRESS does not end the motion that is played."""
    index = long_entries(probe, m.ITEM_MOTION)[m.ITEM_MOTION]
    if probe.version < 2:
        raise NotApplicableError("it speaks version 1")
    play(probe, m.ITEM_MOTION, index)
    refused = m.Express(probe.next_number(), 0.4, 0.4, m.NOTHING - 1)
    probe.command(refused, m.RESULT_REFUSED)
    state = probe.keep_alive(EFFECT_WITHIN_S)[-1]
    expect_still_played(state, m.ITEM_MOTION, index, "a refused EXPRESS")


@PLAYING.must
def second_play_replaces_the_first(probe: Probe) -> None:
    """A PLAY during another motion, or during another sound, replaces that one within 250 ms."""
    items = [item for item, time in _known_durations(probe).items() if time >= MIN_PLAY_TIME_S]
    tested = False
    for item in items:
        first = long_entries(probe, item)[item]
        second = _idle_entry(probe, probe.beat("HELLO"), item, first)
        if second != m.NOTHING:
            play(probe, item, first)
            play(probe, item, second)
            tested = True
    if not tested:
        raise NotApplicableError("it has no two motions or sounds that last long enough")


@PLAYING.must
def play_again_begins_again(probe: Probe) -> None:
    """A PLAY of the motion or the sound that is played begins it again, from the beginning."""
    durations = _known_durations(probe)
    items = [one for one, time in durations.items() if MIN_PLAY_TIME_S <= time <= MAX_PLAY_TIME_S]
    if not items:
        raise NotApplicableError("it has no motion and no sound that lasts long enough")
    entries = long_entries(probe, *items)
    ends: dict[int, float] = {}
    for again in (False, True):
        for item, index in entries.items():
            play(probe, item, index)
            ends[item] = probe.now + durations[item]
        if not again:
            probe.keep_alive(AGAIN_AFTER_S)
    while ends:
        state = probe.beat("PLAY again")
        for item, end in list(ends.items()):
            if probe.now > end - EARLY_S:  # without the second PLAY it would be over
                del ends[item]
            elif played_item(state, item) != entries[item]:
                word = ITEM_WORDS[item]
                raise CheckFailed(
                    f"{word} {entries[item]} for {durations[item]:.1f} s after its second PLAY",
                    f"its end {end - probe.now:.1f} s earlier",
                )
        probe.receive(POLL_EVERY_S)


@PLAYING.must
def refusals_end_nothing(probe: Probe) -> None:
    """Refused commands end no motion, sound, mood or emotion, and let go of no joint."""
    try:
        entries = long_entries(probe, m.ITEM_SOUND, m.ITEM_MOTION)
    except NotApplicableError:
        entries = {}
        probe.open_neutral_session()
    welcome = probe.welcome
    assert welcome is not None
    mood = last_mood(probe)
    held = 0
    if probe.takes_move and welcome.joints > 1:
        held = 1 << welcome.joints - 1
        angles = probe.beat("HELLO").joints
        probe.send(m.Move(probe.next_number(), 1.0, 0, held, angles))
        held = probe.keep_alive(EFFECT_WITHIN_S)[-1].held
    probe.express(*_EMOTION, mood)
    expect_emotion(probe, _EMOTION, "EXPRESS")  # before PLAY: a new mood may have its own sound
    for item, index in entries.items():
        play(probe, item, index)
    before = probe.beat("PLAY")
    for command, result in refused_commands(probe):
        probe.command(command, result)
    state = probe.keep_alive(EFFECT_WITHIN_S)[-1]
    for item, index in entries.items():
        expect_still_played(state, item, index, "refused commands")
    if mood != m.NOTHING and before.mood == mood != state.mood:
        raise CheckFailed(f"mood {before.mood} after refused commands", f"mood={state.mood}")
    if probe.version >= 3 and state.held != held:
        raise CheckFailed(f"held={held} after refused commands", f"held={state.held}")
    state = probe.keep_alive(EFFECT_WITHIN_S)[-1]
    if emotion_distance(state, *_EMOTION) > EMOTION_CHANGE:
        shown = f"({state.valence}, {state.arousal})"
        raise CheckFailed(f"{_EMOTION} after refused commands", shown)


@PLAYING.should
def motion_survives_an_emotion(probe: Probe) -> None:
    """EXPRESS does not end the motion that is played, for it comes often."""
    index = long_entries(probe, m.ITEM_MOTION)[m.ITEM_MOTION]
    play(probe, m.ITEM_MOTION, index)
    probe.express(0.4, 0.4)
    state = probe.keep_alive(EFFECT_WITHIN_S)[-1]
    expect_still_played(state, m.ITEM_MOTION, index, "EXPRESS")


def played_item(state: m.State, item: int) -> int:
    """Return the index of the motion or sound that is played."""
    return state.motion if item == m.ITEM_MOTION else state.sound


def start(probe: Probe, item: int, index: int) -> None:
    """Command a motion or a sound with the next number, and expect its ACK."""
    probe.command(m.Play(probe.next_number(), item, index))


def play(probe: Probe, item: int, index: int) -> None:
    """Command a motion or a sound, and wait until STATE shows it, at most 250 ms."""
    start(probe, item, index)
    end = probe.now + EFFECT_WITHIN_S
    while (played := played_item(probe.beat("PLAY"), item)) != index:
        if probe.now > end:
            raise CheckFailed(
                f"STATE({ITEM_WORDS[item]}={index}) within {1000 * EFFECT_WITHIN_S:.0f} ms "
                "after PLAY",
                f"{ITEM_WORDS[item]}={played}",
            )
        probe.receive(POLL_EVERY_S)


def expect_still_played(state: m.State, item: int, index: int, after: str) -> None:
    """Check that STATE still shows a motion or a sound."""
    if played_item(state, item) != index:
        word = ITEM_WORDS[item]
        expected = f"{word} {index} going on after {after}"
        raise CheckFailed(expected, f"{word}={played_item(state, item)}")


def long_entries(probe: Probe, *items: int) -> dict[int, int]:
    """Open a session and return a motion, a sound or both that last long; none is played yet."""
    durations = _known_durations(probe)
    for item in items:
        if durations.get(item, 0.0) < MIN_PLAY_TIME_S:
            raise NotApplicableError(f"it has no {ITEM_WORDS[item]} that lasts long enough")
    probe.open_neutral_session()
    state = probe.beat("HELLO")
    return {item: _idle_entry(probe, state, item) for item in items}


def _entry_count(probe: Probe, item: int) -> int:
    assert probe.welcome is not None
    return probe.welcome.motions if item == m.ITEM_MOTION else probe.welcome.sounds


def _idle_entry(probe: Probe, state: m.State, item: int, exclude: int = m.NOTHING) -> int:
    """Return the last motion or sound that is neither played now nor excluded; 255 if none is."""
    skipped = (played_item(state, item), exclude)
    indices = reversed(range(_entry_count(probe, item)))
    return next((index for index in indices if index not in skipped), m.NOTHING)


def _known_durations(probe: Probe) -> dict[int, float]:
    """Return the duration of a motion and of a sound [s], by item; the first call plays both.

    The duration is infinite if one does not end. Raises NotApplicableError if the robot has
    neither.
    """
    if probe.durations is None:
        probe.durations = _measure_durations(probe)
    if not probe.durations:
        raise NotApplicableError("it has no motions and no sounds")
    return probe.durations


def _measure_durations(probe: Probe) -> dict[int, float]:
    """Play a motion and a sound at the same time, to save time, and measure their durations."""
    probe.open_neutral_session()
    state = probe.beat("HELLO")
    indices = {item: _idle_entry(probe, state, item) for item in PLAYED_ITEMS}
    indices = {item: index for item, index in indices.items() if index != m.NOTHING}
    durations = _play_to_the_end(probe, indices)
    for item, time in durations.items():
        if time < MIN_PLAY_TIME_S and len(durations) > 1:  # the other one may have ended it
            durations |= _play_to_the_end(probe, {item: indices[item]})
    return durations


def _play_to_the_end(probe: Probe, indices: dict[int, int]) -> dict[int, float]:
    """Play entries, and return their durations [s], by item."""
    begin = probe.now
    for item, index in indices.items():
        play(probe, item, index)
    durations: dict[int, float] = {}
    while len(durations) < len(indices):
        state = probe.keep_alive(timing.BEAT_EVERY)[-1]
        for item in indices.keys() - durations.keys():
            if played_item(state, item) != indices[item]:
                durations[item] = probe.now - begin
            elif probe.now - begin > MAX_PLAY_TIME_S:
                durations[item] = inf
    return dict(sorted(durations.items()))


def _check_played(probe: Probe, item: int) -> None:
    """Play an entry that is not played yet, and expect it in STATE."""
    probe.open_session()
    if not _entry_count(probe, item):
        raise NotApplicableError(f"it has no {ITEM_WORDS[item]}s")
    index = _idle_entry(probe, probe.beat("HELLO"), item)
    play(probe, item, 0 if index == m.NOTHING else index)  # 0: the only one, and it is played


def _expect_not_played(probe: Probe, item: int, index: int, after: str) -> None:
    for state in probe.keep_alive(EFFECT_WITHIN_S):
        if played_item(state, item) == index:
            word = ITEM_WORDS[item]
            raise CheckFailed(f"no {word} {index} after {after}", f"{word}={index}")
