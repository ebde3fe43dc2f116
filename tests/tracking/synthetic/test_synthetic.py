"""The synthetic camera renders the cube exactly at its true pose, and reproducibly."""

import cv2
import numpy as np
import pytest
from numpy.typing import NDArray

from cubeling.tracking import CubeModel, TrackingError
from cubeling.tracking.geometry.projection import Projection
from cubeling.tracking.sources import open_source
from cubeling.tracking.sources.base import FrameSource
from cubeling.tracking.synthetic import SCRIPTS, SyntheticOptions, SyntheticSource, open_synthetic
from cubeling.tracking.synthetic.camera_rays import CameraRays
from cubeling.tracking.synthetic.paper_cube import PaperCube
from cubeling.tracking.synthetic.source import webcam
from tests.examples import some

Array = NDArray[np.float64]

CLEAN = "noise=0&defocus=0&clutter=0&hand=0&shadow=0&blur=0"


def truth_in_pixels(source: SyntheticSource, camera_from_cube: Array) -> dict[int, Array]:
    """Where the corners of every marker are, by its number."""
    assert source.intrinsics is not None
    projection = Projection(source.intrinsics)
    turn, shift = camera_from_cube[:3, :3], camera_from_cube[:3, 3]
    return {
        face.marker_id: projection.project(face.corners @ turn.T + shift)
        for face in source.cube.faces
    }


def edge_crossing(profile: Array, middle: float) -> float:
    """Where a profile from black to white or back passes half way, by its integral."""
    low, high = profile[:6].mean(), profile[-6:].mean()
    share = (profile - low) / (high - low)
    # The area under an ideal step at s over samples at 0 … n - 1 is n - 0.5 - s.
    return middle - (len(profile) - 1) / 2 + len(profile) - 0.5 - float(share.sum())


@pytest.mark.parametrize("shift", some([0.25, 0.8, 0.0, 0.5], 2))
def test_pixel_centres_are_at_integers(shift: float) -> None:
    """The borders of a large marker that looks at the camera lie where they are projected to."""
    options = SyntheticOptions(noise=0, defocus=0.7, distortion=0, clutter=False, shadow=False)
    camera = CameraRays(webcam(options))
    cube = CubeModel.load("locomotion")
    pose = np.diag([1.0, -1.0, -1.0, 1.0])  # the front face looks at the camera, upright
    pose[:3, 3] = 0.01 + shift * 0.2 / 900, -0.02 + shift * 0.2 / 900, 0.2 + cube.edge / 2
    paper = PaperCube(cube, camera, 1)
    corners = camera.pixels(cube.face("front").corners @ pose[:3, :3].T + pose[:3, 3])
    region = camera.region_around(corners, 12)
    picture, _ = paper.draw(region, [pose], np.array([0.0, -0.6, -0.8]), 4)
    grey = picture.mean(axis=-1).astype(float)
    corners -= (region.x, region.y)
    for first, second, across in ((0, 1, 1), (1, 2, 0), (2, 3, 1), (3, 0, 0)):
        truth = float(corners[[first, second], across].mean())
        middle = round(truth)
        near = np.s_[middle - 9 : middle + 10]
        # Away from the corners, and from the icon above the middle of the upper border.
        shares = np.concatenate([np.linspace(0.1, 0.38, 15), np.linspace(0.62, 0.9, 15)])
        ends = corners[[first, second], 1 - across]
        lines = np.rint(ends[0] + shares * (ends[1] - ends[0])).astype(int)
        profiles = grey[near][:, lines] if across else grey[lines][:, near].T
        assert edge_crossing(profiles.mean(axis=1), middle) == pytest.approx(truth, abs=0.03)


@pytest.mark.slow(reason="ten pictures are drawn in full size, as corners are measured")
def test_marker_corners_are_rendered_at_their_true_projection() -> None:
    """Through perspective and distortion: what OpenCV finds has no common offset."""
    source = open_synthetic(f"poses?{CLEAN}")
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    settings = cv2.aruco.DetectorParameters()
    settings.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    settings.cornerRefinementMinAccuracy = 0.001
    settings.cornerRefinementMaxIterations = 100
    detector = cv2.aruco.ArucoDetector(dictionary, settings)
    misses = []
    for index in range(10):
        expected = truth_in_pixels(source, source.truth(index))
        found, numbers, _ = detector.detectMarkers(source.frame(index).image)
        for corners, number in zip(found, map(int, np.ravel(numbers)), strict=True):
            # A marker seen at a slant has its corners pulled by their surroundings.
            if cv2.contourArea(corners) > 2500:
                misses.append(corners[0] - expected[number])
    apart = np.array(misses)
    assert len(apart) >= 6
    assert np.abs(np.median(apart, axis=(0, 1))).max() < 0.05
    # Each corner is pulled a little to the middle of its marker, as `cornerSubPix` does.
    assert np.median(np.linalg.norm(apart, axis=-1)) < 0.3


def test_folding_errors_are_rendered() -> None:
    source = open_synthetic("wave?fold=2&noise=0&defocus=0.3")
    frame = source.frame(4)
    grey = cv2.cvtColor(frame.image, cv2.COLOR_BGR2GRAY)
    parameters = cv2.aruco.DetectorParameters()
    parameters.cornerRefinementMethod = cv2.aruco.CORNER_REFINE_SUBPIX
    dictionary = cv2.aruco.getPredefinedDictionary(cv2.aruco.DICT_4X4_50)
    squares, ids, _ = cv2.aruco.ArucoDetector(dictionary, parameters).detectMarkers(grey)
    assert len(ids) == 2
    faces = {face.marker_id: face for face in source.cube.faces}
    ideal = {face.marker_id: face for face in CubeModel.load("locomotion").faces}
    truth, camera = source.truth(4), source.intrinsics
    assert camera is not None
    for number, square in zip(np.ravel(ids), squares, strict=True):
        away = []
        for cube in (faces, ideal):
            points = cube[int(number)].corners @ truth[:3, :3].T + truth[:3, 3]
            pixels = cv2.projectPoints(
                points, np.zeros(3), np.zeros(3), camera.matrix, camera.distortion
            )[0]
            away.append(np.linalg.norm(pixels.reshape(4, 2) - square.reshape(4, 2), axis=1).max())
        assert away[0] < 0.8
        assert away[1] > 3


def test_the_same_seed_gives_the_same_images() -> None:
    one, other = (open_synthetic("follow?seed=3&width=320&height=180") for _ in range(2))
    for index in (0, 75):
        assert np.array_equal(one.frame(index).image, other.frame(index).image)
    another = open_synthetic("follow?seed=4&width=320&height=180")
    assert not np.array_equal(one.frame(0).image, another.frame(0).image)


def test_frames_do_not_depend_on_their_order() -> None:
    source = open_synthetic("follow?frames=3&width=320&height=180")
    last = source.frame(2).image
    assert np.array_equal(list(source)[2].image, last)


@pytest.mark.parametrize("name", sorted(SCRIPTS))
def test_every_script_moves_smoothly_and_ends(name: str) -> None:
    source = open_synthetic(f"{name}?rate=120")
    assert source.count == round(source.duration * 120) > 0  # type: ignore[operator]
    if name == "poses":
        return
    poses = np.array([source.state(index).table_from_cube for index in range(source.count)])
    speed = np.linalg.norm(np.diff(poses[:, :3, 3], axis=0), axis=1) * 120
    assert speed.max() < 1.6
    if name == "wave":
        return  # it is far above the desk, and its poses are those in the camera's frame
    half = source.cube.edge / 2
    lowest = poses[:, 1, 3] - half * np.abs(poses[:, 1, :3]).sum(axis=1)
    assert lowest.min() > -0.004  # a trembling hand presses it no deeper into the desk


@pytest.mark.parametrize("name", ["follow", "sketch", "companion", "tip"])
def test_a_cube_at_rest_is_still_and_flat_on_the_desk(name: str) -> None:
    source = open_synthetic(name)
    resting = [index for index in range(source.count) if source.state(index).resting]
    assert len(resting) > source.count / 10
    for index in resting:
        pose = source.state(index).table_from_cube
        assert pose[1, 3] == pytest.approx(source.cube.edge / 2, abs=1e-9)
        assert np.abs(pose[1, :3]).max() == pytest.approx(1, abs=1e-9)


def test_tip_rests_on_every_face() -> None:
    source = open_synthetic("tip")
    notes = [source.state(index) for index in range(source.count)]
    tops = {note.top_face for note in notes if note.resting}
    assert tops == {"top", "bottom", "front", "back", "left", "right"}


def test_turns_are_counted_clockwise_from_above() -> None:
    source = open_synthetic("turns")
    turns = [source.state(index).turns for index in range(source.count)]
    assert max(turns) == pytest.approx(2, abs=0.01)
    assert min(turns) == pytest.approx(-2, abs=0.01)
    assert turns[-1] == pytest.approx(0, abs=0.01)


def test_the_cube_is_always_in_the_image() -> None:
    for name in ("follow", "sketch", "companion"):
        source = open_synthetic(name)
        assert source.intrinsics is not None
        projection = Projection(source.intrinsics)
        centres = np.array([source.truth(i)[:3, 3] for i in range(0, source.count, 5)])
        pixels = projection.project(centres)
        assert (pixels > 60).all()
        assert (pixels < np.array(source.size) - 60).all()


def test_a_sleeve_ends_at_the_border_of_the_image() -> None:
    """The lens bends its far end, which is not seen, into the image."""
    image = open_synthetic("sketch").frame(290).image.astype(int)
    rows = (image[..., 0] > image[..., 2] + 20).sum(axis=0)
    assert rows[1200] > 100
    assert rows[-1] > 0.9 * rows[1200]


def test_motion_blur_is_centred_on_the_true_pose() -> None:
    """The shutter is centred on the frame's time: blur moves no edge to one side."""
    still = open_synthetic(f"sweep?{CLEAN}&speed=1")
    moving = open_synthetic(f"sweep?{CLEAN.replace('blur=0', 'blur=0.02')}&speed=1")
    speeds = [
        float(np.linalg.norm(still.truth(i + 1)[:3, 3] - still.truth(i)[:3, 3]))
        for i in range(still.count - 1)
    ]
    index = int(np.argmax(speeds))
    desk, sharp, smeared = (
        source.frame(at).image.astype(float)[280:560].mean(axis=2)
        for source, at in ((still, 0), (still, index), (moving, index))
    )
    assert still.truth(0)[0, 3] < -0.1 < still.truth(index)[0, 3]
    around = np.s_[:, 500:780]
    change = (smeared - sharp)[around].sum(axis=0) @ np.arange(280)
    shift = change / (sharp - desk)[around].sum()
    # It moves 26 px: a shutter that opens or closes at the frame's time would be off by 13.
    assert np.abs(smeared - sharp).max() > 40
    assert abs(shift) < 1.5


def test_the_synthetic_camera_is_a_frame_source() -> None:
    with open_source("synthetic:static?frames=2&width=320&height=180") as source:
        assert isinstance(source, FrameSource)
        assert not source.live
        frames = list(source)
    assert [frame.index for frame in frames] == [0, 1]
    assert frames[1].timestamp == pytest.approx(1 / 30)
    assert frames[0].image.shape == (180, 320, 3)


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("nowhere", "there is no synthetic scene 'nowhere'"),
        ("turn?colour=red", "has no option 'colour'"),
        ("turn?rate=fast", "rate=fast is not a"),
        ("turn?noise=-1", "noise must be from 0 to 50"),
        ("turn?size=1280", "size=1280"),
    ],
)
def test_a_wrong_name_or_option_is_refused_with_one_line(name: str, says: str) -> None:
    with pytest.raises(TrackingError, match=says) as caught:
        open_synthetic(name)
    assert "\n" not in str(caught.value)
