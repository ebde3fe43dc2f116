"""The bundled explorer is what its code makes, and moves as a body on the ground must."""

import itertools
from pathlib import Path

import cv2
import numpy as np
import pytest

from cubeling.affect.regions import SECTOR_WORDS
from cubeling.characters.face.affect_display import FACE_RECIPES
from cubeling.characters.face.expressions import EXPRESSIONS as VRM_EXPRESSIONS
from cubeling.characters.model.character import Character, skin
from cubeling.characters.model.mesh import Mesh
from cubeling.characters.motion.clip import Clip
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose, Skeleton
from tests.bench.cast import Soles, film, sampled
from tests.tools.authoring.clip_checks import check_same_clips
from tools.authoring.__main__ import ASSETS
from tools.authoring.human.character import build_human
from tools.authoring.human.face_map import face_uvs, save_face_maps
from tools.authoring.human.limbs import FOOT, rotation_deg
from tools.authoring.human.rig import JOINT_POSITIONS
from tools.authoring.human.secondary_motion import GRAVITY_M_S2
from tools.cast import SHEET_MOODS

pytestmark = pytest.mark.full

WALKS = [f"Walk{side}{size}" for side in ("Left", "Right") for size in ("Short", "Medium", "Wide")]
RUNS = [f"Run{side}{size}" for side in ("Left", "Right") for size in ("Medium", "Wide")]
GAITS = ["Walk", *WALKS, "Run", *RUNS]
ACTIONS = ["wave", "cheer", "jump", "nod", "shake"]
CLIPS = ["idle", *GAITS, *ACTIONS]
SPEEDS = {"Walk": (1.35, 0.0), "Run": (3.4, 0.0)}
SHUTTING = ["blink", "blinkLeft", "blinkRight"]
MOODS = ["happy", "angry", "sad", "surprised", "relaxed"]
VISEMES = ["aa", "ih", "ou", "ee", "oh"]
FACE_FOLDER = ASSETS / "human_face"
YAW_RATES = {"Wide": 45.0, "Medium": 90.0, "Short": 135.0}


@pytest.fixture(scope="module")
def human() -> Character:
    return Character.load("human")


@pytest.fixture(scope="module")
def made() -> Character:
    return build_human()


def world_points(human: Character, clip: Clip, joint: str, offset: tuple[float, float, float]):
    """Where a point of a joint goes over the ground, (frames, 3)."""
    number = human.skeleton.names.index(joint)
    return clip.poses.globals(human.skeleton)[:, number] @ [*offset, 1.0]


def test_the_asset_is_what_the_code_makes(human: Character, made: Character) -> None:
    assert human.skeleton.names == made.skeleton.names
    assert human.skeleton.parents == made.skeleton.parents
    assert human.morphs == made.morphs
    check_same_clips(human, made)
    for shipped_mesh, mesh in zip(human.meshes, made.meshes, strict=True):
        assert np.array_equal(shipped_mesh.triangles, mesh.triangles)
        assert np.allclose(shipped_mesh.positions, mesh.positions, atol=1e-5)
        assert np.allclose(shipped_mesh.weights, mesh.weights, atol=2e-3)
        for shipped_morph, morph in zip(shipped_mesh.morphs, mesh.morphs, strict=True):
            assert shipped_morph.name == morph.name
            assert np.array_equal(shipped_morph.vertices, morph.vertices)
            assert np.allclose(shipped_morph.displacements, morph.displacements, atol=1e-5)


def test_the_face_maps_are_what_the_code_makes(tmp_path: Path) -> None:
    made = save_face_maps(tmp_path / "face")
    assert len(made) == 13
    for path in made:
        pictures = [cv2.imread(str(folder / path.name), 0) for folder in (path.parent, FACE_FOLDER)]
        fresh, shipped = (np.asarray(picture, int) for picture in pictures)
        assert np.abs(fresh - shipped).max() <= 1, path.name


def test_wrinkles_lie_on_the_skin_of_the_face(human: Character) -> None:
    """No vertex of clothes or hair has texture coordinates, and those of the face are unfolded."""
    (body,) = (mesh for mesh in human.meshes if mesh.uvs is not None)
    assert body.uvs is not None
    head = human.skeleton.names.index("head")
    skin = body.uvs.any(axis=1)
    assert (body.joints[skin, 0] == head).all()
    front = skin & (body.positions[:, 2] > 0.05)
    assert np.allclose(face_uvs(body.positions[front].astype(float)), body.uvs[front], atol=1e-5)


def test_knows_to_wait_the_twelve_gaits_and_five_actions(human: Character) -> None:
    assert sorted(human.clips) == sorted(CLIPS)
    assert [name for name in CLIPS if not human.clips[name].loop] == ACTIONS


def test_stands_a_person_tall_on_the_ground(human: Character) -> None:
    assert human.height == pytest.approx(1.75, abs=0.05)
    assert human.bounds[0, 1] == pytest.approx(0.0, abs=0.002)


@pytest.mark.parametrize("name", CLIPS)
def test_a_clip_ends_as_it_begins(human: Character, name: str) -> None:
    poses = human.clips[name].in_place
    assert np.allclose(poses.translations[0], poses.translations[-1], atol=1e-5)
    first = rotations.align(poses.rotations[0], poses.rotations[-1])
    assert np.allclose(first, poses.rotations[-1], atol=1e-5)
    assert poses.morphs is not None
    assert np.allclose(poses.morphs[0], poses.morphs[-1], atol=1e-5)


@pytest.mark.parametrize("name", ACTIONS)
def test_an_action_sets_off_from_waiting(human: Character, name: str) -> None:
    waiting, first = (human.clips[n].in_place[0].globals(human.skeleton) for n in ("idle", name))
    assert np.linalg.norm((first - waiting)[:, :3, 3], axis=1).max() < 0.03


@pytest.mark.parametrize("name", CLIPS)
def test_blinking_is_left_to_the_life_added_at_run_time(human: Character, name: str) -> None:
    morphs = human.clips[name].poses.morphs
    assert morphs is not None
    assert not morphs[:, [human.morphs.index(n) for n in SHUTTING]].any()
    assert morphs.min() >= 0.0
    assert morphs.max() <= 1.0


@pytest.mark.parametrize("name", GAITS)
def test_the_root_runs_evenly_along_its_arc(human: Character, name: str) -> None:
    clip = human.clips[name]
    steps = np.linalg.norm(np.diff(clip.track[:, :2], axis=0), axis=1) * clip.rate
    rates = np.degrees(np.diff(clip.track[:, 2])) * clip.rate
    assert np.allclose(steps, steps[0], atol=1e-3)
    assert np.allclose(rates, rates[0], atol=0.1)
    size = name.removeprefix("Walk").removeprefix("Run").removeprefix("Left").removeprefix("Right")
    sign = 1 if "Left" in name else -1
    expected = sign * YAW_RATES.get(size, 0.0) * (1.5 if name.startswith("Run") else 1.0)
    assert rates[0] == pytest.approx(expected, abs=0.1)
    if name in SPEEDS:
        assert steps[0] == pytest.approx(SPEEDS[name][0], rel=0.01)


@pytest.mark.parametrize("name", CLIPS)
@pytest.mark.parametrize("side", ["Left", "Right"])
def test_a_planted_foot_does_not_slide(human: Character, name: str, side: str) -> None:
    clip = human.clips[name]
    heel = world_points(human, clip, f"{side}Foot", (0.0, -FOOT.ankle, FOOT.heel))
    ball = world_points(human, clip, f"{side}Toe", (0.0, -FOOT.ball[0], 0.0))
    for point in (heel, ball):
        down = point[:, 1] < 0.0005
        assert down.any()
        for stance in np.split(point, np.flatnonzero(np.diff(down)) + 1):
            if stance[0, 1] < 0.0005:
                assert np.ptp(stance[:, [0, 2]], axis=0).max() < 0.002


@pytest.mark.parametrize("name", ACTIONS)
def test_feet_on_the_ground_do_not_skid_when_they_land_and_leave(
    human: Character, name: str
) -> None:
    soles, clip = Soles(human), human.clips[name]
    assert soles.slides(sampled(clip)).max() < 10.0
    assert soles.slides(*film(human, name, 0.0, clip.duration)).max() < 10.0  # with the foot lock


@pytest.mark.parametrize("name", ["idle", "Walk", "WalkLeftShort", "Run", "RunRightMedium", "jump"])
def test_no_foot_sinks_into_the_ground(human: Character, name: str) -> None:
    shoes = _below_the_knee(human.meshes[0])
    poses = human.clips[name].in_place.globals(human.skeleton)
    assert min(skin(shoes, pose)[:, 1].min() for pose in poses[::3]) > -0.001


@pytest.mark.parametrize("name", GAITS)
def test_no_knee_straightens_or_pops(human: Character, name: str) -> None:
    for bend in knees(human, name):
        assert bend.min() > 8.0
        assert np.abs(np.diff(bend)).max() * human.clips[name].rate < 1100.0


def knees(human: Character, name: str) -> list[Array]:
    """Bend of the left and the right knee in a clip [degrees]."""
    places = human.clips[name].in_place.globals(human.skeleton)[..., :3, 3]
    bends = []
    for side in ("Left", "Right"):
        hip, knee, ankle = (
            places[:, human.skeleton.names.index(side + joint)]
            for joint in ("UpLeg", "Leg", "Foot")
        )
        upper, lower = knee - hip, ankle - knee
        cosine = (upper * lower).sum(-1) / np.linalg.norm(upper, axis=-1)
        bends.append(np.degrees(np.arccos(cosine / np.linalg.norm(lower, axis=-1))))
    return bends


def test_the_front_leg_lands_nearly_straight_and_gives_way_under_the_weight(
    human: Character,
) -> None:
    for name, most, deeper in (("Walk", 18.0, 12.0), ("Run", 32.0, 24.0)):
        left = knees(human, name)[0]
        assert left[0] < most
        assert left[: len(left) // 4].max() > left[0] + deeper


def test_running_has_a_flight_and_walking_has_none(human: Character) -> None:
    lowest = {}
    for name in ("Walk", "Run"):
        clip = human.clips[name]
        soles = [
            world_points(human, clip, f"{side}{joint}", offset)[:, 1]
            for side in ("Left", "Right")
            for joint, offset in (
                ("Foot", (0.0, -FOOT.ankle, FOOT.heel)),
                ("Toe", (0.0, -FOOT.ball[0], 0.0)),
            )
        ]
        lowest[name] = np.min(soles, axis=0)
    assert lowest["Walk"].max() < 0.001
    assert (lowest["Run"] > 0.005).mean() > 0.35
    assert lowest["Run"].max() > 0.05


def test_a_run_bobs_as_much_as_its_flights_make_it_fall(human: Character) -> None:
    clip = human.clips["Run"]
    height = clip.in_place.globals(human.skeleton)[:, human.skeleton.index("hips"), 1, 3]
    assert 0.09 < np.ptp(height) < 0.11
    falling = np.diff(height, 2) * clip.rate**2
    assert np.median(falling[falling < 0]) == pytest.approx(-GRAVITY_M_S2, rel=0.1)


@pytest.mark.parametrize("name", ["Walk", "Run"])
def test_the_halves_of_a_gait_are_alike_but_no_mirror_images(human: Character, name: str) -> None:
    poses = human.clips[name].in_place
    places = poses.globals(human.skeleton)[:-1, :, :3, 3]
    left, right = (human.skeleton.index(f"{side}Hand") for side in ("Left", "Right"))
    half = len(places) // 2
    other = np.roll(places[:, right], half, axis=0) * [-1.0, 1.0, 1.0]
    apart = np.linalg.norm(places[:, left] - other, axis=1)
    assert 0.01 < apart.max() < 0.08


@pytest.mark.parametrize("name", [n for n in GAITS if "Left" in n])
def test_a_right_turn_is_a_left_one_with_the_same_habits(human: Character, name: str) -> None:
    left, right = (human.clips[n].in_place for n in (name, name.replace("Left", "Right")))
    names = human.skeleton.names
    half = (len(left.rotations) - 1) // 2
    for joint, other, apart in (("LeftFoot", "RightFoot", 1e-4), ("LeftHand", "RightHand", 0.08)):
        a = left.globals(human.skeleton)[:-1, names.index(joint), :3, 3] * [-1.0, 1.0, 1.0]
        b = right.globals(human.skeleton)[:-1, names.index(other), :3, 3]
        assert np.linalg.norm(np.roll(a, -half, axis=0) - b, axis=1).max() < apart


def test_skin_is_closed_faces_outward_and_is_fully_held(human: Character) -> None:
    for mesh in human.meshes:
        assert np.allclose(mesh.weights.sum(axis=1), 1.0, atol=1e-5)
        corners = mesh.positions[mesh.triangles].astype(float)
        flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        along = (flat * mesh.normals[mesh.triangles].mean(axis=1)).sum(axis=1)
        assert (along > 0).mean() > 0.995
        _, welded = np.unique(mesh.positions.round(5), axis=0, return_inverse=True)
        edges = welded[mesh.triangles[:, [0, 1, 1, 2, 2, 0]]].reshape(-1, 2)
        edges = edges[edges[:, 0] != edges[:, 1]]
        there, back = (set(map(tuple, e.tolist())) for e in (edges, edges[:, ::-1]))
        assert there == back


def test_is_light_enough_for_a_small_machine(human: Character) -> None:
    assert 8_000 < sum(len(mesh.triangles) for mesh in human.meshes) <= 22_000


def test_the_face_shows_and_says_what_vrm_names(human: Character) -> None:
    assert human.morphs[:13] == (*SHUTTING, *MOODS, *VISEMES)
    for number, morph in enumerate(human.meshes[0].morphs):
        least = 0.012 if number < 13 else 0.006
        assert np.linalg.norm(morph.displacements, axis=1).max() > least, morph.name
        assert np.linalg.norm(morph.displacements, axis=1).max() < 0.12, morph.name


@pytest.mark.parametrize(("yaw", "pitch"), [(0, 0), (20, 0), (-20, 0), (0, 12), (0, -12), (15, 9)])
def test_closed_lids_hide_the_eyes_wherever_they_look(
    human: Character, yaw: float, pitch: float
) -> None:
    skeleton = human.skeleton
    turns = skeleton.rest.rotations.copy()
    turns[[skeleton.index("LeftEye"), skeleton.index("RightEye")]] = rotation_deg(pitch, yaw)
    looking = Pose(skeleton.rest.translations, turns).globals(skeleton)
    face, balls = human.meshes
    ball = skin(balls, looking)
    ball = ball[(ball[:, 2] > 0.15) & (ball[:, 0] > 0)]
    closed = skin(face, looking, {"blink": 1.0})[face.triangles]
    near = np.abs(closed.mean(axis=1) - [0.09, 1.44, 0.18]).max(axis=1) < 0.12
    assert (_front(closed[near & (closed[..., 2].min(axis=1) > 0.105)], ball) > ball[:, 2]).all()


@pytest.mark.parametrize("words", [SECTOR_WORDS, tuple(w for w in SHEET_MOODS if w != "neutral")])
def test_no_two_moods_have_the_same_face(human: Character, words: tuple[str, ...]) -> None:
    rest, faces = human.skeleton.rest.globals(human.skeleton), {}
    for word in words:
        *weights, lids = FACE_RECIPES[word]
        morphs = {**dict(zip(VRM_EXPRESSIONS, weights, strict=True)), "blink": lids}
        faces[word] = skin(human.meshes[0], rest, morphs)
    for one, other in itertools.combinations(words, 2):
        apart = np.linalg.norm(faces[one] - faces[other], axis=1)
        assert apart.max() > 0.016, (one, other)


ELBOW = np.cross(
    np.subtract(JOINT_POSITIONS["LeftForeArm"][1], JOINT_POSITIONS["LeftArm"][1]), [0.0, 0.0, 1.0]
)
ELBOW /= np.linalg.norm(ELBOW)
BENDS = {
    "LeftForeArm": (rotations.about(ELBOW, np.radians(120.0)), 0.0),
    "LeftLeg": (rotation_deg(x=120.0), 0.0),
    "LeftArm": (rotation_deg(z=90.0), 0.03),
    "LeftUpLeg": (rotation_deg(x=-90.0), 0.03),
}


@pytest.mark.parametrize("joint", BENDS)
def test_a_bent_joint_keeps_its_width(human: Character, joint: str) -> None:
    skeleton, mesh = human.skeleton, human.meshes[0]
    number = skeleton.index(joint)
    turn, beyond = BENDS[joint]
    turns = skeleton.rest.rotations.copy()
    turns[number] = turn
    bent = Pose(skeleton.rest.translations, turns)
    before, after = (
        _width(mesh, pose.globals(skeleton), skeleton, number, beyond)
        for pose in (skeleton.rest, bent)
    )
    assert after > 0.85 * before


@pytest.mark.parametrize("name", ["Walk", "Run", "cheer"])
def test_the_backpack_follows_late_and_never_into_the_body(human: Character, name: str) -> None:
    turns = human.clips[name].in_place.rotations
    angle = np.degrees(2 * np.arcsin(turns[:, human.skeleton.index("Backpack"), 0]))
    assert np.ptp(angle) > 1.5
    assert angle.min() > -2.0


def test_hair_and_strings_follow_the_body(human: Character) -> None:
    joints = {bone.joint: human.skeleton.index(bone.joint) for bone in human.springs}
    poses, _ = film(human, "jump", 0.0, human.clips["jump"].duration)
    turns = rotations.to_rotation_vector(poses.rotations[:, list(joints.values())])
    swings = dict(zip(joints, np.degrees(np.linalg.norm(turns, axis=-1)).T, strict=True))
    assert set(swings) >= {"Cowlick", "HairTop", "LeftHairSide", "RightHairBack", "LeftString"}
    for joint, swing in swings.items():
        assert 8.0 < swing.max() < 60.0, joint
        assert swing[-1] < 8.0, joint  # it comes to rest
    into = turns[..., 0][:, [list(joints).index(f"{side}String") for side in ("Left", "Right")]]
    assert np.degrees(into).max() < 6.0  # strings lie on the chest


def _front(triangles: Array, points: Array) -> Array:
    """Return how far forward (z) the foremost triangle over each point is, (points,)."""
    start = triangles[:, 0]
    one, other = triangles[:, 1] - start, triangles[:, 2] - start
    area = one[:, 0] * other[:, 1] - one[:, 1] * other[:, 0]
    start, one, other, area = (a[np.abs(area) > 1e-12] for a in (start, one, other, area))
    apart = points[:, None] - start
    u = (apart[..., 0] * other[:, 1] - apart[..., 1] * other[:, 0]) / area
    v = (one[:, 0] * apart[..., 1] - one[:, 1] * apart[..., 0]) / area
    height = start[:, 2] + u * one[:, 2] + v * other[:, 2]
    over = (u > -1e-3) & (v > -1e-3) & (u + v < 1 + 1e-3)
    return np.asarray(np.where(over, height, -np.inf).max(axis=1))


def _width(mesh: Mesh, pose: Array, skeleton: Skeleton, joint: int, beyond: float) -> float:
    """Return the smallest width of a limb cut at a joint, or so far beyond it."""
    parent, child = skeleton.parents[joint], skeleton.parents.index(joint)
    at = pose[:, :3, 3]
    above, below = at[joint] - at[parent], at[child] - at[joint]
    below /= np.linalg.norm(below)
    normal = below if beyond else above / np.linalg.norm(above) + below
    normal /= np.linalg.norm(normal)
    own = np.isin(mesh.joints, [parent, joint]) * mesh.weights
    limb = mesh.triangles[(own.sum(axis=1) > 0.5)[mesh.triangles].all(axis=1)]
    points = skin(mesh, pose) - at[joint] - beyond * below
    near = limb[np.linalg.norm(points[limb].mean(axis=1), axis=1) < 0.12]
    ends = points[np.stack([near, np.roll(near, 1, axis=1)])]
    start, end = (ends @ normal)[..., None]
    crossed = (start < 0) != (end < 0)
    cut = (ends[0] + (ends[1] - ends[0]) * start / (start - end + 1e-12))[crossed[..., 0]]
    side = np.linalg.svd(normal[None])[2][1:]
    angles = np.linspace(0, np.pi, 24, endpoint=False)
    directions = np.cos(angles)[:, None] * side[0] + np.sin(angles)[:, None] * side[1]
    return float(np.ptp(cut @ directions.T, axis=0).min())


def _below_the_knee(mesh: Mesh) -> Mesh:
    kept = mesh.positions[:, 1] < 0.2
    fields = {
        name: getattr(mesh, name)[kept] for name in ("positions", "normals", "joints", "weights")
    }
    return Mesh(
        "shoes", triangles=np.zeros((0, 3), np.uint32), inverse_bind=mesh.inverse_bind, **fields
    )
