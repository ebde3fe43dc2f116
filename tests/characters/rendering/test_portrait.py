"""Portraits: any character in any pose is completely in the picture and fills it."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import example, given, settings, strategies as st

from cubeling.characters import Character, CharacterError, Clip, Morph, Pose
from cubeling.characters.rendering.portrait import PAPER_BGR, PortraitRenderer
from cubeling.characters.rendering.portrait_camera import (
    MARGIN_SHARE,
    MIN_DISTANCE_M,
    CharacterExtent,
    PortraitCamera,
)
from tests.examples import examples

SIZE = (90, 120)


@pytest.fixture
def renderer(ctx):
    renderer = PortraitRenderer(ctx, SIZE)
    yield renderer
    renderer.release()


@pytest.fixture(scope="module")
def knight(pawn):
    """Return a pawn that knows how to bow where it stands, and how to slide five metres away."""
    still = pawn.skeleton.rest

    def clip(name, bend, way):
        half = 0.5 * np.linspace(0.0, bend, 11)
        turns = np.tile([0.0, 0.0, 0.0, 1.0], (11, 2, 1))
        turns[:, 1, 0], turns[:, 1, 3] = np.sin(half), np.cos(half)
        places = np.tile(still.translations, (11, 1, 1))
        places[:, 0, 2] = np.linspace(0.0, way, 11)
        return Clip(name, 10.0, Pose(places, turns), loop=False)

    clips = {"bow": clip("bow", 1.4, 0.0), "slide": clip("slide", 0.0, 5.0)}
    skeleton = replace(pawn.skeleton, names=("foot", "head"))
    return Character("knight", skeleton, clips, pawn.meshes, semantics={"head": "head"})


def drawn(picture):
    """Return where there is red, which the knight is and shadows are not."""
    return picture[..., 2].astype(int) - picture[..., 1] > 30


def cells(strip):
    return np.split(strip, strip.shape[1] // SIZE[0], axis=1)


def holds_all_of_it(picture):
    """Return whether nothing is cut off, and the picture is filled in height or in width."""
    rows, columns = (np.flatnonzero(drawn(picture).any(axis=axis)) for axis in (1, 0))
    free = min(*rows[[0]], *columns[[0]], SIZE[1] - 1 - rows[-1], SIZE[0] - 1 - columns[-1])
    filled = max(np.ptp(rows) / SIZE[1], np.ptp(columns) / SIZE[0])
    return free >= 3 and filled > 0.75


@settings(max_examples=examples(40), deadline=None)
@given(
    points=st.lists(st.tuples(*[st.floats(-0.5, 0.5)] * 3), min_size=2, max_size=9),
    elevation=st.floats(-0.3, 1.2),
    width=st.integers(40, 400),
    height=st.integers(40, 400),
)
@example(points=[(0.0, 0.0, 0.0), (0.0, 0.0, 0.5)], elevation=0.0, width=40, height=40)
@example(points=[(0.0, 0.0, 0.0), (0.5, 0.0, 0.5)], elevation=0.0, width=189, height=40)
def test_a_camera_sees_all_points_from_the_smallest_distance(points, elevation, width, height):
    framing = PortraitCamera.around(np.array(points), elevation, (width, height))
    pose = framing.camera_from_table
    assert np.allclose(pose[:3, :3] @ pose[:3, :3].T, np.eye(3))
    seen = np.array(points) @ pose[:3, :3].T + pose[:3, 3]
    assert (seen[:, 2] > 0.03).all()
    pixels = (seen / seen[:, 2:] @ framing.matrix.T)[:, :2] + 0.5
    shares = np.abs(2.0 * pixels / (width, height) - 1.0).max()
    assert shares <= 1.0 - 2.0 * MARGIN_SHARE + 1e-6
    if seen[:, 2].min() > MIN_DISTANCE_M + 1e-6:  # else the nearest point limits the distance
        assert shares >= 1.0 - 2.0 * MARGIN_SHARE - 1e-6


@pytest.mark.parametrize("stretch", [(1.0, 1.0, 1.0), (1.0, 1.0, 6.0), (0.2, 5.0, 0.2)])
def test_a_turntable_shows_all_of_any_character(renderer, knight, stretch):
    mesh = knight.meshes[0]
    bind = mesh.inverse_bind.copy()
    bind[:, :3] *= np.array(stretch)[None, :, None]
    stretched = replace(knight, meshes=(replace(mesh, inverse_bind=bind),))
    table = renderer.turntable(stretched, count=4)
    assert table.shape == (SIZE[1], 4 * SIZE[0], 3)
    assert max(holds_all_of_it(cell) for cell in cells(table))
    sides = table[:, [0, SIZE[0] - 1, SIZE[0]]].reshape(-1, 3)
    assert np.abs(sides.astype(int) - PAPER_BGR).max() <= 2


def test_a_strip_has_one_camera_that_sees_the_whole_clip(renderer, knight):
    frames = cells(renderer.strip(knight, "bow", 4, azimuth=1.5))
    feet = [np.flatnonzero(drawn(frame).any(axis=1))[-1] for frame in frames]
    tops = [np.flatnonzero(drawn(frame).any(axis=1))[0] for frame in frames]
    assert np.ptp(feet) <= 1
    assert tops[-1] - tops[0] > 10
    assert all((np.flatnonzero(drawn(f).any(axis=0))[[0, -1]] % 89).all() for f in frames)


def test_a_character_that_moves_far_is_followed(renderer, knight):
    strip = renderer.strip(knight, knight.clips["slide"], 4)
    assert all(holds_all_of_it(frame) for frame in cells(strip))


def test_a_portrait_can_leave_room_for_a_clip(renderer, knight):
    tight = renderer.portrait(knight, azimuth=1.5)
    roomy = renderer.portrait(knight, azimuth=1.5, extent=knight.clips["slide"])
    assert drawn(roomy).sum() < 0.5 * drawn(tight).sum()


def test_portraits_of_several_poses_have_one_camera(renderer, knight):
    poses = [knight.clips["slide"].poses[frame] for frame in (0, 5)]
    several = renderer.portraits(knight, poses, azimuth=1.5)
    for pose, picture in zip(poses, several, strict=True):
        alone = renderer.portrait(knight, pose, azimuth=1.5, extent=poses)
        assert np.array_equal(picture, alone)
    assert not np.array_equal(several[0], renderer.portrait(knight, poses[0], azimuth=1.5))


def test_the_extent_of_a_pose_does_not_keep_the_morphs_of_the_last_one(knight):
    mesh = knight.meshes[0]
    every = np.arange(len(mesh.positions), dtype=np.uint32)
    raised = Morph("tall", every, np.full((len(every), 3), (0.0, 9.0, 0.0), np.float32), None)
    tall = replace(knight, meshes=(replace(mesh, morphs=(raised,)),), morphs=("tall",))
    extent = CharacterExtent(tall)
    rest = tall.skeleton.rest
    before = extent.points(rest)
    grown = extent.points(replace(rest, morphs=np.ones(1)))
    assert np.allclose(grown - before, [0.0, 9.0, 0.0])
    assert np.allclose(extent.points(rest), before)


def test_a_face_fills_the_picture(renderer, knight):
    face = renderer.portrait(knight, focus="face")
    assert np.array_equal(face, renderer.portrait(knight, focus="head"))
    assert drawn(face)[20:80].mean() > 0.4
    with pytest.raises(CharacterError, match="leftHand"):
        renderer.portrait(knight, focus="leftHand")


def test_a_character_is_seen_from_its_left(renderer, knight):
    """A bow forward is a bow to the left in a picture taken from the character's left."""
    bowed = knight.clips["bow"].sample(1.0)
    columns = np.flatnonzero(drawn(renderer.portrait(knight, bowed, azimuth=np.pi / 2)).any(axis=0))
    upright = renderer.portrait(knight, bowed, azimuth=np.pi / 2)[: SIZE[1] // 2]
    assert np.flatnonzero(drawn(upright).any(axis=0)).mean() < columns.mean()
