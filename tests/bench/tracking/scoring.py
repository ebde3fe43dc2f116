"""Scores of tracked poses against the ground truth."""

from collections.abc import Sequence as Rows
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

Array = NDArray[np.float64]

MAX_RECALL_ERROR = (0.010, np.deg2rad(5.0))
"""A pose within this [m, rad] of the truth counts for recall."""

MIN_WRONG_ERROR = (0.020, np.deg2rad(10.0))
"""A pose further off than either [m, rad] is silently wrong: reported as valid."""

CHI2_95_PERCENT = 12.592
"""95 % quantile of χ² with six degrees of freedom: the bound of the stated ellipsoid."""

CHI2_MEDIAN = 5.348
"""Its median."""

PREDICTION_S = 0.05
"""Horizon of the predictions."""


@dataclass(frozen=True)
class Truth:
    """Ground truth of one sequence."""

    name: str
    """Of the sequence."""

    rate: float
    """Frames in a second."""

    independent: bool
    """Whether every frame is another pose, so that nothing moves."""

    poses: Array
    """camera_from_cube in each frame, (N, 4, 4) [m]."""

    velocities: Array
    """Of the cube in each frame, (N, 6) [m/s, rad/s], along camera axes."""

    in_view: NDArray[np.bool_]
    """Whether the whole cube is in the picture, (N,)."""


@dataclass(frozen=True)
class Score:
    """One tracker on one sequence. NaN where there is no measurement."""

    sequence: str
    """Name of the sequence."""

    tracker: str
    """Title of the tracker."""

    frames: int
    """Number of frames."""

    seen: int
    """Number of frames that show the whole cube."""

    recall: float
    """Share of `seen` with a pose within `RIGHT`."""

    wrong: int
    """How many of all `frames` have a pose outside `WRONG`."""

    given: int
    """Number of `seen` with a pose."""

    shift: tuple[float, float]
    """Median and 95th percentile of the distance from the truth [m], over the poses given."""

    turn: tuple[float, float]
    """The same of the angle [rad]."""

    milliseconds: float
    """Median over `frames`."""

    detection_ms: float
    """Median without the solving of the pose; NaN where the tracker does not tell."""

    jitter: tuple[float, float]
    """Largest standard deviation of a coordinate's error [m, rad]; means rest where it rests."""

    inside: float
    """Share of the poses whose stated 95 % ellipsoid holds the truth."""

    understated: float
    """How many times too small the stated standard deviations are, judged by the median of χ²."""

    speed: tuple[float, float]
    """Median error of the stated velocity [m/s, rad/s]."""

    predicted: float
    """Median distance of the tracker's own prediction from where the cube was `AHEAD` later [m]."""

    held: float
    """The same of the last pose, kept."""

    extrapolated: float
    """The same of the last two poses, continued at constant velocity."""

    failures: tuple[str, ...]
    """Distinct errors that the tracker raised."""

    failed: int
    """Number of frames in which it raised one."""


def score(tracker: str, truth: Truth, answers: Rows[dict[str, Any]]) -> Score:
    """Compare a tracker's answers with the ground truth."""
    asked = np.array([answer["index"] for answer in answers], int)
    has = np.array([answer["pose"] is not None for answer in answers], bool)
    seen = truth.in_view[asked]
    off = np.full((len(answers), 6), np.inf)
    poses = np.array([answer["pose"] for answer in answers if answer["pose"] is not None])
    if len(poses):
        off[has] = errors(poses, truth.poses[asked[has]])
    shift, turn = (np.linalg.norm(off[:, part], axis=1) for part in (slice(3), slice(3, 6)))
    right = (shift <= MAX_RECALL_ERROR[0]) & (turn <= MAX_RECALL_ERROR[1])
    wrong = has & ((shift > MIN_WRONG_ERROR[0]) | (turn > MIN_WRONG_ERROR[1]))
    judged = has & seen
    chi2 = _chi2(answers, off, judged)
    failures = [answer["failure"] for answer in answers if "failure" in answer]
    return Score(
        sequence=truth.name,
        tracker=tracker,
        frames=len(answers),
        seen=int(seen.sum()),
        recall=_mean(right[seen]),
        wrong=int(wrong.sum()),
        given=int(judged.sum()),
        shift=_spread(shift[judged]),
        turn=_spread(turn[judged]),
        milliseconds=_median([answer["ms"] for answer in answers]),
        detection_ms=_median([a["detection_ms"] for a in answers if "detection_ms" in a]),
        jitter=_jitter(off[judged]),
        inside=_mean(chi2 <= CHI2_95_PERCENT),
        understated=float(np.sqrt(np.median(chi2) / CHI2_MEDIAN)) if len(chi2) else np.nan,
        speed=_speed_errors(answers, truth, judged),
        **_median_prediction_errors(answers, truth),
        failures=tuple(dict.fromkeys(failures)),
        failed=len(failures),
    )


def errors(poses: Array, truths: Array) -> Array:
    """Return the small motion from each pose to its truth, (N, 6) [m, rad], along camera axes."""
    turns = truths[:, :3, :3] @ poses[:, :3, :3].transpose(0, 2, 1)
    return np.hstack([truths[:, :3, 3] - poses[:, :3, 3], Rotation.from_matrix(turns).as_rotvec()])


def position_later(poses: Array, index: int, steps: float) -> Array | None:
    """Origin of the cube `steps` frames after `index`, (3,) [m]: the cubic through four frames.

    None past the end of the sequence. Exact to 0.04 mm for a hand's motion of 2 Hz and 50 mm at
    30 frames/s.
    """
    before = index + int(np.floor(steps))
    nodes = np.arange(before - 1, before + 3)
    if nodes[0] < 0 or nodes[-1] >= len(poses):
        return None
    at, weights = index + steps, np.ones(4)
    for one in range(4):
        others = np.delete(nodes, one)
        weights[one] = np.prod((at - others) / (nodes[one] - others))
    return np.asarray(weights @ poses[nodes, :3, 3], np.float64)


def _median_prediction_errors(answers: Rows[dict[str, Any]], truth: Truth) -> dict[str, float]:
    """Return the median errors of three ways to predict the position."""
    predicted: list[float] = []
    held: list[float] = []
    extrapolated: list[float] = []
    past: dict[int, Array] = {}
    for answer in answers if not truth.independent else ():
        index, goal = (
            answer["index"],
            position_later(truth.poses, answer["index"], PREDICTION_S * truth.rate),
        )
        if answer["pose"] is None:
            continue
        here = past[index] = np.array(answer["pose"])[:3, 3]
        if goal is None or not truth.in_view[index]:
            continue
        held.append(float(np.linalg.norm(here - goal)))
        if index - 1 in past:
            step = (here - past[index - 1]) * (PREDICTION_S * truth.rate)
            extrapolated.append(float(np.linalg.norm(here + step - goal)))
        if answer.get("expected") is not None:
            expected = np.array(answer["expected"])[:3, 3]
            predicted.append(float(np.linalg.norm(expected - goal)))
    medians = (_median(each) for each in (predicted, held, extrapolated))
    return dict(zip(("predicted", "held", "extrapolated"), medians, strict=True))


def _chi2(answers: Rows[dict[str, Any]], off: Array, judged: NDArray[np.bool_]) -> Array:
    """Squared error of each pose in units of its stated covariance, (N,)."""
    return np.array([
        error @ np.linalg.solve(np.array(answer["covariance"]), error)
        for answer, error, counts in zip(answers, off, judged, strict=True)
        if counts and "covariance" in answer
    ])  # fmt: skip


def _speed_errors(
    answers: Rows[dict[str, Any]], truth: Truth, judged: NDArray[np.bool_]
) -> tuple[float, float]:
    told = [
        np.array(answer["velocity"]) - truth.velocities[answer["index"]]
        for answer, counts in zip(answers, judged, strict=True)
        if counts and "velocity" in answer and not truth.independent
    ]
    if not told:
        return np.nan, np.nan
    off = np.array(told)
    return _median(np.linalg.norm(off[:, :3], axis=1)), _median(np.linalg.norm(off[:, 3:], axis=1))


def _jitter(off: Array) -> tuple[float, float]:
    if len(off) < 2:
        return np.nan, np.nan
    return float(off[:, :3].std(axis=0).max()), float(off[:, 3:].std(axis=0).max())


def _spread(values: Array) -> tuple[float, float]:
    if not len(values):
        return np.nan, np.nan
    return float(np.median(values)), float(np.percentile(values, 95))


def _median(values: Rows[float] | Array) -> float:
    return float(np.median(values)) if len(values) else float("nan")


def _mean(values: NDArray[np.bool_]) -> float:
    return float(np.mean(values)) if len(values) else float("nan")
