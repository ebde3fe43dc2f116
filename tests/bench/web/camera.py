"""A file for Chromium's fake camera: a bundled recording with a clock in its corner."""

from pathlib import Path

import cv2
import numpy as np

from cubeling.app.session.bundled import bundled_session
from cubeling.tracking import open_source

BITS, CELL = 10, 16
"""Bits of the clock, and width of each [px]."""


def write_camera(
    path: Path, scenario: str, seconds: float, *, upright: bool = False, clock: bool = True
) -> int:
    """Write frames of a bundled recording as .mjpeg; return how many."""
    count = 0
    with open_source(str(bundled_session(scenario))) as frames, path.open("wb") as file:
        for frame in frames:
            if count >= seconds * frames.rate:
                break
            image = frame.image.copy()
            if upright:
                image = upright_part(image)
            if clock:
                draw_clock(image, count)
            done, data = cv2.imencode(".jpg", image, (cv2.IMWRITE_JPEG_QUALITY, 92))
            assert done
            file.write(data.tobytes())
            count += 1
    return count


def upright_part(image: np.ndarray) -> np.ndarray:
    """Return the middle of a picture as a phone held upright sees it, as high as it was wide."""
    height, width = image.shape[:2]
    part = round(height * 9 / 16 / 2) * 2
    left = (width - part) // 2
    cut = image[:, left : left + part]
    return cv2.resize(cut, (round(width * 9 / 16), width), interpolation=cv2.INTER_CUBIC)


def draw_clock(image: np.ndarray, number: int) -> None:
    """Draw the number of a frame as black and white cells in the top left corner, in place."""
    for bit in range(BITS):
        color = 255 if number >> bit & 1 else 0
        image[:CELL, bit * CELL : (bit + 1) * CELL] = color


READ_CLOCK = (
    "(() => { const c = document.createElement('canvas'); "
    f"c.width = {BITS * CELL}; c.height = {CELL}; "
    "const g = c.getContext('2d', {willReadFrequently: true}); "
    "window.clockOf = source => { g.drawImage(source, 0, 0, c.width, c.height, 0, 0, c.width, "
    "c.height); const d = g.getImageData(0, 0, c.width, c.height).data; let n = 0; "
    f"for (let b = 0; b < {BITS}; b++) if (d[4 * (({CELL // 2}) * c.width + b * {CELL} + "
    f"{CELL // 2})] > 127) n |= 1 << b; return n; }}; return true; }})()"
)
"""Defines `clockOf(video or canvas)` in a page."""

PHONE_CAMERA = """(() => {
  const of = navigator.mediaDevices, get = of.getUserMedia.bind(of);
  let raw;
  window.isTaken = window.isTurning = window.upright = false;
  window.takeCamera = () => {
    isTaken = true;
    for (const track of [...stream.getTracks(), ...raw.getTracks()]) {
      track.stop();
      track.dispatchEvent(new Event("ended"));
    }
  };
  of.getUserMedia = async asked => {
    if (isTaken) throw new DOMException("in use", "NotReadableError");
    raw = await get(asked);
    if (!isTurning) return raw;
    const video = document.createElement("video"), canvas = document.createElement("canvas");
    video.muted = true;
    video.srcObject = raw;
    await video.play();
    const context = canvas.getContext("2d", {alpha: false});
    const draw = () => {
      const [width, height] = upright ? [720, 1280] : [1280, 720];
      if (canvas.width !== width) [canvas.width, canvas.height] = [width, height];
      if (upright) context.drawImage(video, 438, 0, 405, 720, 0, 0, width, height);
      else context.drawImage(video, 0, 0, width, height);
      video.requestVideoFrameCallback(draw);
    };
    draw();
    return canvas.captureStream();
  };
})()"""
"""Lets what happens to a phone's camera happen to the fake one, which shows what it shows: with
`isTurning`, its pictures are upright if `upright`; `takeCamera()` ends it while `isTaken`."""
