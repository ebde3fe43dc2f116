"""When the cube is a window, and who is seen inside."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.pipeline.choices import inside_of
from cubeling.app.pipeline.cube_window import (
    DWELL_S,
    INVITATION_S,
    OPENING_S,
    CubeWindow,
)
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step_renderer import CLOSE_UP_PX
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.session.encoding import encode
from cubeling.characters import ActionIntent, Character, CharacterCommand
from cubeling.characters.rendering import WALL_SHARE, CameraView, Stage, create_context
from cubeling.characters.rendering.projection import project
from cubeling.tracking import CubeModel, CubeState
from cubeling.tracking.gestures.table import SIDE_NORMALS
from cubeling.tracking.synthetic import open_synthetic

FRAME_S = 1 / 30
UP_TO_CAMERA = np.array([[1.0, 0, 0, 0], [0, -0.8, -0.6, 0.03], [0, 0.6, -0.8, 0.6], [0, 0, 0, 1]])
"""`camera_from_table` of a camera that looks down at the table."""


def turned(face):
    """Return a rotation (3, 3) that turns a face of the cube up."""
    up = SIDE_NORMALS[face]
    front = np.roll(up, 1)
    return np.stack([np.cross(up, front), up, front])


class Table:
    """A table with a cube on it: shows faces, frame by frame, to a window."""

    def __init__(self, window, rate=30.0):
        self.window, self.rate, self.frames = window, rate, 0
        self.interior = None

    def show(self, hand, face, seconds, *, seen=True, toggled=False, **changes):
        """Show a cube whose `face` is up for some seconds."""
        for _ in range(round(seconds * self.rate)):
            now = self.frames / self.rate
            self.frames += 1
            pose = np.eye(4)
            pose[:3, :3] = turned(face)
            pose = UP_TO_CAMERA @ pose
            state = CubeState(
                seen, pose if seen else None, np.zeros(6), np.eye(6), "markers", (), 0.1, now
            )
            fields = {"top_face": face, "camera_from_table": UP_TO_CAMERA, "resting": True}
            controls = replace(
                hand.controls, **{**fields, "visible": seen, "timestamp": now, **changes}
            )
            command = CharacterCommand(now, action=ActionIntent("idle"))
            self.interior = self.window.update(state, controls, command, toggled)
            toggled = False
        return self.interior


def with_role(names):
    """Return a cube of which only the named faces have a role."""
    cube = CubeModel.load("companion")
    faces = tuple(replace(face, role="kiss" if face.name in names else "") for face in cube.faces)
    return replace(cube, faces=faces)


@pytest.fixture(scope="module")
def vleo():
    return Character.load("vleo")


@pytest.fixture
def table(vleo):
    return Table(CubeWindow(with_role(("top", "front")), vleo, ("kiss",)))


def test_a_face_without_a_role_opens_the_cube_and_one_with_a_role_closes_it(hand, table):
    assert table.show(hand, "top", 2.0) is None
    opened = table.show(hand, "left", DWELL_S + OPENING_S + 0.1)
    assert opened.box.opening == 1.0
    assert opened.left_on_table == 0.0
    assert opened.resident is not None
    assert table.show(hand, "front", DWELL_S + OPENING_S + 0.1) is None


def test_a_face_that_is_shown_for_a_moment_changes_nothing(hand, table):
    for _ in range(4):
        assert table.show(hand, "left", 0.35) is None
        assert table.show(hand, "top", 0.2) is None


def test_a_face_without_a_marker_has_no_role_either(hand, vleo):
    cube = with_role(("top", "front"))
    cube = replace(cube, faces=tuple(face for face in cube.faces if face.role))
    table = Table(CubeWindow(cube, vleo, ("kiss",)))
    assert table.show(hand, "left", 2.0).box.opening == 1.0


@pytest.mark.parametrize("name", ["companion", "locomotion"])
def test_faces_of_the_bundled_cubes_never_open_them(hand, vleo, name):
    table = Table(CubeWindow(CubeModel.load(name), vleo, ()))
    for face in SIDE_NORMALS:
        assert table.show(hand, face, 1.0) is None
    assert table.show(hand, "top", 1.0, lifted=True, resting=False) is None


def test_a_cube_without_any_role_is_opened_by_the_key_only(hand, vleo):
    table = Table(CubeWindow(with_role(()), vleo, ()))
    assert table.show(hand, "top", 2.0) is None
    assert table.show(hand, "top", 1.0, toggled=True).box.opening == 1.0


def test_the_key_opens_and_closes_until_another_face_decides(hand, table):
    assert table.show(hand, "top", 1.0, toggled=True).box.opening == 1.0
    assert table.show(hand, "front", 1.0).box.opening == 1.0
    assert table.show(hand, "front", 1.0, toggled=True) is None
    assert table.show(hand, "left", 2.0).box.opening == 1.0
    assert table.show(hand, "left", 1.0, toggled=True) is None
    assert table.show(hand, "left", 1.0) is None


def test_it_may_be_open_always_or_never(hand, vleo):
    always, never = (
        Table(CubeWindow(with_role(("top",)), vleo, ("kiss",), choice))
        for choice in ("always", "never")
    )
    assert always.show(hand, "top", 1.0).box.opening == 1.0
    assert never.show(hand, "left", 2.0, toggled=True) is None
    with pytest.raises(AppError, match="choose one of auto, always, never"):
        inside_of("sometimes")


def test_without_roles_in_a_scenario_the_side_towards_the_camera_decides(hand, vleo):
    """The back turned up shows the bottom's neighbour: it is computed from the pose alone."""
    toward = {face: most_square(face) for face in SIDE_NORMALS}
    for top, side in toward.items():
        table = Table(CubeWindow(with_role(set(SIDE_NORMALS) - {side}), vleo, ()), rate=10.0)
        assert table.show(hand, top, 2.0).box.opening == 1.0
        table = Table(CubeWindow(with_role({side}), vleo, ()), rate=10.0)
        assert table.show(hand, top, 2.0) is None


def most_square(top):
    rotation = UP_TO_CAMERA[:3, :3] @ turned(top)
    sight = UP_TO_CAMERA[:3, 3]
    sides = {n: -float(rotation @ v @ sight) for n, v in SIDE_NORMALS.items()}
    level = {n: each for n, each in sides.items() if abs(SIDE_NORMALS[n] @ SIDE_NORMALS[top]) < 0.5}
    return max(level, key=lambda name: level[name])


def test_in_the_hand_the_face_that_looks_at_the_camera_decides(hand, vleo):
    rotation = UP_TO_CAMERA[:3, :3] @ turned("top")
    cosines = {n: -float(rotation @ v @ UP_TO_CAMERA[:3, 3]) for n, v in SIDE_NORMALS.items()}
    shown = max(cosines, key=lambda name: cosines[name])
    table = Table(CubeWindow(with_role(set(SIDE_NORMALS) - {shown}), vleo, ("kiss",)))
    lifted = {"lifted": True, "resting": False}
    assert table.show(hand, "top", 2.0, **lifted).box.opening == 1.0


@pytest.mark.parametrize("rate", [10.0, 30.0, 120.0])
def test_the_walls_take_the_same_time_at_every_frame_rate(hand, vleo, rate):
    table = Table(CubeWindow(with_role(("top",)), vleo, (), "always"), rate)
    half = table.show(hand, "top", OPENING_S / 2 + 1 / rate)  # the first frame has no time before
    assert half.box.opening == pytest.approx(0.5, abs=1e-6)
    assert table.show(hand, "top", OPENING_S / 2).box.opening == pytest.approx(1.0)


def test_a_cube_that_is_lost_for_a_moment_stays_open_where_it_was(hand, table):
    before = table.show(hand, "left", 2.0)
    held = table.show(hand, "left", 0.2, seen=False)
    assert held.box.opening == 1.0
    assert np.array_equal(held.box.camera_from_box, before.box.camera_from_box)
    assert table.show(hand, "left", 0.5, seen=False) is None
    again = table.show(hand, "left", 0.3)
    assert 0.0 < again.box.opening < 1.0


def test_the_player_is_asked_to_look_inside_when_the_cube_has_opened(hand, table):
    table.show(hand, "top", 1.0)
    assert not table.window.invites
    table.show(hand, "left", 1.0)
    assert table.window.invites
    table.show(hand, "left", INVITATION_S)
    assert not table.window.invites


@pytest.mark.parametrize("name", ["human", "vleo", "robot"])
def test_who_is_inside_fits_stands_on_the_lowest_wall_and_faces_the_camera(hand, name):
    character = Character.load(name)
    window = CubeWindow(CubeModel.load("companion"), character, (), "always")
    table = Table(window, rate=10.0)
    table.show(hand, "top", 1.0)
    low, high = character.bounds
    corners = np.stack(np.meshgrid(*np.stack([low, high]).T, indexing="ij"), -1).reshape(-1, 3)
    for face, up in SIDE_NORMALS.items():
        interior = table.show(hand, face, 2.5)
        cube_from_table = np.linalg.inv(interior.box.camera_from_box) @ UP_TO_CAMERA
        placed = cube_from_table @ interior.resident.table_from_character
        points = (corners @ placed[:3, :3].T + placed[:3, 3]) / interior.box.edge
        assert (points @ up).min() == pytest.approx(WALL_SHARE - 0.5, abs=0.02)
        assert (points @ up).max() < 0.5 - WALL_SHARE
        assert np.abs(points).max() < 0.5 + 0.12  # the corners of its box, where it has nothing
        assert 0.3 < np.ptp(points @ up) < 0.7
        camera = (cube_from_table @ np.linalg.inv(UP_TO_CAMERA))[:3, 3]
        toward = camera - (camera @ up) * up
        ahead = placed[:3, 2] / np.linalg.norm(placed[:3, 2])
        assert ahead @ toward / np.linalg.norm(toward) > 0.7


def test_the_resident_moves_to_another_floor_without_a_leap(hand, table):
    table.show(hand, "left", 2.0)
    places = []
    for _ in range(20):
        interior = table.show(hand, "back", FRAME_S)
        table_from_cube = np.linalg.inv(UP_TO_CAMERA) @ interior.box.camera_from_box
        resident = np.linalg.inv(table_from_cube) @ interior.resident.table_from_character
        places.append(resident[:3, 3])
    steps = np.linalg.norm(np.diff(places, axis=0), axis=1)
    assert steps.max() < 0.012
    assert steps.sum() > 0.03


@pytest.fixture(scope="module")
def source():
    return open_synthetic("companion?size=800x450&clutter=0&shadow=0&hand=0")


@pytest.fixture(scope="module")
def frames(source):
    return [source.frame(index) for index in range(40)]


def playground(source, **settings):
    intrinsics = intrinsics_for(source.intrinsics, source.size)
    return Playground("companion", intrinsics, cube=source.cube, **settings)


@pytest.mark.slow(reason="two sessions are computed")
def test_an_open_cube_changes_no_message_of_a_session(source, frames):
    steps = [
        [playing.step(frame) for frame in frames[:25]]
        for playing in (playground(source, inside=choice) for choice in ("always", "never"))
    ]
    assert steps[0][-1].interior.box.opening > 0.3
    for opened, closed in zip(*steps, strict=True):
        assert closed.interior is None
        for topic, message in opened.messages().items():
            assert encode(message) == encode(closed.messages()[topic])


def test_a_character_in_the_cube_leaves_nothing_on_the_table(source, frames):
    context = create_context()
    playing = playground(source, inside="always", context=context, realism=())
    for frame in frames:
        step = playing.step(frame, drawn=frame is frames[-1])
    assert step.interior.box.opening == 1.0
    stage = Stage(context, source.size)
    lens = playing.intrinsics
    bare = stage.draw(CameraView(frames[-1].image, lens.matrix, lens.distortion, None), [])
    rows, columns = np.nonzero((step.picture != bare).any(axis=2))
    assert len(rows) > 800
    corners = 0.03 * np.stack(np.meshgrid([-1, 1], [-1, 1], [-1, 1]), -1).reshape(-1, 3)
    pose = step.state.camera_from_cube
    pixels = project(corners @ pose[:3, :3].T + pose[:3, 3], lens.matrix)
    assert (np.array([columns.min(), rows.min()]) > pixels.min(axis=0) - 2).all()
    assert (np.array([columns.max(), rows.max()]) < pixels.max(axis=0) + 2).all()
    assert step.close_up.shape == (CLOSE_UP_PX, CLOSE_UP_PX, 3)
    assert playing.step(frames[-1], Inputs(inside=True), drawn=False).close_up is None
    assert len(step.subjects) == 1  # cards need not avoid the place where it stood
    playing.close()
    stage.release()
    context.release()


def test_after_a_checkpoint_the_cube_opens_in_the_same_way(source, frames):
    playing = playground(source)
    for frame in frames[:20]:
        playing.step(frame, Inputs(inside=frame is frames[12]))
    checkpoint = playing.checkpoint()
    seen = []
    for _ in range(2):
        playing.restore(checkpoint)
        seen.append([playing.step(frame).interior for frame in frames[20:]])
    for first, second in zip(*seen, strict=True):
        assert 0.0 < first.box.opening == second.box.opening
        assert first.left_on_table == second.left_on_table
        if first.resident is not None:
            place = first.resident.table_from_character
            assert np.array_equal(place, second.resident.table_from_character)
