"""The section of `tracking/README.md` that `make bench-tracking` writes."""

from collections.abc import Callable, Iterator
from pathlib import Path
from textwrap import wrap

from tests.bench.tracking import targets
from tests.bench.tracking.benchmark_run import BenchmarkRun
from tests.bench.tracking.scoring import Score
from tests.bench.tracking.table import (
    OURS,
    angle,
    length,
    number,
    of,
    own_columns,
    ratio,
    share,
)

WIDTH = 150
"""Of the lines of that file's prose."""

OPENING, CLOSING = "<!-- bench-tracking -->", "<!-- /bench-tracking -->"

RENDERER = (
    "The pictures are ray-cast in linear light by a renderer that shares neither geometry nor blur "
    "with the tracker: its own lens and cube, soft focus, vignetting, every sample of a pixel at a "
    "moment of its own in the exposure, shot and read noise, a camera's curve. Poses are spread "
    "over all six degrees of freedom by Halton's sequence. In such pictures white grows over "
    "black, which moves the corners that the rivals rest on: they see the cube nearly 1 % too far "
    "away. Pictures are 1280×720; those of `webcam…` 640×480 with k1 = 0.13, blur that grows away "
    "from the distance of focus, and JPEG, of a cube of 30 mm at 0.2 to 0.6 m whose paper bends, "
    "is folded askew by 0.3 mm, and has tape and lines beside its markers."
)

RULES = (
    "Recall: a pose within 10 mm and 5° of the truth, of the frames that hold the whole cube. "
    "Silently wrong: given, but more than 20 mm or 10° off, of all frames. Time is that of the "
    "tracker's call, in the median; ÷: of the time that cv2 SUBPIX takes to detect. In `poses` "
    "and `webcam…` every frame is another pose, found without a past, but not in `webcam-held`. In "
    "`webcam-nominal` the trackers are told of no distortion. cv2 looks at the whole picture and "
    "solves by SQPNP and Levenberg-Marquardt from all corners, and so does `rapidtag`; cv2 "
    "APRILTAG is asked for every fourth frame. `aprilcube` is given our cube's corners in its own "
    "format; raw: without its Kalman filter."
)


def write(path: Path, run: BenchmarkRun) -> None:
    """Put the tables between the two marks of a file.

    Raises
    ------
    ValueError
        The file has not both marks, in this order.
    """
    text = path.read_text(encoding="utf-8")
    before, opening, rest = text.partition(OPENING)
    _, closing, after = rest.partition(CLOSING)
    if not opening or not closing:
        raise ValueError(f"{path} has no section between '{OPENING}' and '{CLOSING}'")
    section = "\n".join(lines(run))
    path.write_text(f"{before}{OPENING}\n{section}\n{CLOSING}{after}", encoding="utf-8")


def lines(run: BenchmarkRun) -> Iterator[str]:
    """Write the section, line by line."""
    yield from wrap(f"`{run.command}` printed this: {run.circumstances}.", WIDTH)
    yield from wrap(RENDERER, WIDTH)
    yield from wrap(RULES, WIDTH)
    yield ""
    yield from _matrix(run, "recall % / silently wrong %", _found)
    yield from _matrix(run, "error mm, median (95 %)", lambda s: _pair(s.shift, length))
    yield from _matrix(run, "error °, median (95 %)", lambda s: _pair(s.turn, angle))
    yield from _matrix(run, "ms (÷ cv2 SUBPIX)", lambda s: _time(run, s))
    yield from _jitter(run)
    yield from _own(run)
    rivals = {what: None for title, what in run.versions.items() if title != OURS}
    if rivals:
        yield f"Versions of the rivals: {'; '.join(rivals)}."
    for title, reason in run.left_out.items():
        yield f"{title} was left out: {reason}."
    yield ""
    yield "```"
    yield from (str(verdict) for verdict in targets.verdicts(run.scores))
    yield "```"


def _matrix(run: BenchmarkRun, title: str, cell: Callable[[Score], str]) -> Iterator[str]:
    trackers = list(dict.fromkeys(score.tracker for score in run.scores))
    yield f"| {title} | " + " | ".join(trackers) + " |"
    yield "|---|" + "---|" * len(trackers)
    for name in dict.fromkeys(score.sequence for score in run.scores):
        found = (of(run.scores, name, tracker) for tracker in trackers)
        yield f"| {name} | " + " | ".join(cell(s) if s else "–" for s in found) + " |"
    yield ""


def _found(score: Score) -> str:
    return f"{share(score.recall)} / {share(score.wrong / score.frames)}"


def _pair(values: tuple[float, float], written: Callable[[float], str]) -> str:
    return f"{written(values[0])} ({written(values[1])})" if values[0] == values[0] else "–"


def _time(run: BenchmarkRun, score: Score) -> str:
    return f"{number(score.milliseconds, 1)} ({number(ratio(run.scores, score), 2)})"


def _jitter(run: BenchmarkRun) -> Iterator[str]:
    for name, seen in (("static", "two or three faces"), ("static-one", "one face, square on")):
        rest = [score for score in run.scores if score.sequence == name]
        if rest:
            said = (f"{s.tracker} {length(s.jitter[0])} / {angle(s.jitter[1])}" for s in rest)
            yield f"Jitter at rest with {seen} in view (`{name}`), mm / °: {', '.join(said)}."
            yield ""


def _own(run: BenchmarkRun) -> Iterator[str]:
    yield (
        f"| {OURS} alone | held by the 95 % ellipsoid | 50 ms ahead, mm | at constant velocity | "
        "last pose held | velocity off by mm/s | °/s |"
    )
    yield "|---|---|---|---|---|---|---|"
    for score in run.scores:
        if score.tracker == OURS:
            inside = f"{share(score.inside)} %"
            yield "| " + " | ".join([score.sequence, inside, *own_columns(score)]) + " |"
    yield ""
