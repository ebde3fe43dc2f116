"""Vleo is what its code makes, stands firm, and keeps its hearts to itself until it kisses."""

import numpy as np
import pytest

from characters import rotations
from characters.authoring.loops import follow, keys, later, wave
from characters.authoring.vleo import build_vleo
from characters.authoring.vleo_rig import BURSTS, FEET, HEARTS
from characters.blend import mix
from characters.character import Character, skin

KISSES = ("kiss_head", "kiss_legs", "kiss_tail")
SHOUTS = ("shout_head", "shout_legs", "shout_tail")
CLIPS = ("idle", *KISSES, *SHOUTS)
HIND = tuple(foot for foot in FEET if "Hind" in foot)
PLANTED = {
    "idle": FEET,
    "kiss_head": FEET,
    "kiss_legs": (*HIND, "RightFrontFoot"),
    "shout_head": FEET,
    "shout_legs": HIND,
    "shout_tail": HIND,
}
"""Feet that never leave the ground, by clip."""


@pytest.fixture(scope="module")
def vleo() -> Character:
    return Character.load("vleo")


def moving(vleo: Character, name: str, joint: str) -> float:
    """Return how far a joint gets from where it is in the first frame of a clip [m]."""
    places = vleo.clips[name].poses.globals(vleo.skeleton)[:, vleo.skeleton.index(joint), :3, 3]
    return float(np.ptp(places, axis=0).max())


def shown(vleo: Character, name: str, joints: tuple[str, ...]) -> np.ndarray:
    """Return the scales of effects, (frames, joints)."""
    scales = vleo.clips[name].poses.scales
    assert scales is not None
    return scales[:, [vleo.skeleton.index(joint) for joint in joints], 0]


def test_the_asset_is_what_the_code_makes(vleo: Character) -> None:
    made = build_vleo()
    assert vleo.skeleton.names == made.skeleton.names
    assert vleo.skeleton.parents == made.skeleton.parents
    assert sorted(vleo.clips) == sorted(made.clips)
    for name, clip in made.clips.items():
        shipped = vleo.clips[name].poses
        assert np.allclose(shipped.translations, clip.poses.translations, atol=1e-5), name
        same = rotations.align(shipped.rotations, clip.poses.rotations)
        assert np.allclose(same, clip.poses.rotations, atol=1e-4), name
        assert shipped.scales is not None
        assert clip.poses.scales is not None
        assert np.allclose(shipped.scales, clip.poses.scales, atol=1e-5), name
    for shipped_mesh, mesh in zip(vleo.meshes, made.meshes, strict=True):
        assert np.array_equal(shipped_mesh.triangles, mesh.triangles)
        assert np.allclose(shipped_mesh.positions, mesh.positions, atol=1e-5)
        assert np.allclose(shipped_mesh.weights, mesh.weights, atol=2e-3)


def test_is_a_baby_sauropod_of_its_size(vleo: Character) -> None:
    assert vleo.skeleton.names[0] == "root"
    assert vleo.height == pytest.approx(0.29, abs=0.02)
    length = vleo.bounds[1, 2] - vleo.bounds[0, 2]
    assert length == pytest.approx(0.45, abs=0.03)
    assert sum(len(mesh.triangles) for mesh in vleo.meshes) < 20_000


def test_every_vertex_is_held_wholly_by_its_joints(vleo: Character) -> None:
    for mesh in vleo.meshes:
        assert np.allclose(mesh.weights.sum(axis=1), 1.0, atol=1e-5)
        assert np.allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-3)


def test_triangles_face_outward(vleo: Character) -> None:
    mesh = vleo.meshes[0]
    a, b, c = (mesh.positions[mesh.triangles[:, corner]] for corner in range(3))
    outward = np.sum(np.cross(b - a, c - a) * mesh.normals[mesh.triangles].mean(axis=1), axis=1)
    assert (outward < 0).mean() < 0.005  # but for slivers in the corners of the mouth


def test_knows_to_idle_and_two_actions_at_three_intensities(vleo: Character) -> None:
    assert sorted(vleo.clips) == sorted(CLIPS)
    assert vleo.clips["idle"].duration == pytest.approx(7.0)
    assert [vleo.clips[name].duration for name in KISSES] == pytest.approx([2.4] * 3)
    assert [vleo.clips[name].duration for name in SHOUTS] == pytest.approx([2.0] * 3)


@pytest.mark.parametrize("name", CLIPS)
def test_loops_close_without_a_jump(vleo: Character, name: str) -> None:
    clip = vleo.clips[name]
    poses = clip.poses
    assert clip.loop
    assert np.allclose(poses.translations[0], poses.translations[-1], atol=1e-6)
    assert np.allclose(rotations.align(poses.rotations[-1], poses.rotations[0]), poses.rotations[0])
    spine = poses.globals(vleo.skeleton)[:, vleo.skeleton.index("head"), :3, 3]
    steps = np.linalg.norm(np.diff(spine, axis=0), axis=1)
    assert abs(steps[0] - steps[-1]) < 0.4 * steps.max()


@pytest.mark.parametrize("name", PLANTED)
def test_soles_that_stand_do_not_slide(vleo: Character, name: str) -> None:
    mesh, skeleton = vleo.meshes[0], vleo.skeleton
    posed = vleo.clips[name].poses.globals(skeleton)[::6]
    places = np.stack([skin(mesh, globals_) for globals_ in posed])
    for foot in PLANTED[name]:
        held = mesh.weights * (mesh.joints == skeleton.index(foot))
        sole = (held.sum(axis=1) > 0.5) & (places[0, :, 1] < 0.006)
        assert sole.sum() > 10
        assert np.ptp(places[:, sole], axis=0).max() < 0.002, foot


@pytest.mark.parametrize(("less", "more"), [("head", "legs"), ("legs", "tail")])
@pytest.mark.parametrize("action", ["kiss", "shout"])
def test_feet_that_stand_hardly_slide_in_a_blend_at_equal_phase(
    vleo: Character, action: str, less: str, more: str
) -> None:
    clips = [vleo.clips[f"{action}_{name}"] for name in (less, more)]
    times = np.arange(0, clips[0].duration, 1 / 30)
    for foot in PLANTED.get(clips[1].name, ()):
        joint = vleo.skeleton.index(foot)
        half = [mix([clip.sample(time) for clip in clips], [0.5, 0.5]) for time in times]
        places = np.array([pose.globals(vleo.skeleton)[joint, :3, 3] for pose in half])
        assert np.ptp(places, axis=0).max() < 0.004, foot


@pytest.mark.parametrize("name", CLIPS)
def test_legs_stretch_only_a_little(vleo: Character, name: str) -> None:
    for foot in FEET:
        shin = vleo.skeleton.index(foot)
        lengths = np.linalg.norm(vleo.clips[name].poses.translations[:, shin], axis=1)
        assert lengths.max() < 1.2 * lengths.min()


@pytest.mark.parametrize("name", CLIPS)
def test_nothing_sinks_into_the_table(vleo: Character, name: str) -> None:
    posed = vleo.clips[name].poses.globals(vleo.skeleton)[::3]
    assert min(skin(vleo.meshes[0], globals_)[:, 1].min() for globals_ in posed) > -0.004


def test_the_body_joins_in_as_the_intensity_rises(vleo: Character) -> None:
    for head, legs, tail in (KISSES, SHOUTS):
        assert all(moving(vleo, head, foot) < 1e-4 for foot in FEET)
        assert moving(vleo, head, "hips") < 1e-4
        assert max(moving(vleo, legs, foot) for foot in FEET) > 0.02
        assert moving(vleo, legs, "hips") > 0.015
        assert moving(vleo, tail, "hips") > moving(vleo, legs, "hips")
        assert moving(vleo, tail, "tail5") > 2 * moving(vleo, legs, "tail5")


def test_the_accents_of_an_action_fall_together_at_every_intensity(vleo: Character) -> None:
    for names in (KISSES, SHOUTS):
        neck = vleo.skeleton.index("neck1")
        bends = [vleo.clips[name].poses.rotations[:, neck, 0] for name in names]
        assert np.ptp([int(np.argmax(np.abs(bend))) for bend in bends]) <= 1


def test_hearts_come_with_kisses_and_sparks_with_shouts_only(vleo: Character) -> None:
    for name in CLIPS:
        for effects, action in ((HEARTS, "kiss"), (BURSTS, "shout")):
            most = shown(vleo, name, effects).max()
            assert most > 0.5 if name.startswith(action) else most <= 1e-3
    for effects, names in ((HEARTS, KISSES), (BURSTS, SHOUTS)):
        sizes = [shown(vleo, name, effects).max(axis=0).sum() for name in names]
        assert sizes[0] < sizes[1] < sizes[2]
    assert vleo.skeleton.rest.scales is not None
    hidden = [vleo.skeleton.index(joint) for joint in (*HEARTS, *BURSTS)]
    assert vleo.skeleton.rest.scales[hidden].max() <= 1e-3


def shape_at(vleo: Character, name: str, morph: str, phase: float) -> float:
    """Return how far a morph is on at a phase of a clip."""
    morphs = vleo.clips[name].sample(phase * vleo.clips[name].duration).morphs
    assert morphs is not None
    return float(morphs[vleo.morphs.index(morph)])


def test_eyes_shut_and_lips_pucker_at_the_kiss(vleo: Character) -> None:
    for kiss in KISSES:
        assert shape_at(vleo, kiss, "blink", 0.45) > 0.98
        assert shape_at(vleo, kiss, "ou", 0.45) > 1.0
        assert shape_at(vleo, kiss, "happy", 0.66) > 0.9


def test_mouth_gapes_in_anger_at_the_shout(vleo: Character) -> None:
    for shout in SHOUTS:
        assert shape_at(vleo, shout, "aa", 0.33) > 0.9
        assert shape_at(vleo, shout, "angry", 0.33) > 0.9
        assert shape_at(vleo, shout, "blink", 0.33) == 0


def test_clips_leave_blinking_to_life_but_for_the_kiss(vleo: Character) -> None:
    for name, clip in vleo.clips.items():
        assert clip.poses.morphs is not None
        closed = clip.poses.morphs[:, vleo.morphs.index("blink")]
        assert closed.max() <= 1.0
        assert (closed.max() > 0.0) == (name in KISSES), name


def test_keys_are_met_and_never_overshot() -> None:
    curve = keys(100, (0.1, 2.0), (0.4, -1.0), (0.7, 0.5))
    assert curve[[10, 40, 70]] == pytest.approx([2.0, -1.0, 0.5])
    assert curve.max() == pytest.approx(2.0)
    assert curve.min() == pytest.approx(-1.0)


def test_a_spring_follows_late_and_loops() -> None:
    curve = wave(240, 2)
    behind = follow(curve, seconds=8.0, hertz=1.0, damping=0.5)
    assert int(np.argmax(behind[:120])) > int(np.argmax(curve[:120]))
    assert np.allclose(behind[:120], behind[120:])
    assert np.allclose(later(curve, 0.25), np.roll(curve, 60))
