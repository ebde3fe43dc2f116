"""Fitting ambient light and one direction to patches of paper."""

import numpy as np

from cubeling.tracking.appearance.appearance import MeasuredLight
from cubeling.tracking.geometry import se3
from cubeling.tracking.geometry.arrays import Array

PRIOR_CONCENTRATION = 1.5
"""How much likelier light comes from above than from elsewhere: as von Mises and Fisher's κ."""

CAMERA_SIDE = 0.34
"""How far the expected light leans to the camera's side, beside 1 upwards."""

EXPECTED_AMBIENT_SHARE, AMBIENT_SHARE_SPREAD = 0.5, 0.3
"""Share of the light from all around before anything is measured, and its standard deviation."""

IRRADIANCE_ERROR = 0.035
"""Standard deviation of a patch's light from the model, as a share of the mean light: light from
the table and the hand, vignetting, and paper that is not flat."""

GROUND_SHARES = (1.0, 0.7, 0.4)
"""Light from all around on a surface that faces down, beside one that faces up: which of them holds
is not known before, and moves the direction that a face's light tells by up to 17°."""

OTHER_LIGHT = 0.15
"""Error of the direction that other lamps, walls and near light make where the key light is as
strong as that from all around [rad]."""

INDEPENDENT_PATCHES = 8.0
"""How many independent measurements many patches make at most: neighbours share their errors."""

SHADOW_SHARE = 0.11
"""A patch darker than its model by this share of the mean light is in a shadow."""

MAX_REFITS, MIN_LIT_PATCHES = 2, 4
"""How often the light is fitted again without such patches; and fewer than this cannot tell that
another one is in a shadow."""


def sphere(count: int) -> Array:
    """Return directions that are spread evenly, (count, 3): a Fibonacci lattice.

    >>> bool(np.abs(sphere(100).mean(axis=0)).max() < 0.01)
    True
    """
    number = np.arange(count) + 0.5
    z, angle = 1 - 2 * number / count, np.pi * (1 + np.sqrt(5)) * number
    radius = np.sqrt(1 - z * z)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)


def _disc() -> Array:
    """Return points in the unit disc: the middle and three rings, (37, 2)."""
    rings = [np.arange(6 * n) * np.pi / (3 * n) for n in (1, 2, 3)]
    points = [np.stack([np.cos(a), np.sin(a)], axis=1) * n / 3 for n, a in enumerate(rings, 1)]
    return np.concatenate([np.zeros((1, 2)), *points])


DIRECTIONS, DISC = sphere(128), _disc()
"""Directions that a light is searched in, and how the best one is refined."""

REFINED_SPREADS, MIN_REFINED, MAX_REFINED = 2.5, np.radians(12.0), np.radians(50.0)
"""How far around the mean direction it is refined, in standard deviations, and the least and the
most of it [rad]: no less than the distance of two directions, and only where one is the best."""


def fit_patches(normals: Array, irradiance: Array, weights: Array, up: Array) -> MeasuredLight:
    """Fit the light to patches; those that turn out to be in a shadow count for nothing.

    Parameters
    ----------
    normals, irradiance, weights
        Of each patch: unit normal, (N, 3); linear RGB, (N, 3); and weight 0…1, (N,).
    up
        Unit vector away from the ground, (3,).
    """
    log_prior = _prior(up)
    around = ground_light(normals, up)
    light, darker = fit_light(normals, irradiance, weights, log_prior, around)
    for _ in range(MAX_REFITS):
        shadowed = darker > SHADOW_SHARE
        if not shadowed.any() or len(shadowed) - shadowed.sum() < MIN_LIT_PATCHES:
            break
        light, darker = fit_light(normals, irradiance, weights * ~shadowed, log_prior, around)
    return light


def ground_light(normals: Array, up: Array) -> Array:
    """Return the light from all around on patches for each of `GROUND_SHARES`, (shares, N).

    As a share of its mean over all directions.
    """
    shares = np.array(GROUND_SHARES)[:, None]
    return np.asarray(1 + (1 - shares) / (1 + shares) * (normals @ up), np.float64)


def fit_light(
    normals: Array, irradiance: Array, weights: Array, log_prior: Array, around: Array
) -> tuple[MeasuredLight, Array]:
    """Fit ambient light and one direction to patches.

    The likelihood of each direction on a grid follows by non-negative least squares of ambient and
    key light; the result is the mean, first over the sphere, then around the best.

    Parameters
    ----------
    normals, irradiance, weights
        Of each patch: unit normal, (N, 3); linear RGB, (N, 3); and weight 0…1, (N,).
    log_prior
        Gradient of the log of the prior likelihood by the direction, (3,).
    around
        Light from all around on each patch, as a share of its mean, in some ways in which it may
        differ, (ways, N): the result is the mean over them, too.

    Returns
    -------
    The light, and how much darker each patch is than its model, as a share of the mean light, (N,).
    """
    total = float(weights.sum())
    mean = max(float(weights @ irradiance.sum(axis=1)) / (3 * total), 1e-6)
    independent = min(1.0, INDEPENDENT_PATCHES / total)
    scaled = irradiance / mean
    directions = DIRECTIONS
    for _ in range(2):
        lit = np.maximum(normals @ directions.T, 0)
        cost, ambients, keys = _least_squares(lit, around, scaled, weights)
        variance = max(IRRADIANCE_ERROR**2, float(cost.min()) / (3 * max(total - 2, 1.0)))
        log = directions @ log_prior - cost * (independent / (2 * variance))
        likely = np.exp(log - log.max())
        likely /= likely.sum()
        centre = likely.sum(axis=0) @ directions
        length = float(np.sqrt(centre @ centre))
        to_light = centre / max(length, 1e-9)
        ambient = np.einsum("ag,agc->c", likely, ambients)
        key = np.einsum("ag,agc->c", likely, keys)
        spread = float(np.sqrt(2 * max(1 - length, 0)))
        radius = max(REFINED_SPREADS * spread, MIN_REFINED)
        if radius > MAX_REFINED:
            break
        directions = _around(to_light, radius)
    # What else is in a room turns the direction by a share of the rest of the light.
    other = OTHER_LIGHT * float(ambient.sum()) / max(float(key.sum()), 1e-9)
    certainty = float(np.clip(1 - np.hypot(spread, other) / _prior_spread(log_prior), 0, 1))
    model = around.T @ np.einsum("ag,agc->ac", likely, ambients)
    model += lit @ np.einsum("ag,agc->gc", likely, keys)
    darker = (model - scaled).mean(axis=1)
    return MeasuredLight(to_light, key * mean, ambient * mean, certainty), darker


def _least_squares(
    lit: Array, around: Array, values: Array, weights: Array
) -> tuple[Array, Array, Array]:
    """Fit ambient and key light, both at least 0, for each way of light from around and direction.

    `lit` are the cosines of patches and directions, at least 0, (N, G), `around` the light from all
    around on patches, as a share of its mean, (ways, N), `values` (N, 3), `weights` (N,).
    Returns the weighted sum of squares (ways, G), ambient and key light (ways, G, 3).
    """
    weighted = weights[:, None] * values
    # What is expected of the ambient share is one more measurement, of a weight next to nothing.
    share, trust = EXPECTED_AMBIENT_SHARE, (IRRADIANCE_ERROR / (2 * AMBIENT_SHARE_SPREAD)) ** 2
    weighted_around = weights * around
    aa = (weighted_around * around).sum(axis=1)[:, None, None] + trust * (1 - share) ** 2
    ak = (weighted_around @ lit)[:, :, None] - trust * share * (1 - share)
    kk = (weights @ (lit * lit))[:, None] + trust * share**2
    a, k = (around @ weighted)[:, None], lit.T @ weighted
    key = (aa * k - ak * a) / (aa * kk - ak * ak)
    key = np.where(ak * key > a, k / kk, np.maximum(key, 0))  # no negative ambient light
    ambient = np.maximum(a - ak * key, 0) / aa
    cost = aa * ambient**2 + 2 * ak * ambient * key + kk * key**2 - 2 * (ambient * a + key * k)
    return cost.sum(axis=2) + float((weighted * values).sum()), ambient, key


def _around(centre: Array, radius: float) -> Array:
    """Return directions around one, up to `radius` [rad] from it, (37, 3)."""
    side = np.eye(3)[np.abs(centre).argmin()]
    right = se3.cross(centre[None], side[None])[0]
    right /= np.sqrt(right @ right)
    down = se3.cross(centre[None], right[None])[0]
    around = centre + DISC * np.tan(radius) @ np.stack([right, down])
    return np.asarray(around / np.sqrt((around * around).sum(axis=1))[:, None], np.float64)


def _prior(up: Array) -> Array:
    """Gradient of the log of the prior likelihood by the direction, (3,)."""
    towards = np.array([0.0, 0.0, -1.0]) + up[2] * up  # horizontally to the camera
    lean = up + CAMERA_SIDE * towards / max(float(np.sqrt(towards @ towards)), 0.1)
    return np.asarray(PRIOR_CONCENTRATION * lean / np.sqrt(lean @ lean), np.float64)


def _prior_spread(log_prior: Array) -> float:
    """Spread of directions before anything is measured [rad]."""
    kappa = float(np.sqrt(log_prior @ log_prior))
    return float(np.sqrt(2 * (1 - (1 / np.tanh(kappa) - 1 / kappa))))
