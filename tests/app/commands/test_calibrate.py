"""`cubeling calibrate`: from pictures to files, and one line where it cannot be."""

import itertools

import numpy as np
import pytest

from cubeling import tracking
from cubeling.app.ui.calibration.coach import REQUEST_SENTENCES, CoachView, words_of
from cubeling.app.ui.calibration.session import Advice, CalibrationSession
from cubeling.tracking import CubeModel, Frame, Intrinsics
from cubeling.tracking.calibration import CubeFinder, ViewCoverage
from cubeling.tracking.synthetic import open_synthetic

WAVE = "wave?size=640x360&blur=0&clutter=0&fold=0.8&seed=2"


class Kept:
    """A source of pictures that were drawn once."""

    rate = 8.0
    duration: float | None = None
    intrinsics: Intrinsics | None = None

    def __init__(self, frames, live=False):
        self.frames, self.live = frames, live
        height, width = frames[0].image.shape[:2] if frames else (360, 640)
        self.size = (width, height)
        self.given = 0

    def __iter__(self):
        for frame in self.frames:
            self.given += 1
            yield frame

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def close(self):
        pass


@pytest.fixture(scope="module")
def waved():
    """A cube that is waved, at its stops: 27 times two pictures."""
    source = open_synthetic(WAVE)
    times = [0.74 * stop + wait for stop in range(27) for wait in (0.02, 0.08)]
    return [Frame(source.frame(round(time * 30)).image, time, n) for n, time in enumerate(times)]


@pytest.fixture
def shown(monkeypatch, cubeling):
    """Run `cubeling calibrate` on pictures."""

    def run(frames, *arguments, live=False):
        source = Kept(frames, live)
        monkeypatch.setattr(tracking, "open_source", lambda uri: source)
        return *cubeling("calibrate", *arguments), source

    return run


@pytest.mark.slow(reason="a camera is calibrated")
def test_waving_the_cube_writes_camera_cube_and_coverage(shown, waved, tmp_path):
    code, out, err, _ = shown(
        waved, "-o", "camera.yaml", "--save-cube", "mine.toml", "--coverage", "seen.png"
    )
    assert (code, err) == (0, "")
    assert "camera.yaml is ready: focal length" in out
    assert "cubeling play follow --intrinsics camera.yaml --cube mine.toml" in out
    camera = Intrinsics.load(tmp_path / "camera.yaml")
    assert camera.matrix[0, 0] == pytest.approx(450, rel=0.005)
    assert camera.size == (640, 360)
    mine, ideal = CubeModel.load(tmp_path / "mine.toml"), CubeModel.load("locomotion")
    off = [
        np.abs(a.corners - b.corners).max() for a, b in zip(mine.faces, ideal.faces, strict=True)
    ]
    assert 0.0003 < max(off) < 0.002
    assert (tmp_path / "seen.png").read_bytes()[:4] == b"\x89PNG"


@pytest.mark.full  # a camera is calibrated twice more
def test_a_check_says_whether_a_file_is_still_right(shown, waved, tmp_path):
    with open_synthetic(WAVE) as source:
        camera = source.intrinsics
    assert camera
    camera.save(tmp_path / "camera.yaml")
    half = waved[:28]  # of the stops: enough to compare with a camera
    code, out, _, _ = shown(half, "--check", "camera.yaml")
    assert code == 0
    assert "OK  camera.yaml: focal length" in out
    worse = Intrinsics(
        camera.matrix * [[1.03, 1, 1], [1, 1.03, 1], [1, 1, 1]], camera.distortion, camera.size
    )
    worse.save(tmp_path / "worse.yaml")
    code, out, _, _ = shown(half, "--check", "worse.yaml")
    assert code == 1
    assert "DEGRADED  worse.yaml: focal length -2." in out


@pytest.mark.full
@pytest.mark.slow(reason="the coach wants to see the cube from all sides")
def test_a_live_session_ends_by_itself_when_the_coach_is_content(shown, waved):
    endless = [
        Frame(frame.image, 20.0 * round_ + frame.timestamp, n)
        for round_ in range(3)
        for n, frame in enumerate(waved)
    ]
    code, out, _, source = shown(endless, live=True)
    assert code == 0
    assert "Done! Thank you" in out
    assert source.given < len(endless)


def test_a_live_session_ends_after_its_time(shown, waved):
    code, _, err, source = shown(waved, "--seconds", 5, live=True)
    assert code in (0, 2)
    assert source.given == pytest.approx(5 / 0.74 * 2, abs=3)
    if code:
        assert err.startswith("cubeling: the camera could not be calibrated: ")


@pytest.mark.parametrize("change", ["blank", "none", "still", "few"])
def test_pictures_that_make_no_camera_are_told_in_one_line(shown, waved, tmp_path, change):
    frames = {
        "blank": [Frame(np.zeros_like(waved[0].image), f.timestamp, f.index) for f in waved[:9]],
        "none": [],
        "still": [Frame(waved[4].image, f.timestamp, f.index) for f in waved],
        "few": waved[:9],
    }[change]
    words = {
        "blank": "no cube was seen in any picture",
        "none": "the source gave no picture at all",
        "still": "too few still images",
        "few": "of 8: ",
    }[change]
    code, _, err, _ = shown(frames)
    assert code == 2
    assert words in err
    assert err.count("\n") == 1
    assert not (tmp_path / "camera.yaml").exists()


def test_a_wrong_word_is_refused_before_a_camera_is_opened(cubeling, tmp_path):
    for name in ("text.yaml", "mine.toml"):
        (tmp_path / name).write_text("hello", encoding="utf-8")
    for arguments, words in (
        (("--board", "chess"), "use charuco"),
        (("--check", "none.yaml"), "cannot read the camera file"),
        (("--check", "text.yaml"), "camera_matrix"),
        (("--cube", "none"), "no cube is called 'none'"),
        (("-o", "none/camera.yaml"), "there is no folder 'none'"),
        (("--coverage", "seen.gif"), "a picture is written as .png, .jpg"),
        (("--save-cube", "mine.yaml"), "written as .toml, not as 'mine.yaml'"),
        (("-o", "text.yaml"), "the camera 'text.yaml' exists already"),
        (("--save-cube", "mine.toml"), "choose another name or add --overwrite"),
        (("--source", "synthetic:none"), "no synthetic scene"),
    ):
        code, _, err = cubeling("calibrate", *arguments)
        assert (code, err.count("\n")) == (2, 1)
        assert words in err


def test_the_board_is_printed(cubeling, tmp_path):
    code, out, _ = cubeling("calibrate", "--print-board", "board.pdf")
    assert code == 0
    assert "board.pdf is ready" in out
    assert (tmp_path / "board.pdf").read_bytes()[:5] == b"%PDF-"


def test_every_wish_has_words_and_a_drawing():
    coverage = ViewCoverage([face.name for face in CubeModel.load("companion").faces])
    for request in [*REQUEST_SENTENCES, *coverage.needed]:
        assert words_of(request, "cube")
        for target, time in itertools.product(("cube", "board"), (0.0, 0.9)):
            view = CoachView(target)
            blank = np.full((360, 640, 3), 90, np.uint8)
            view.draw(blank, 0.0, Advice(request, False, 3, coverage, (), ()))
            drawn = view.draw(blank, time, Advice(request, False, 3, coverage, (), ()))
            assert (drawn[120:240, 20:110] != 90).any()
            # The corners of the picture are where the cube must go.
            assert (drawn[:30, :30] == 90).all()
            assert (drawn[-30:, -30:] == 90).all()


def test_the_drawing_gives_way_to_the_cube():
    coverage = ViewCoverage(["board"])
    view = CoachView("cube")
    for left, free in ((20.0, np.s_[120:240, :130]), (540.0, np.s_[120:240, -130:])):
        outline = np.array([(left, 150), (left + 60, 150), (left + 60, 210), (left, 210)], float)
        blank = np.full((360, 640, 3), 90, np.uint8)
        drawn = view.draw(blank, 0.0, Advice("near", False, 3, coverage, (outline,), ()))
        assert (drawn[free] == 90).mean() > 0.9, "only the outline is drawn there"


def test_the_cube_that_is_held_up_is_recognised(waved):
    finders = [CubeFinder(CubeModel.load(name)) for name in ("companion", "locomotion")]
    session = CalibrationSession(finders, (640, 360))
    told = []

    class SilentDisplay:
        closed = False

        def show_advice(self, picture, timestamp, advice):
            told.append(advice)

    session.run(Kept(waved[:3]), SilentDisplay(), 60.0)
    assert session.finder is finders[1]
    assert told[0].request in ("still", "tilt up")
    assert told[-1].views >= 1
