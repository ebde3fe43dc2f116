"""Vleo is what its code makes, stands firm, and keeps its hearts to itself until it kisses."""

import numpy as np
import pytest

from cubeling.characters.model.character import Character, skin
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose
from tests.tools.authoring.clip_checks import (
    blend_slide,
    check_ends_meet,
    check_leg_stretch,
    check_same_clips,
    check_vertices,
    moving,
    planted_slide,
)
from tools.authoring.vleo.character import build_vleo
from tools.authoring.vleo.expressions import EXPRESSIONS as FACES
from tools.authoring.vleo.head import EYE_RADIUS_M, REST_GAZE
from tools.authoring.vleo.rig import BURSTS, EYE_CENTRE_M, FEET, HEARTS

pytestmark = pytest.mark.full

KISSES = ("kiss_head", "kiss_legs", "kiss_tail")
SHOUTS = ("shout_head", "shout_legs", "shout_tail")
GESTURES = ("nod", "shake")
CLIPS = ("idle", *KISSES, *SHOUTS, *GESTURES)
EXPRESSIONS = (
    *("blink", "blinkLeft", "blinkRight", "happy", "angry", "sad", "surprised", "relaxed"),
    *("aa", "ih", "ou", "ee", "oh"),
)
HIND = tuple(foot for foot in FEET if "Hind" in foot)
PLANTED = {
    "idle": FEET,
    "nod": FEET,
    "shake": FEET,
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


def shown(vleo: Character, name: str, joints: tuple[str, ...]) -> np.ndarray:
    """Return the scales of effects, (frames, joints)."""
    scales = vleo.clips[name].poses.scales
    assert scales is not None
    return scales[:, [vleo.skeleton.index(joint) for joint in joints], 0]


def test_the_asset_is_what_the_code_makes(vleo: Character) -> None:
    made = build_vleo()
    assert vleo.skeleton.names == made.skeleton.names
    assert vleo.skeleton.parents == made.skeleton.parents
    check_same_clips(vleo, made)
    assert all(clip.poses.scales is not None for clip in made.clips.values())
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
    check_vertices(vleo)


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
    assert vleo.clips[name].loop == (name not in GESTURES)
    check_ends_meet(vleo, name)


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
        assert blend_slide(vleo, clips, foot, times).max() < 0.004, foot


@pytest.mark.parametrize("name", CLIPS)
def test_legs_stretch_only_a_little(vleo: Character, name: str) -> None:
    check_leg_stretch(vleo, name, FEET)


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


def faced(vleo: Character, eyes: tuple[float, float] = (0.0, 0.0), **on: float) -> np.ndarray:
    """Return the skin with morphs on and the eyes turned left and up [rad], (vertices, 3)."""
    rest = vleo.skeleton.rest
    turned = rest.rotations.copy()
    for eye in ("LeftEye", "RightEye"):
        turn = rotations.multiply(rotations.about("y", eyes[0]), rotations.about("x", -eyes[1]))
        turned[vleo.skeleton.index(eye)] = turn
    pose = Pose(rest.translations, turned, rest.scales)
    return skin(vleo.meshes[0], pose.globals(vleo.skeleton), on)


def held_by(vleo: Character, joint: str) -> np.ndarray:
    """Return which vertices a joint holds wholly, (vertices,)."""
    mesh = vleo.meshes[0]
    held = mesh.weights * (mesh.joints == vleo.skeleton.index(joint))
    return np.asarray(held.sum(axis=1) > 0.99)


def test_expressions_are_those_of_vrm_and_reach_far_enough_to_be_seen(vleo: Character) -> None:
    assert vleo.morphs[: len(EXPRESSIONS)] == EXPRESSIONS
    reach = {morph.name: np.abs(morph.displacements).max() for morph in vleo.meshes[0].morphs}
    assert min(reach[name] for name in EXPRESSIONS) > 0.004  # 2 px on the table
    assert min(reach.values()) > 0.002
    mouth = vleo.skeleton.rest.globals(vleo.skeleton)[vleo.skeleton.index("lips"), :3, 3]
    rest = faced(vleo)
    lips = (np.linalg.norm(rest - mouth, axis=1) < 0.03) & np.isin(
        vleo.meshes[0].joints[:, 0], [vleo.skeleton.index(joint) for joint in ("head", "jaw")]
    )
    assert np.ptp(faced(vleo, aa=1.0)[lips, 1]) > np.ptp(rest[lips, 1]) + 0.015
    assert faced(vleo, ou=1.0)[lips, 2].max() > rest[lips, 2].max() + 0.015
    assert np.abs(faced(vleo, happy=1.0) - faced(vleo, sad=1.0)).max() > 0.01


@pytest.mark.parametrize("eyes", [(0.0, 0.0), (0.49, 0.0), (-0.49, 0.38), (0.3, -0.38)])
def test_closed_lids_hide_the_eyes_wherever_they_look(
    vleo: Character, eyes: tuple[float, float]
) -> None:
    points, triangles = faced(vleo, eyes, blink=1.0), vleo.meshes[0].triangles
    ball = held_by(vleo, "LeftEye")[triangles].all(axis=1)
    near = np.abs(points[triangles[:, 0]] - EYE_CENTRE_M).max(axis=1) < 0.06
    ways = (
        REST_GAZE + np.array([[a, b, 0.0] for a in np.arange(-6, 7) for b in np.arange(-6, 7)]) / 9
    )
    for way in ways / np.linalg.norm(ways, axis=1, keepdims=True):
        lid, eye = (_farthest(points[triangles[near & which]], way) for which in (~ball, ball))
        assert lid > eye


def _farthest(corners: np.ndarray, way: np.ndarray) -> float:
    """Return how far from the middle of the eye a ray leaves triangles (n, 3, 3) last [m]."""
    a, b, c = (corners[:, i] - EYE_CENTRE_M for i in range(3))
    with np.errstate(divide="ignore", invalid="ignore"):  # Möller and Trumbore (1997)
        across = np.cross(way, c - a)
        scale = 1 / np.sum((b - a) * across, axis=1)
        u = -np.sum(a * across, axis=1) * scale
        q = np.cross(-a, b - a)
        v, t = q @ way * scale, np.sum((c - a) * q, axis=1) * scale
    return float(np.max(t, where=(u >= 0) & (v >= 0) & (u + v <= 1) & (t > 0), initial=0.0))


@pytest.mark.parametrize("on", [0.25, 0.5, 0.75, 1.0])
def test_lids_slide_over_the_eyes_and_never_through_them(vleo: Character, on: float) -> None:
    lid = ~held_by(vleo, "LeftEye") & held_by(vleo, "head")
    ahead = (faced(vleo) - EYE_CENTRE_M) @ REST_GAZE
    away = np.linalg.norm(faced(vleo) - EYE_CENTRE_M, axis=1)
    lid &= (away > 1.02 * EYE_RADIUS_M) & (away < 1.3 * EYE_RADIUS_M) & (ahead > 0.4 * EYE_RADIUS_M)
    assert lid.sum() > 50
    over = np.linalg.norm(faced(vleo, blink=on)[lid] - EYE_CENTRE_M, axis=1)
    assert over.min() > 1.005 * EYE_RADIUS_M


BENDS = {
    "neck2": {"neck1": ("x", 20), "neck2": ("x", 20), "neck3": ("x", 20)},
    "neck3": {"neck1": ("z", -20), "neck2": ("z", -20), "neck3": ("z", -20)},
    "neck1": {"neck1": ("x", -30), "neck2": ("x", -30)},
    "tail3": {f"tail{number}": ("y", 25) for number in range(1, 6)},
    "tail2": {f"tail{number}": ("x", 25) for number in range(1, 6)},
    "LeftFrontLowerLeg": {"LeftFrontUpperLeg": ("x", -45), "LeftFrontLowerLeg": ("x", 60)},
    "LeftHindLowerLeg": {"LeftHindUpperLeg": ("x", 40), "LeftHindLowerLeg": ("x", -60)},
}
"""Where the skin is measured, and how joints are bent for it [degrees]."""


@pytest.mark.parametrize("joint", BENDS)
def test_skin_does_not_collapse_where_it_bends(vleo: Character, joint: str) -> None:
    skeleton, rest = vleo.skeleton, vleo.skeleton.rest
    turned = rest.rotations.copy()
    for name, (axis, degrees) in BENDS[joint].items():
        turned[skeleton.index(name)] = rotations.about(axis, np.radians(degrees))
    globals_ = (
        rest.globals(skeleton),
        Pose(rest.translations, turned, rest.scales).globals(skeleton),
    )
    at = skeleton.index(joint)
    child = skeleton.parents.index(at)
    straight, bent = (skin(vleo.meshes[0], each) for each in globals_)
    place, end = (globals_[0][number, :3, 3] for number in (at, child))
    along = (end - place) / np.linalg.norm(end - place)
    off = straight - place
    ring = (np.abs(off @ along) < 0.008) & (np.linalg.norm(off, axis=1) < 0.06)
    ring &= vleo.meshes[0].weights[:, 0] < 1.0
    widths = []
    for points in (straight[ring], bent[ring]):
        apart = points - points.mean(axis=0)
        widths.append(np.sqrt(np.linalg.eigvalsh(apart.T @ apart / len(apart))[1:]))
    assert (widths[1] > 0.7 * widths[0]).all()


@pytest.mark.parametrize("name", CLIPS)
def test_feet_on_the_ground_do_not_skid_between_steps_and_jumps(vleo: Character, name: str) -> None:
    assert planted_slide(vleo, name, FEET) < 0.010


@pytest.mark.parametrize("name", [*KISSES, *SHOUTS])
def test_effects_come_out_of_the_mouth_and_never_stop(vleo: Character, name: str) -> None:
    clip, skeleton = vleo.clips[name], vleo.skeleton
    posed = clip.poses.globals(skeleton)
    lips = posed[:, skeleton.index("lips"), :3, 3]
    for joint in HEARTS if name in KISSES else BURSTS:
        visible = np.flatnonzero(shown(vleo, name, (joint,))[:, 0] > 0.3)
        if not len(visible):
            continue  # the third, at the least intensity
        places = posed[visible, skeleton.index(joint), :3, 3]
        assert abs(places[0, 0] - lips[visible[0], 0]) < 0.010, joint
        speeds = np.linalg.norm(np.diff(places, axis=0), axis=1) * clip.rate
        assert speeds.min() > 0.03, joint


@pytest.mark.parametrize("name", SHOUTS)
def test_the_head_vibrates_while_the_shout_is_held(vleo: Character, name: str) -> None:
    clip, skeleton = vleo.clips[name], vleo.skeleton
    held = slice(round(0.40 * len(clip)), round(0.66 * len(clip)))
    lips = clip.poses.globals(skeleton)[held, skeleton.index("lips"), 1, 3]
    swing = lips - np.convolve(lips, np.ones(7) / 7, "same")
    assert np.ptp(swing[7:-7]) > 0.004
    assert clip.poses.morphs is not None
    jaw = clip.poses.morphs[held, vleo.morphs.index("aa")]
    assert np.ptp(jaw) > 0.25


def test_sad_and_angry_have_mouths_of_their_own() -> None:
    sad, angry = FACES["sadMouth"], FACES["angryMouth"]
    assert angry.teeth > 0.003 > sad.teeth  # one bares its teeth, the other shuts its lips
    assert sad.smile < angry.smile - 0.004  # and hangs its corners
