"""Size and quality of videos: `python -m tests.bench.video_codecs [--frames N]`.

The same rendered frames are written by every encoder that `--codec` names, to the first kind of
video that takes its pictures. Size and time are parts of those of the usual encoder, of this run.
"""

import argparse
import tempfile
import time
from pathlib import Path

import av
import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.ui.output_formats import VIDEO_FORMATS
from cubeling.app.ui.video_file import VideoFile
from cubeling.tracking import Frame
from cubeling.tracking.synthetic import open_synthetic

SCENE = "companion"

START_S = 5.0
"""When the frames begin: the hand turns the cube [s]."""


def encode(
    folder: Path, suffix: str, encoder: str, frames: list[Frame]
) -> tuple[int, float, float]:
    """Return the size [bytes], the CPU time [s] and the PSNR [dB] of a video of frames."""
    path = folder / f"{encoder}{suffix}"
    height, width = frames[0].image.shape[:2]
    start = time.process_time()
    with VideoFile(path, (width, height), 30.0, codec=encoder) as video:
        for frame in frames:
            video.write(frame.image, frame.timestamp)
    seconds = time.process_time() - start
    with av.open(str(path)) as file:
        shown = [picture.to_ndarray(format="bgr24") for picture in file.decode(video=0)]
    assert len(shown) == len(frames)
    errors = [
        np.mean((picture.astype(float) - frame.image) ** 2)
        for picture, frame in zip(shown, frames, strict=True)
    ]
    return path.stat().st_size, seconds, float(10 * np.log10(255**2 / np.mean(errors)))


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=60)
    count = parser.parse_args().frames
    source = open_synthetic(SCENE)
    first = round(START_S * source.rate)
    frames = [source.frame(number) for number in range(first, first + count)]
    suffixes: dict[str, list[str]] = {}
    for suffix, kind in VIDEO_FORMATS.items():
        if suffix != ".gif":  # it leaves out pictures
            for encoder in kind.encoders:
                suffixes.setdefault(encoder, []).append(suffix)
    table = Table("--codec", "in", "size", "CPU time", "PSNR dB", title="Videos by encoder")
    with tempfile.TemporaryDirectory() as folder:
        measured = {
            encoder: encode(Path(folder), kinds[0], encoder, frames)
            for encoder, kinds in suffixes.items()
        }
    usual_size, usual_seconds, _ = next(iter(measured.values()))
    for encoder, (size, seconds, psnr) in measured.items():
        table.add_row(
            encoder,
            ", ".join(suffixes[encoder]),
            f"{size / usual_size:.1f}",
            f"{seconds / usual_seconds:.1f}",
            f"{psnr:.0f}",
        )
    Console(width=100).print(table)


if __name__ == "__main__":
    main()
