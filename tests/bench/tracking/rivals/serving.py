"""What every tracker's process does: frames from a shared file in, poses and milliseconds out.

Runs in the environment of any rival, so it knows numpy and OpenCV and nothing of `tracking`.

A line of JSON comes in on standard input, and lines go out on standard output:

    {"begin": {"frames": "….npy", "timestamps": […], "camera": {…}, "cube": {…}, …}}   no answer
    {"ask": [0, 1, 2]}                              one line for each frame, in this order
"""

import json
import os
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, Protocol, TextIO

import cv2
import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Picture = NDArray[np.uint8]


@dataclass(frozen=True)
class Scene:
    """What a tracker is told before the first frame."""

    matrix: Array
    """Focal lengths and principal point, (3, 3) [px]."""

    distortion: Array
    """Of the lens, (5,): k1 k2 p1 p2 k3."""

    size: tuple[int, int]
    """Width and height of the pictures [px]."""

    cube: str
    """Name of the bundled cube."""

    dictionary: str
    """Name of OpenCV's dictionary, "DICT_4X4_50"."""

    edge: float
    """Of the cube [m]."""

    corners: dict[int, Array]
    """For each marker id the corners of its black square in the cube frame, (4, 3) [m]."""

    faces: dict[int, str]
    """For each marker id the name of its face: front, right, back, left, top, bottom."""


class Tracker(Protocol):
    """One tracker on one sequence."""

    def track(self, image: Picture, timestamp: float) -> Array | None:
        """Return camera_from_cube, (4, 4) [m], or None: the one call that is timed."""

    def notes(self) -> dict[str, Any]:
        """Return what else is known of that frame, ready for JSON; not timed."""


def serve(make: Callable[[Scene], Tracker], versions: dict[str, str]) -> None:
    """Answer until standard input ends."""
    cv2.setNumThreads(int(os.environ["BENCH_THREADS"]))
    answers = _answers_alone()
    _say(answers, {"ready": versions})
    job: _Job | None = None
    for line in sys.stdin:
        message = json.loads(line)
        if "begin" in message:
            job = _Job(make, message["begin"])
        elif job is not None:
            for answer in job.answers(message["ask"]):
                _say(answers, answer)


class _Job:
    """One sequence: its frames, and the tracker that follows them."""

    def __init__(self, make: Callable[[Scene], Tracker], begin: dict[str, Any]) -> None:
        self._make, self._scene = make, scene_of(begin)
        self._frames = np.load(begin["frames"], mmap_mode="r")
        self._timestamps: list[float] = begin["timestamps"]
        self._independent: bool = begin["independent"]
        self._tracker = make(self._scene)

    def answers(self, indices: list[int]) -> Iterator[dict[str, Any]]:
        for index in indices:
            if self._independent:
                self._tracker = self._make(self._scene)
            yield {"index": index} | self._answer(index)

    def _answer(self, index: int) -> dict[str, Any]:
        image = np.array(self._frames[index])  # a copy: reading the file is not the tracker's time
        pose, failure = None, ""
        start = time.perf_counter()
        try:
            pose = self._tracker.track(image, self._timestamps[index])
        except Exception as error:  # a tracker that breaks down has no pose; the table says so
            failure = f"{type(error).__name__}: {error}"
        milliseconds = 1000 * (time.perf_counter() - start)
        known = pose is not None and bool(np.isfinite(pose).all())
        answer = {"pose": np.asarray(pose).tolist() if known else None, "ms": milliseconds}
        return answer | ({"failure": failure} if failure else self._tracker.notes())


def scene_of(begin: dict[str, Any]) -> Scene:
    """Read the scene from the message that begins a sequence."""
    camera, cube = begin["camera"], begin["cube"]
    return Scene(
        matrix=np.array(camera["matrix"], np.float64),
        distortion=np.array(camera["distortion"], np.float64),
        size=(camera["size"][0], camera["size"][1]),
        cube=cube["name"],
        dictionary=cube["dictionary"],
        edge=cube["edge"],
        corners={face["id"]: np.array(face["corners"], np.float64) for face in cube["faces"]},
        faces={face["id"]: face["name"] for face in cube["faces"]},
    )


def _answers_alone() -> TextIO:
    """Keep standard output for the answers: what a library prints goes to the errors."""
    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w", encoding="utf-8")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())
    return answers


def _say(answers: TextIO, message: dict[str, Any]) -> None:
    answers.write(json.dumps(message) + "\n")
    answers.flush()
