"""What the authoring tools promise: closed surfaces, skin that keeps to its limb, firm feet."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.gait import FootDimensions, Footfalls, GroundArc, foot_motion
from tools.authoring.modelling.ik import hinge_position
from tools.authoring.modelling.lathe import lathe
from tools.authoring.modelling.rig import PosedRig, build_skeleton, mirrored
from tools.authoring.modelling.sculpt import BodyPart, sculpt
from tools.authoring.modelling.shapes import (
    Difference,
    Ellipsoid,
    HalfSpace,
    RoundCone,
    Shape,
    Union,
    linear_rgb,
)
from tools.authoring.modelling.tube import tube

pytestmark = pytest.mark.full

LEGS = build_skeleton(
    {
        "root": ("", (0.0, 0.0, 0.0)),
        "hips": ("root", (0.0, 0.9, 0.0)),
        "LeftUpLeg": ("hips", (0.06, 0.85, 0.0)),
        "LeftLeg": ("LeftUpLeg", (0.06, 0.45, 0.01)),
        "LeftFoot": ("LeftLeg", (0.06, 0.08, 0.0)),
        "LeftToe": ("LeftFoot", (0.06, 0.02, 0.12)),
    }
)


def half_of_the_trousers(side: float) -> Union:
    name = "Left" if side > 0 else "Right"
    x = 0.06 * side
    upper = RoundCone((x, 0.85, 0), (x, 0.45, 0), 0.045, 0.04, bones=(f"{name}UpLeg",))
    return Union(
        (upper, RoundCone((x, 0.45, 0), (x, 0.1, 0), 0.04, 0.04, bones=(f"{name}Leg",))), 0.02
    )


def is_closed(mesh: Mesh) -> bool:
    """Whether every edge has a triangle on either side, turned the same way round."""
    _, welded = np.unique(mesh.positions.round(6), axis=0, return_inverse=True)
    edges = welded[mesh.triangles[:, [0, 1, 1, 2, 2, 0]]].reshape(-1, 2)
    edges = edges[edges[:, 0] != edges[:, 1]]
    return set(map(tuple, edges.tolist())) == set(map(tuple, edges[:, ::-1].tolist()))


def volume(mesh: Mesh) -> float:
    """Enclosed volume [m³]; negative if the triangles are inside out."""
    a, b, c = mesh.positions[mesh.triangles].astype(float).swapaxes(0, 1)
    return float(np.einsum("ij,ij->", a, np.cross(b, c)) / 6)


def test_a_sculpted_ball_is_round_closed_and_faces_outward() -> None:
    ball = Ellipsoid((0.1, 1.0, 0.0), (0.2, 0.2, 0.2), bones=("hips",), color=linear_rgb("#ff0000"))
    mesh = sculpt("ball", [BodyPart(ball, 0.02)], LEGS)
    outward = mesh.positions - np.array([0.1, 1.0, 0.0])
    assert np.allclose(np.linalg.norm(outward, axis=1), 0.2, atol=1e-5)
    assert np.allclose(mesh.normals, outward / 0.2, atol=1e-3)
    assert is_closed(mesh)
    assert volume(mesh) == pytest.approx(4 / 3 * np.pi * 0.2**3, rel=0.01)
    assert mesh.colors is not None
    assert np.allclose(mesh.colors, [1, 0, 0, 1])


def test_a_cut_leaves_the_flat_face() -> None:
    ball = Ellipsoid((0, 1, 0), (0.2, 0.2, 0.2), bones=("hips",))
    mesh = sculpt("half", [BodyPart(Difference(ball, HalfSpace((0, 1, 0), (0, 1, 0))), 0.02)], LEGS)
    assert mesh.positions[:, 1].min() == pytest.approx(1.0, abs=2e-3)
    assert volume(mesh) == pytest.approx(2 / 3 * np.pi * 0.2**3, rel=0.03)


def test_skin_weights_never_cross_from_one_leg_to_the_other() -> None:
    seat = Ellipsoid((0, 0.9, 0), (0.12, 0.08, 0.08), bones=("hips",))
    trousers = Union((seat, half_of_the_trousers(1), half_of_the_trousers(-1)))
    mesh = sculpt("trousers", [BodyPart(trousers, 0.015, soft_skin=0.04)], LEGS)
    names = np.array(LEGS.names)[mesh.joints]
    held_by_left = np.char.startswith(names, "Left") & (mesh.weights > 0)
    held_by_right = np.char.startswith(names, "Right") & (mesh.weights > 0)
    below_the_crotch = mesh.positions[:, 1] < 0.7
    by_both = np.any(held_by_left, axis=1) & np.any(held_by_right, axis=1)
    assert not np.any(by_both & below_the_crotch)
    near_the_knee = np.abs(mesh.positions[:, 1] - 0.45) < 0.02
    assert 0.2 < mesh.weights[near_the_knee].max(axis=1).min() < 0.7  # handed over softly


def test_turned_and_swept_pieces_are_closed_and_face_outward() -> None:
    rings = np.array([[0, -0.03], [0.02, -0.02], [0.03, 0.0], [0.0, 0.03]])
    place = np.column_stack([np.diag([1.0, 0.5, 2.0]), [0.1, 1.0, 0.2]])
    turned = lathe(rings, [(1, 0, 0), (1, 0, 0), (0, 0, 1)], place, "hips", LEGS)
    swept = tube([(0, 1, 0), (0.1, 1.1, 0), (0.1, 1.2, 0.1)], 0.02, (1, 1, 1), "hips", LEGS, 8, 12)
    for mesh in (turned, swept):
        assert is_closed(mesh)
        assert volume(mesh) > 0
        corners = mesh.positions[mesh.triangles]
        flat = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        assert ((flat * mesh.normals[mesh.triangles].mean(axis=1)).sum(axis=1) > 0).all()


@pytest.mark.parametrize(
    "shape",
    [
        RoundCone((0.1, 0.2, 0.3), (0.4, 0.1, 0.2), 0.1, 0.05, (1.0, 1.0, 0.7)),
        Ellipsoid((0.1, 0.2, 0.3), (0.1, 0.2, 0.3), (0.3, 0.5, 0.7), 3.0),
        HalfSpace((0.1, 0.2, 0.3), (0.3, 0.5, 0.7)),
    ],
)
def test_a_mirrored_shape_is_the_mirror_image(shape: Shape) -> None:
    points = np.random.default_rng(7).uniform(-1, 1, (50, 3))
    image = shape.mirrored().distance(points * [-1, 1, 1])
    assert np.allclose(image, shape.distance(points), atol=1e-12)


@given(st.floats(0.2, 0.8), st.floats(0.2, 0.8), st.floats(0.05, 0.98), st.integers(0, 1000))
def test_a_bent_limb_keeps_its_bones_long(
    upper: float, lower: float, reach: float, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    start, pole = rng.normal(size=3), rng.normal(size=3)
    direction = rng.normal(size=3)
    direction /= np.linalg.norm(direction)
    shortest = abs(upper - lower) + 0.01
    end = start + direction * (shortest + reach * (upper + lower - shortest))
    middle = hinge_position(start, end, pole, upper, lower)
    assert np.linalg.norm(middle - start) == pytest.approx(upper, abs=1e-6)
    assert np.linalg.norm(end - middle) == pytest.approx(lower, abs=1e-6)
    assert (middle - start) @ (pole - direction * (pole @ direction)) > -1e-9


def test_a_placed_foot_is_where_it_was_asked_to_be() -> None:
    rig = PosedRig(LEGS, 2)
    ankle = np.array([[0.1, 0.15, 0.2], [0.0, 0.1, -0.15]])
    facing = rotations.from_euler("yx", np.array([[0.3, -0.2], [-0.1, 0.4]]))
    rig.place_foot("Left", ankle, facing, np.zeros(2))
    assert np.allclose(rig.places("LeftFoot"), ankle, atol=1e-9)
    assert np.allclose(rotations.align(rig.facing("LeftFoot"), facing), facing, atol=1e-9)
    image = mirrored(rig.pose, LEGS).globals(LEGS)[:, LEGS.names.index("RightFoot"), :3, 3]
    assert np.allclose(image, ankle * [-1, 1, 1], atol=1e-9)


@given(
    st.floats(0.3, 4.0), st.floats(-2.5, 2.5), st.floats(0.25, 0.65), st.sampled_from([1.0, -1.0])
)
def test_a_planted_foot_pivots_about_a_point_of_the_ground(
    speed: float, yaw_rate: float, stance: float, side: float
) -> None:
    path, phase = GroundArc(speed, yaw_rate), np.linspace(0, 1, 121)
    foot = FootDimensions(ankle=0.095, heel=-0.07, ball=(0.03, 0.115), toes=0.09)
    steps = Footfalls(1.0, stance, 0.1, 0.0, 0.3, 0.8, 0.03)
    motion = foot_motion(path, steps, foot, side, phase)
    root, yaw = path.at(phase)
    turned = rotations.about("y", yaw)
    facing = rotations.multiply(turned, motion.facing)
    origin = np.stack([root[:, 0], 0 * yaw, root[:, 1]], axis=-1)
    ankle = origin + rotations.rotate(turned, motion.ankle)
    heel = ankle + rotations.rotate(facing, [0, -foot.ankle, foot.heel])
    ball = ankle + rotations.rotate(facing, [0, foot.ball[0] - foot.ankle, foot.ball[1]])
    own = (phase + (0.0 if side > 0 else 0.5)) % 1.0
    early = motion.down & (own < 0.4 * stance)
    late = motion.down & (own > 0.2 * stance)
    for when, point in ((early, heel), (late, ball)):
        # A stance may begin in one cycle and end in the next; take the part within this one.
        for visit in np.split(np.arange(len(phase)), np.flatnonzero(np.diff(when)) + 1):
            if when[visit[0]]:
                assert np.ptp(point[visit], axis=0).max() < 1e-9


def test_a_skeleton_gets_its_other_side() -> None:
    skeleton: Skeleton = LEGS
    places = skeleton.rest.globals(skeleton)[:, :3, 3]
    left, right = (places[skeleton.names.index(f"{s}Toe")] for s in ("Left", "Right"))
    assert np.allclose(left * [-1, 1, 1], right)
    parents = {n: skeleton.parents[i] for i, n in enumerate(skeleton.names)}
    assert skeleton.names[parents["RightLeg"]] == "RightUpLeg"
