"""Capsules, safe ranges and dependent joints of upper bodies."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters import Animator, Character, CharacterError, Pose
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.gestures.timing import natural_times
from cubeling.characters.behaviour.intents import BehaviourIntent, GestureIntent
from cubeling.characters.body.capsules import CapsuleBody, segment_distances
from cubeling.characters.body.dependent_joints import DependentJoints, fade
from cubeling.characters.body.self_collision import SafeRanges, damp
from cubeling.characters.control.layers import BODY_LAYERS
from cubeling.characters.model.sidecar import BODY_LAYERS as KNOWN_TO_SIDECARS
from cubeling.characters.skeleton import rotations
from cubeling.characters.synthesis.idle.posture_space import PostureVectors
from tests.bench.upper_body import wide_arms
from tests.characters.commands import command


@pytest.fixture(scope="module")
def human() -> Character:
    return Character.load("human")


@pytest.fixture(scope="module")
def kind(human: Character) -> PostureVectors:
    return PostureVectors.of(human.skeleton, human.anatomy, "upper")


@pytest.fixture(scope="module")
def body(human: Character) -> CapsuleBody:
    return CapsuleBody.of(human.skeleton, human.anatomy, human.meshes, human.clips["idle"].poses)


@pytest.fixture(scope="module")
def ranges(human: Character, kind: PostureVectors, body: CapsuleBody) -> SafeRanges:
    wide = [wide_arms(human, kind, seed)[::3] for seed in (1, 2, 3)]
    return SafeRanges.of(wide, kind, body, human.clips["idle"].poses[:1])


def test_damping_has_the_values_of_the_corrected_formula() -> None:
    values = np.array([0.6, 0.7, 0.75, 0.8, 0.85, 0.9, 0.95, 1.0, 3.0, -2.0])
    known = [0.6, 0.7, 0.762059, 0.835, 0.90375, 0.958125, 0.990713, 1.0, 1.0, -2.0]
    assert damp(values, np.ones(10), 0.7, 0.9) == pytest.approx(known, abs=5e-7)


@given(st.floats(0.1, 0.9), st.floats(0.78, 1.0), st.floats(0.01, 100.0))  # see `damp`
def test_damping_is_continuous_and_never_turns_back(threshold, scale, limit) -> None:
    values = np.linspace(-limit, 2.0 * limit, 3000)
    found = damp(values, np.full(3000, limit), threshold, scale)
    assert found.max() <= limit * (1 + 1e-12)
    steps = np.diff(found)
    assert steps.min() >= -1e-9 * limit
    assert steps.max() < 0.05 * limit  # the steepest place is at a late threshold
    inside = values <= threshold * limit
    assert np.array_equal(found[inside], values[inside])


@given(st.integers(0, 2**32 - 1))
def test_distances_of_segments_are_the_least(seed: int) -> None:
    a, b, c, d = np.random.default_rng(seed).normal(size=(4, 3))
    shares = np.linspace(0.0, 1.0, 60)
    ours = a + shares[:, None] * (b - a)
    theirs = c + shares[:, None] * (d - c)
    least = np.linalg.norm(ours[:, None] - theirs, axis=-1).min()
    found = float(segment_distances(a, b, c, d))
    assert found <= least + 1e-9
    assert found == pytest.approx(least, abs=0.1)


def test_clear_poses_do_not_collide_and_crossed_arms_do(human, body, kind) -> None:
    assert not body.collides(human.clips["idle"].poses, human.skeleton).any()
    assert not body.collides(human.clips["Walk"].poses, human.skeleton).any()
    wide = wide_arms(human, kind, 9)
    assert body.collides(wide, human.skeleton).mean() > 0.05


@pytest.mark.slow(reason="a share of frames needs many of them")
def test_few_frames_collide_in_the_ranges_and_legs_stay(human, body, kind, ranges) -> None:
    wide = wide_arms(human, kind, 9)[::3]
    kept = ranges.keep(wide)
    before, after = (body.collides(each, human.skeleton).sum() for each in (wide, kept))
    assert after <= 0.2 * before
    legs = [joint for joint in range(len(human.skeleton)) if joint not in kind.joints]
    assert np.array_equal(kept.rotations[:, legs], wide.rotations[:, legs])
    assert kept.translations is wide.translations
    single = ranges.keep(wide[233])
    assert single.rotations == pytest.approx(kept.rotations[233], abs=1e-9)
    at = ranges.space.project(kind.vectors(kept), len(ranges.high))
    assert (at <= ranges.high + 1e-9).all()
    assert (at >= ranges.low - 1e-9).all()


@pytest.fixture(scope="module")
def dependent(human: Character, kind: PostureVectors) -> DependentJoints:
    return DependentJoints.of([clip.poses for clip in human.clips.values()], kind)


def test_the_filter_is_linear_and_keeps_what_was_recorded(human, kind, dependent) -> None:
    rows = kind.vectors(human.clips["cheer"].poses)
    one, other = rows[3], rows[20]
    mixed = dependent.apply(0.3 * one + 0.7 * other)
    assert mixed == pytest.approx(0.3 * dependent.apply(one) + 0.7 * dependent.apply(other))
    assert dependent.apply(dependent.neutral) == pytest.approx(dependent.neutral)
    assert dependent.operator == pytest.approx(dependent.operator.T)
    assert np.abs(dependent.apply(rows) - rows).max() < 0.2
    assert np.diff(fade(48)).max() <= 0.0


def test_a_gesture_of_one_arm_moves_the_others_too_but_not_the_legs(human, kind, dependent) -> None:
    arm = human.anatomy.joints["rightUpperArm"]
    turns = kind.poses(dependent.neutral[None]).rotations
    turns[:, arm] = rotations.multiply(turns[:, arm], rotations.about("x", -1.2))
    pose = Pose(human.skeleton.rest.translations[None], turns)
    moved = dependent.move(pose)
    angle = np.linalg.norm(rotations.to_rotation_vector(
        rotations.multiply(rotations.conjugate(pose.rotations), moved.rotations))[0], axis=1
    )  # fmt: skip
    for part in ("chest", "rightShoulder", "head"):
        assert angle[human.anatomy.joints[part]] > np.radians(0.3)
    legs = [joint for joint in range(len(human.skeleton)) if joint not in kind.joints]
    assert np.array_equal(moved.rotations[:, legs], pose.rotations[:, legs])


def test_who_smiles_still_smiles_when_the_body_is_changed(human, dependent, ranges) -> None:
    waving = human.clips["wave"].poses
    for change in (dependent.move, ranges.keep):
        assert np.array_equal(change(waving).morphs, waving.morphs)
        assert np.array_equal(change(waving[20]).morphs, waving.morphs[20])
        one, same = change(waving[20]), change(waving)[20]
        assert one.rotations == pytest.approx(same.rotations, abs=1e-9)


def errors(human: Character, kind: PostureVectors, starts: list[float]) -> list[float]:
    rows = kind.vectors(human.clips["cheer"].poses)
    clips = [clip.poses for clip in human.clips.values()]
    filters = [DependentJoints.of(clips, kind, start, start + 0.2) for start in starts]
    return [float(np.abs(each.apply(rows) - rows).mean()) for each in filters]


def test_the_later_it_fades_the_nearer_is_the_gesture(human, kind) -> None:
    found = errors(human, kind, [0.1, 0.3, 0.5, 0.7])
    assert all(a > b for a, b in itertools.pairwise(found))


@pytest.mark.slow(reason="what its arms may do without touching its body is found")
def test_a_file_beside_the_character_asks_for_the_layers(human: Character) -> None:
    asking = replace(human, body_layers=tuple(BODY_LAYERS))
    assert set(BODY_LAYERS) == set(KNOWN_TO_SIDECARS)
    animator, plain = Animator(asking), Animator(human)
    for number in range(60):
        asked = command(number / 30, "wave")
        pose, own = animator.update(asked).pose, plain.update(asked).pose
        assert np.isfinite(pose.rotations).all()
    lower = [j for n, j in human.anatomy.joints.items() if n.endswith(("Leg", "Foot", "hips"))]
    assert np.array_equal(pose.rotations[lower], own.rotations[lower])
    assert not np.array_equal(pose.rotations, own.rotations)


@pytest.mark.parametrize("name", BODY_LAYERS)
def test_layers_for_people_are_refused_to_others(name: str) -> None:
    asking = replace(Character.load("vleo"), body_layers=(name,))
    with pytest.raises(CharacterError, match=r"vleo: .* a person with"):
        Animator(asking)


def test_dependent_joints_join_in_gestures_and_leave_legs_alone(human: Character) -> None:
    wave = GestureCollection.load_bundled().get("WAVE")
    intent = GestureIntent("wave", wave, natural_times(wave, 1.0), "right")
    asked = BehaviourIntent(gestures=(intent,))
    on = replace(human, body_layers=("dependent_joints",))
    frames = []
    for character in (human, on):
        animator = Animator(character)
        frames.append([animator.update(command(n / 30, behaviour=asked)).pose for n in range(90)])
    off, joined = (np.stack([pose.rotations for pose in poses]) for poses in frames)
    turned = np.degrees(2.0 * np.arccos(np.abs(np.vecdot(off, joined)).clip(0.0, 1.0)))
    assert turned[0].max() < 0.01
    trunk = [human.anatomy.joints[part] for part in ("spine", "chest", "neck", "head")]
    assert turned[:, trunk].max() > 2.0
    legs = [joint for part, joint in human.anatomy.joints.items() if "Leg" in part]
    assert turned[:, legs].max() < 0.01
