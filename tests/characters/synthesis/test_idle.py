"""Idle motion: how a person goes on to stand as she stood, and how she feels."""

import copy
from collections import Counter
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.affect import NEUTRAL, Emotion
from cubeling.affect.regions import NEUTRAL_RADIUS, region_of
from cubeling.characters import (
    Character,
    CharacterError,
    MaskedLayer,
    Pose,
    RootDelta,
    RootOffset,
    mask_of,
)
from cubeling.characters.skeleton import rotations
from cubeling.characters.synthesis.idle.bridges import fit, nearest_clip
from cubeling.characters.synthesis.idle.database import IdleDatabase
from cubeling.characters.synthesis.idle.idle_motion import REACTION_S, IdleMotion
from cubeling.characters.synthesis.idle.pauses import PauseLaw
from cubeling.characters.synthesis.idle.posture_space import PostureVectors
from cubeling.characters.synthesis.idle.recordings import RestSpan, StandingRecording, find_rests
from tests.characters.synthesis.stander import RATE, SIDES, database as database, kind as kind


@given(st.integers(2, 30), st.integers(0, 2**32 - 1))
def test_a_fitted_clip_meets_its_keys(length: int, seed: int) -> None:
    rng = np.random.default_rng(seed)
    clip = rng.normal(size=(length, 4))
    frames = sorted(rng.choice(length, min(3, length), replace=False).tolist())
    keys = [(frame, rng.normal(size=4)) for frame in frames]
    fitted = fit(clip, keys)
    for frame, posture in keys:
        assert fitted[frame] == pytest.approx(posture, abs=1e-12)
    for end in {0, length - 1} - set(frames):
        assert fitted[end] == pytest.approx(clip[end], abs=1e-12)
    assert fit(fitted, keys) == pytest.approx(fitted, abs=1e-12)
    bends = np.abs(np.diff(fitted - clip, 2, axis=0)).max(1) > 1e-9
    assert set((np.flatnonzero(bends) + 1).tolist()) <= set(frames)


def test_fitting_in_the_posture_space_is_fitting_the_vectors(database: IdleDatabase) -> None:
    clip, space = database.shifts[0].vectors, database.space
    keys = [(0, database.postures[0].vector), (len(clip) - 1, database.postures[1].vector)]
    inside = fit(space.project(clip), [(frame, space.project(each)) for frame, each in keys])
    assert space.restore(inside) == pytest.approx(fit(clip, keys), abs=1e-9)


def test_the_nearest_clip_is_near_at_both_ends() -> None:
    ends = np.array([[0.0, 9.0], [2.0, 2.0], [8.0, 0.0]])[..., None]
    assert nearest_clip(ends[:, 0], ends[:, 1], np.zeros(1), np.zeros(1)) == 1


def balances(motion: IdleMotion, database: IdleDatabase, seconds: float) -> list[tuple[str, int]]:
    """Play, and return where it rested and for how many frames, without variations."""
    found: list[tuple[str, int]] = []
    known = {each.vector.tobytes(): each.balance for each in database.postures}
    for _ in range(round(seconds * database.rate)):
        name = known.get(motion.next_posture().tobytes(), "")
        if found and found[-1][0] == name:
            found[-1] = name, found[-1][1] + 1
        else:
            found.append((name, 1))
    return found


def test_generated_shifts_and_pauses_are_those_of_the_person(database: IdleDatabase) -> None:
    found = [each for each in balances(IdleMotion(database, 5), database, 1500.0) if each[0]]
    for name, frames in found[:-1]:
        low, high = database.pause_limits(name)
        assert low - 0.05 <= frames / RATE <= high + 0.1
    pairs = Counter(pairwise(name for name, _ in found))
    square = freedom = 0.0
    for name in SIDES:
        row = {end: pairs[name, end] for end in SIDES}
        total = sum(row.values())
        expected = {end: total * p for end, p in database.probabilities(name).items()}
        square += sum((row[end] - most) ** 2 / most for end, most in expected.items())
        freedom += len(expected) - 1
    assert square < {3.0: 16.3}[freedom]  # p = 0.001


def test_nothing_jumps(database: IdleDatabase, kind: PostureVectors) -> None:
    motion = IdleMotion(database, 2)
    poses = [motion.sample(number / RATE) for number in range(3000)]
    shown = Pose.of_frames(poses)
    recorded = max(np.abs(np.diff(each.vectors, axis=0)).max() for each in database.shifts)
    assert np.abs(np.diff(kind.vectors(shown), axis=0)).max() < 1.5 * recorded


def test_it_shifts_when_told_to(database: IdleDatabase) -> None:
    waiting = IdleMotion(database, 7)
    waiting.feel(Emotion(0.0, -1.0))  # long pauses
    balances(waiting, database, 0.2)
    waiting.shift_now()
    assert balances(waiting, database, 0.2)[-1][0] == ""


@pytest.mark.parametrize(("activation", "mean"), [(1.0, 0.0), (0.0, 1.0), (-1.0, 2.0)])
def test_active_people_pause_less(database: IdleDatabase, activation: float, mean: float) -> None:
    """Neutral ones pause as long as was recorded."""
    motion = IdleMotion(database, 8)
    motion.feel(Emotion(0.0, activation))
    posture, chances = database.postures[0], np.random.default_rng(9).uniform(size=1000)
    low, high = database.pause_limits(posture.balance)
    own = np.mean([each.duration for each in database.by_balance[posture.balance]])
    found = np.mean([motion.pause(posture, chance) for chance in chances])
    assert found == pytest.approx(low + mean * (own - low), abs=0.06 * (high - low))


def test_long_rests_and_bursts_of_shifts_stay_so(kind: PostureVectors) -> None:
    rng = np.random.default_rng(3)
    rests = [20.0, 0.6, 0.5, 0.4, 25.0, 0.5, 0.6, 30.0]
    balance = [np.full(round(rests[0] * RATE), 0.4)]
    for number, seconds in enumerate(rests[1:]):
        u = np.linspace(0.0, 1.0, round(0.8 * RATE))
        start, end = (0.4, -0.4) if number % 2 == 0 else (-0.4, 0.4)
        balance += [
            start + (end - start) * u * u * (3 - 2 * u),
            np.full(round(seconds * RATE), end),
        ]
    way = np.concatenate(balance)
    vectors = np.outer(way, rng.normal(size=kind.size) * 0.2)
    person = StandingRecording("anna", RATE, vectors, way, find_rests(way, RATE))
    database = IdleDatabase.of([person], kind)
    found = [n for name, n in balances(IdleMotion(database, 4), database, 1500.0) if name]
    recorded = [(rest.end - rest.first) / RATE for rest in person.rests]
    per_minute = 60.0 * (len(found) - 1) / 1500.0
    assert per_minute == pytest.approx(60.0 * (len(recorded) - 1) / (len(way) / RATE), rel=0.25)
    long = [seconds > 10.0 for seconds in np.array(found) / RATE]
    assert np.mean(long) == pytest.approx(3 / 8, abs=0.15)


def test_poses_are_the_same_for_the_same_seed_only(database: IdleDatabase) -> None:
    one, same, other = (IdleMotion(database, seed) for seed in (1, 1, 2))
    times = np.arange(0.0, 5.0, 1 / 60)
    poses = [np.stack([each.sample(t).rotations for t in times]) for each in (one, same, other)]
    assert np.array_equal(poses[0], poses[1])
    assert not np.allclose(poses[0], poses[2])
    assert np.linalg.norm(rotations.normalize(poses[0]) - poses[0]) < 1e-9


def test_entered_again_it_goes_on(database: IdleDatabase) -> None:
    motion, same = IdleMotion(database, 1), IdleMotion(database, 1)
    for number in range(600):
        motion.sample(number / 60)
        same.sample(number / 60)
    onward = same.sample(10.0 + 2 / RATE)
    assert motion.sample(0.0).rotations == pytest.approx(onward.rotations, abs=1e-9)
    later = copy.deepcopy(motion)  # as a session does before it steps back
    assert np.array_equal(motion.sample(4.0).rotations, later.sample(4.0).rotations)


def test_shifts_can_be_added_and_removed_while_it_plays(database: IdleDatabase) -> None:
    motion = IdleMotion(database, 9)
    motion.sample(3.0)
    motion.database = database.without_shift(0)
    motion.sample(6.0)
    motion.database = motion.database.with_shift(database.shifts[0])
    motion.sample(9.0)
    assert set(map(id, motion.database.shifts)) == set(map(id, database.shifts))


def test_somebody_without_shifts_stands_where_she_stood(database: IdleDatabase) -> None:
    still = IdleMotion(replace(database, shifts=()), 1)
    assert len({still.next_posture().tobytes() for _ in range(2000)}) == 1


@pytest.fixture(scope="module")
def moody(database: IdleDatabase) -> IdleDatabase:
    """The same stander, who bends when she is sad and raises her arms when she is happy."""
    felt = [None, region_of("sad"), region_of("happy")]
    postures = tuple(
        replace(each, vector=each.vector + number, feeling=region)
        for number, region in enumerate(felt)
        for each in database.postures
    )
    shifts = tuple(replace(s, feeling=region) for region in felt for s in database.shifts)
    return replace(database, postures=postures, shifts=shifts)


def test_postures_and_shifts_suit_the_emotion(moody: IdleDatabase) -> None:
    for emotion in (Emotion(-0.6, -0.5), Emotion(0.5, 0.6)):
        suiting = moody.for_emotion(emotion)
        felt = [p.feeling for p in suiting.postures] + [s.feeling for s in suiting.shifts]
        assert all(region is not None and region.contains(emotion) for region in felt)
    for emotion in (NEUTRAL, Emotion(0.0, -0.9)):  # no region of its own
        assert {each.feeling for each in moody.for_emotion(emotion).postures} == {None}


def test_a_new_emotion_shows_soon_and_without_a_jump(moody: IdleDatabase) -> None:
    motion = IdleMotion(moody, 3)
    rows = [motion.next_posture() for _ in range(100)]
    motion.feel(Emotion(0.5, 0.6))
    rows += [motion.next_posture() for _ in range(400)]
    postures = moody.for_emotion(Emotion(0.5, 0.6)).postures
    suits = [any(np.array_equal(row, p.vector) for p in postures) for row in rows]
    shift = max(len(each.vectors) for each in moody.shifts)
    assert not any(suits[:100])
    assert any(suits[100 : 100 + round(REACTION_S * RATE) + 2 * shift])
    assert np.abs(np.diff(rows, axis=0)).max() < 0.2  # the way of 2 is spread over a shift


def test_small_variations_are_those_of_the_emotion(database: IdleDatabase) -> None:
    felt = [region_of("sad"), region_of("happy")]
    sizes = (0.2, 5.0)
    moods = tuple(
        replace(each, feeling=region, frames=each.vector + size * (frames - each.vector))
        for region, size in zip(felt, sizes, strict=True)
        for each, frames in zip(database.postures, database.rests, strict=True)
    )
    motion = IdleMotion(replace(database, postures=moods, shifts=()), 2)
    spreads: list[float] = []
    for emotion in (Emotion(-0.6, -0.5), Emotion(0.5, 0.6)):
        motion.feel(emotion)
        first = len(spreads) * 40.0
        rows = database.kind.vectors(
            Pose.of_frames(motion.sample(first + n / RATE) for n in range(1000))
        )
        assert np.abs(np.diff(rows, axis=0)).max() < 0.1  # nothing jumps
        spreads.append(rows[100:].std(0).mean())
    assert spreads[1] > 5.0 * spreads[0]


def test_a_gesture_is_not_dampened_and_the_rest_of_the_body_idles(
    human: Character, database: IdleDatabase
) -> None:
    arm = mask_of(human.skeleton, {"RightShoulder": 1.0})
    wave, masked = human.clips["wave"], arm == 1.0
    blended = MaskedLayer(IdleMotion(database, 1), wave, mask=arm)
    alone = IdleMotion(database, 1)
    for time in np.arange(0.0, 2.0, 1 / 30).tolist():
        pose, gesture, idle = blended.sample(time), wave.sample(time), alone.sample(time)
        assert pose.rotations[masked] == pytest.approx(gesture.rotations[masked], abs=1e-14)
        assert np.array_equal(pose.rotations[arm == 0.0], idle.rotations[arm == 0.0])


def test_a_person_elsewhere_differs_by_her_root_only(
    human: Character, database: IdleDatabase
) -> None:
    there = RootOffset(IdleMotion(database, 1), RootDelta(1.0, 2.0, 0.5))
    here = IdleMotion(database, 1)
    for time in (0.0, 1.0, 7.0):
        one, other = here.sample(time), there.sample(time)
        assert np.array_equal(one.rotations[1:], other.rotations[1:])
        assert np.array_equal(one.translations[1:], other.translations[1:])
        assert other.translations[0] == pytest.approx(one.translations[0] + [1.0, 0.0, 2.0])


def test_small_changes_of_an_emotion_do_not_hurry_her(moody: IdleDatabase) -> None:
    motion = IdleMotion(moody, 4)
    edge = Emotion(NEUTRAL_RADIUS + 0.01, NEUTRAL_RADIUS + 0.01)
    motion.feel(edge)
    shifts = 0
    for number in range(2500):
        before = len(motion._shift)
        motion.feel(Emotion(edge.valence + (-0.03 if number % 2 else 0.0), edge.arousal))
        motion.next_posture()
        shifts += before == 0 and len(motion._shift) > 0
    assert shifts < 2500 / RATE / 2.0


@pytest.mark.parametrize(
    ("law", "activation", "share"),
    [
        (PauseLaw(), 1.0, 0.0),
        (PauseLaw(), 0.0, 1.0),
        (PauseLaw(), -1.0, 2.0),
        (PauseLaw(alpha=2.0), 1.0, 1.0),
        (PauseLaw(beta=0.5), -1.0, 1.0),
        (PauseLaw(beta=0.0), -1.0, 0.0),
    ],
)
def test_alpha_and_beta_set_how_activation_shortens_pauses(
    database: IdleDatabase, law: PauseLaw, activation: float, share: float
) -> None:
    """Equation 4.2 of Egges 2006, with her own rests for p_o."""
    motion = IdleMotion(database, pauses=law)
    motion.feel(Emotion(0.0, activation))
    posture = database.postures[0]
    least = database.pause_limits(posture.balance)[0]
    for chance in (0.1, 0.5, 0.9):
        dwells = database.dwells[posture.balance]
        dwell = float(dwells[int(chance * len(dwells))])
        expected = min(least, dwell) + share * (dwell - min(least, dwell))
        assert motion.pause(posture, chance) == pytest.approx(expected)


@pytest.mark.parametrize(("alpha", "beta"), [(0.5, 1.0), (1.0, -0.1), (float("nan"), 1.0)])
def test_a_pause_law_out_of_range_is_refused(alpha: float, beta: float) -> None:
    with pytest.raises(CharacterError, match=r"alpha .* is to be 1 to 10, and beta"):
        PauseLaw(alpha, beta)


def test_as_one_emotion_becomes_another_the_shift_between_them_plays(
    database: IdleDatabase,
) -> None:
    """A recording that begins happy and ends sad: its last shift leads from one to the other."""
    happy, sad = region_of("happy"), region_of("sad")
    still = np.repeat(database.postures[0].vector[None], 300, axis=0)
    ways = {}
    for name, lift in (("turning", 0.3), ("sad", -0.3)):
        vectors = still.copy()
        vectors[100:150] += lift * np.sin(np.linspace(0.0, np.pi, 50))[:, None]
        rests = (RestSpan(0, 100, "left"), RestSpan(150, 300, "right"))
        before = happy if name == "turning" else None
        zeros = np.zeros(300)
        ways[name] = StandingRecording(name, RATE, vectors, zeros, rests, sad, before)
    turned = (RestSpan(0, 100, "right"), RestSpan(150, 300, "left"))
    back = replace(ways["sad"], name="back", rests=turned)
    known = IdleDatabase.of((ways["turning"], ways["sad"], back), database.kind)
    turning = [shift for shift in known.shifts if shift.before == happy]
    assert [(s.feeling, s.start, s.end) for s in turning] == [(sad, "left", "right")]
    motion = IdleMotion(known, 1)
    motion.feel(Emotion(0.5, 0.6))
    rows = [motion.next_posture() for _ in range(50)]
    motion.feel(Emotion(-0.6, -0.5))
    rows += [motion.next_posture() for _ in range(2000)]
    base = still[0]
    highest = np.array([(row - base).max() for row in rows])
    raised = np.flatnonzero(highest > 0.2)
    assert 50 < raised[0] < 50 + (REACTION_S + 2.0) * RATE
    # Once: sad as she is then, she shifts as sad people do.
    assert raised[-1] - raised[0] < 60
    assert any((row - base).min() < -0.2 for row in rows)
