"""The robot is what its code makes, shows its mood at every intensity, and its feet hold."""

import numpy as np
import pytest

from cubeling.characters.model.character import Character, skin
from cubeling.characters.skeleton import rotations
from tests.tools.authoring.clip_checks import (
    blend_slide,
    check_ends_meet,
    check_leg_stretch,
    check_same_clips,
    check_vertices,
    moving,
    planted_slide,
)
from tools.authoring.robot.character import build_robot
from tools.authoring.robot.expressions import EXPRESSIONS
from tools.authoring.robot.rig import FEET, LAMPS, MOODS, skeleton

pytestmark = pytest.mark.full

LEVELS = ("head", "legs", "tail")
CLIPS = ("idle", *(f"{mood}_{level}" for mood in MOODS for level in LEVELS))
PLANTED = dict.fromkeys(("idle", "happy_head", "angry_head"), FEET) | {
    "neutral_tail": FEET[1:],
    "happy_legs": FEET[2:],
    "angry_legs": FEET[2:],
    "angry_tail": FEET[2:],
}
"""Feet that never leave the ground, by clip."""


@pytest.fixture(scope="module")
def robot() -> Character:
    return Character.load("robot")


def pitch(robot: Character, name: str, joint: str) -> np.ndarray:
    """Return how far up a joint faces in each frame of a clip, (frames,) [degrees]."""
    posed = robot.clips[name].poses.globals(robot.skeleton)[:, robot.skeleton.index(joint), :3, 2]
    return np.asarray(np.degrees(np.arcsin(posed[:, 1] / np.linalg.norm(posed, axis=1))))


def test_the_asset_is_what_the_code_makes(robot: Character) -> None:
    made = build_robot()
    assert robot.skeleton.names == made.skeleton.names
    assert robot.morphs == made.morphs
    check_same_clips(robot, made)
    assert all(clip.poses.scales is not None for clip in made.clips.values())
    lit = skeleton().rest.globals(made.skeleton)
    for shipped_mesh, mesh in zip(robot.meshes, made.meshes, strict=True):
        assert np.array_equal(shipped_mesh.triangles, mesh.triangles)
        assert np.allclose(skin(shipped_mesh, lit), skin(mesh, lit), atol=1e-5)
        assert np.allclose(shipped_mesh.weights, mesh.weights, atol=2e-3)
        assert np.allclose(shipped_mesh.material.emissive, mesh.material.emissive, atol=1e-6)


def test_its_joints_are_known_for_a_quadrupeds(robot: Character) -> None:
    anatomy = robot.anatomy
    assert anatomy.kind == "quadruped"
    for part in ("hips", "neck", "head", "jaw", "leftEye", "rightEye", "tail1", "tail5"):
        assert part in anatomy.joints
    for side in ("left", "right"):
        assert f"{side}Foot" in anatomy.joints
        assert f"{side}FrontFoot" in anatomy.joints


def test_its_size_and_its_share_of_triangles(robot: Character) -> None:
    assert robot.height == pytest.approx(0.31, abs=0.02)
    assert sum(len(mesh.triangles) for mesh in robot.meshes) < 18_000


def test_every_vertex_is_held_wholly_by_its_joints(robot: Character) -> None:
    check_vertices(robot)


def test_triangles_face_outward(robot: Character) -> None:
    for mesh in robot.meshes:
        a, b, c = (mesh.positions[mesh.triangles[:, corner]] for corner in range(3))
        normals = mesh.normals[mesh.triangles].mean(axis=1)
        outward = np.sum(np.cross(b - a, c - a) * normals, axis=1)
        assert (outward < 0).mean() < 0.01, mesh.name


def test_every_mood_has_three_intensities_in_step(robot: Character) -> None:
    assert sorted(robot.clips) == sorted(CLIPS)
    assert robot.clips["idle"].duration >= 4.0
    for mood in MOODS:
        times = [robot.clips[f"{mood}_{level}"].duration for level in LEVELS]
        assert times == pytest.approx([times[0]] * 3)


@pytest.mark.parametrize("name", CLIPS)
def test_loops_close_without_a_jump(robot: Character, name: str) -> None:
    assert robot.clips[name].loop
    check_ends_meet(robot, name)


@pytest.mark.parametrize("name", PLANTED)
def test_soles_that_stand_do_not_slide(robot: Character, name: str) -> None:
    posed = robot.clips[name].poses.globals(robot.skeleton)
    for foot in PLANTED[name]:
        ankle = posed[:, robot.skeleton.index(foot)]
        assert np.ptp(ankle[:, :3, 3], axis=0).max() < 1e-4, foot
        assert np.ptp(ankle[:, :3, :3], axis=0).max() < 1e-4, foot


@pytest.mark.parametrize("name", CLIPS)
def test_nothing_sinks_into_the_table_and_legs_hardly_stretch(robot: Character, name: str) -> None:
    posed = robot.clips[name].poses.globals(robot.skeleton)[::5]
    assert min(skin(robot.meshes[0], globals_)[:, 1].min() for globals_ in posed) > -0.003
    check_leg_stretch(robot, name, FEET)


def test_the_body_joins_in_as_the_intensity_rises(robot: Character) -> None:
    for mood in ("happy", "angry"):
        head, legs, tail = (f"{mood}_{level}" for level in LEVELS)
        assert max(moving(robot, head, foot) for foot in FEET) < 1e-4
        assert moving(robot, head, "hips") < 1e-4
        assert max(moving(robot, legs, foot) for foot in FEET) > 0.02
        assert moving(robot, tail, "hips") > 1.2 * moving(robot, legs, "hips")
        assert moving(robot, tail, "tail5") > 1.5 * moving(robot, legs, "tail5")


@pytest.mark.parametrize("name", CLIPS)
def test_only_the_lamps_of_its_mood_are_lit(robot: Character, name: str) -> None:
    mood = "neutral" if name == "idle" else name.split("_")[0]
    scales = robot.clips[name].poses.scales
    assert scales is not None
    for lamp in LAMPS:
        lit = scales[:, robot.skeleton.index(lamp), 0]
        assert lit.min() > 0.99 if lamp.endswith(f"_{mood}") else lit.max() < 0.05, lamp


@pytest.mark.parametrize("level", LEVELS)
def test_moods_differ_at_every_moment_of_every_intensity(robot: Character, level: str) -> None:
    """Happy holds the neck high and the lids wide, angry lowers both, and both face ahead."""
    neck = {mood: pitch(robot, f"{mood}_{level}", "neck3") for mood in MOODS}
    assert neck["happy"].min() > neck["angry"].mean() + 10
    assert neck["happy"].mean() > neck["neutral"].mean() > neck["angry"].mean() + 5
    for mood in ("happy", "angry"):
        assert np.abs(pitch(robot, f"{mood}_{level}", "head")).max() < 32

    def lid_height(mood: str) -> float:
        posed = robot.clips[f"{mood}_{level}"].poses
        lid, still = robot.skeleton.index("LeftUpperLid"), robot.skeleton.rest.rotations
        turn = rotations.multiply(rotations.conjugate(still[lid]), posed.rotations[:, lid])
        return float(np.degrees(rotations.to_rotation_vector(turn)[:, 0]).min())

    assert lid_height("angry") > 20
    assert lid_height("happy") < 5


def test_a_mix_of_two_intensities_keeps_feet_that_stand_where_they_are(robot: Character) -> None:
    for mood in ("happy", "angry"):
        clips = [robot.clips[f"{mood}_{level}"] for level in ("head", "legs")]
        times = np.arange(0, clips[0].duration, 1 / 10)
        for foot in FEET[2:]:
            assert blend_slide(robot, clips, foot, times).max() < 0.004, foot


def test_expressions_move_the_face_and_nothing_else(robot: Character) -> None:
    casing = robot.meshes[0]
    assert tuple(morph.name for morph in casing.morphs) == robot.morphs == tuple(EXPRESSIONS)
    below = casing.positions[:, 1] < 0.18
    for morph in casing.morphs:
        assert not below[morph.vertices].any()
        assert 0.004 < np.linalg.norm(morph.displacements, axis=1).max() < 0.06


def test_a_blink_shuts_both_eyes_and_a_wink_one(robot: Character) -> None:
    mesh = robot.meshes[0]
    bind = robot.skeleton.rest.globals(robot.skeleton)
    for name, sides in (("blink", (True, True)), ("blinkLeft", (True, False))):
        moved = skin(mesh, bind, {name: 1.0}) - mesh.positions
        away = np.linalg.norm(moved, axis=1) > 0.01
        left = mesh.positions[:, 0] > 0
        assert (bool((away & left).any()), bool((away & ~left).any())) == sides


@pytest.mark.parametrize("name", CLIPS)
def test_feet_on_the_ground_do_not_skid_between_steps_and_hops(robot: Character, name: str) -> None:
    assert planted_slide(robot, name, FEET) < 0.010


@pytest.mark.parametrize("name", ["idle", "neutral_legs", "neutral_tail"])
def test_it_shifts_its_weight_looks_around_and_taps_while_it_waits(
    robot: Character, name: str
) -> None:
    assert moving(robot, name, "hips") > 0.015
    assert moving(robot, name, "head") > 0.03
    assert name == "idle" or moving(robot, name, "LeftFrontFoot") > 0.015
    assert moving(robot, name, "tail5") > 0.04
