"""Joint weights fitted to recordings, and how well they hold for clips that were left out.

The weights of the thesis are set by hand (M2.2). Wang and Bodenheimer ("An evaluation of a cost
metric for selecting transitions between motion segments", SCA 2003) fitted those of Lee's distance
to transitions that people had judged, and cross-validated them. Here no person judges: weights are
good if two frames are as unlike as their joints look in the next third of a second, by Kovar's
aligned clouds of points.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.synthesis.body import default_body_plan
from cubeling.characters.synthesis.distances.angles import JointAngles
from cubeling.characters.synthesis.distances.points import PointClouds
from cubeling.characters.synthesis.library import MotionLibrary

COMPARED_PAIRS = 20_000
"""Pairs of frames that are compared."""

PRIOR_WEIGHTS = (0.3, 1.0, 3.0, 10.0)
"""How much the weights of the thesis count against the recordings: one of these, by the clips that
are left out. Without them a few clips are fitted too well, and others worse than by the thesis."""

_SWEEPS = 200


@dataclass(frozen=True)
class FittedWeights:
    """Joint weights of recordings."""

    weights: dict[str, float]
    """By body part, as in `profiles.toml`; their sum is that of the thesis."""

    agreement: float
    """Rank correlation with what is seen, for pairs with a frame of a clip that was left out of
    the fit: the mean over all clips. The pull was chosen by it, so it is slightly too high."""

    default_agreement: float
    """The same of the weights of the thesis."""


def fit_weights(library: MotionLibrary, seed: int = 0) -> FittedWeights:
    """Return the weights of the joints of the thesis that suit the clips of a library best.

    Pairs that look alike count more: an error is relative to the distance, as only near frames are
    joined.

    Raises
    ------
    CharacterError
        If there are fewer than three clips: none could be left out.
    """
    clips = np.unique(library.clip_of)
    if len(clips) < 3:
        raise CharacterError(
            f"{len(clips)} clips: give at least three, so that one can be left out"
        )
    rng = np.random.default_rng(seed)
    a, b = rng.integers(len(library), size=(2, COMPARED_PAIRS))
    plan = default_body_plan()
    parts = {part: library.anatomy.joint(part) for part in plan.weights}
    joints = {part: joint for part, joint in parts.items() if joint is not None}
    angles = np.stack(
        [JointAngles(library, {joint: 1.0}, height=0.0).pairs(a, b) for joint in joints.values()], 1
    )
    seen = PointClouds(library).pairs(a, b)
    default = np.array([plan.weights[part] for part in joints])
    left_out = [(library.clip_of[a] == clip) | (library.clip_of[b] == clip) for clip in clips]

    def agreement(weights: Array, held: NDArray[np.bool_]) -> float:
        return rank_correlation(angles[held] @ weights, seen[held])

    def cross_validate(pull: float) -> float:
        fits = [nonnegative_weights(angles[~held], seen[~held], default, pull) for held in left_out]
        return float(np.mean([agreement(*each) for each in zip(fits, left_out, strict=True)]))

    agreements = {pull: cross_validate(pull) for pull in PRIOR_WEIGHTS}
    best = max(PRIOR_WEIGHTS, key=agreements.__getitem__)
    weights = nonnegative_weights(angles, seen, default, best)
    weights *= default.sum() / weights.sum()
    return FittedWeights(
        dict(zip(joints, weights.tolist(), strict=True)),
        agreements[best],
        float(np.mean([agreement(default, held) for held in left_out])),
    )


def rank_correlation(a: Array, b: Array) -> float:
    """Return Spearman's rank correlation of two series (n,) without ties.

    >>> round(rank_correlation(np.array([1.0, 2.0, 3.0]), np.array([1.0, 8.0, 27.0])), 6)
    1.0
    """
    one, other = (np.argsort(np.argsort(values)) - (len(values) - 1) / 2 for values in (a, b))
    return float(one @ other / np.sqrt((one @ one) * (other @ other)))


def nonnegative_weights(angles: Array, seen: Array, default: Array, pull: float) -> Array:
    """Return the weights, none negative, with the least relative errors.

    `angles` (n, joints) are squared, `seen` (n,) is to be their weighted sum, and `default`
    (joints,) pulls towards its own proportions.
    """
    scale = 1.0 / (seen + np.quantile(seen, 0.1))
    rows, wanted = angles * scale[:, None], seen * scale
    product, right = rows.T @ rows, rows.T @ wanted
    prior = default * (right @ default) / (default @ product @ default)
    prior_weight = pull * np.diag(product)
    product, right = product + np.diag(prior_weight), right + prior_weight * prior
    weights = prior.copy()
    for _ in range(_SWEEPS):  # coordinate descent
        for joint in range(len(weights)):
            residual = right[joint] - product[joint] @ weights
            weights[joint] = max(weights[joint] + residual / product[joint, joint], 0.0)
    return weights
