"""What `cubeling doctor` reports about a camera."""

from cubeling import tracking
from cubeling.tracking import Frame
from cubeling.tracking.sources.device import DeviceSetting, Health


class EndlessCamera:
    """A camera that delivers 30 frames a second without end."""

    live, duration, intrinsics = True, None, None
    size, rate = (64, 48), 30.0
    health = Health(
        "camera 0",
        "running",
        0.0,
        rate=29.97,
        latency=0.041,
        stamped_by="driver",
        settings=(
            DeviceSetting("exposure", True, "locked at 15.6 ms"),
            DeviceSetting("focus", False, "the camera has no such setting"),
        ),
    )

    def __init__(self):
        self.given = 0
        self.closed = False

    def __iter__(self):
        while True:
            yield Frame(None, self.given / 30, self.given)  # type: ignore[arg-type]  # not seen
            self.given += 1

    def wait(self, timeout, patience=None):
        raise AssertionError("the doctor may block")

    def close(self):
        self.closed = True

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()


def test_the_doctor_reports_the_figures_of_a_camera(cubeling, monkeypatch):
    camera = EndlessCamera()
    monkeypatch.setattr(tracking, "open_source", lambda uri: camera)
    code, out, err = cubeling("doctor")
    assert (code, err) == (0, "")
    assert "camera:0, 64x48, 30.0 pictures/s, 41 ms old (since exposure)" in out
    assert "exposure locked at 15.6 ms" in out
    assert "focus the camera has no such setting" in out
    assert camera.given == 120
    assert camera.closed
