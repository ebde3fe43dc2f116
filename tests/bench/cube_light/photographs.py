"""Light measured on photographs of a dodecahedron, whose true light is not known."""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cubeling.tracking.appearance.light import DEFAULT_UP
from cubeling.tracking.appearance.light_fit import fit_patches
from cubeling.tracking.appearance.patches import PaperSampler
from cubeling.tracking.geometry.projection import Projection
from tests.bench.photographs.dodecahedron import (
    SIDE,
    body_model,
    camera,
    photograph,
    reference,
)

Array = NDArray[np.float64]
Floats = NDArray[np.float32]
Picture = NDArray[np.uint8]

GLARE_PX = (710.0, 662.0)
"""Where the table of the photographs mirrors a lamp."""


@dataclass(frozen=True)
class RealLight:
    """The light in the photographs of the dodecahedron, whose camera stands still."""

    patches: int
    """Faces measured in all pictures."""

    halves_deg: float
    """Angle between the directions that the first and the second half of the pictures give."""

    glare_deg: float
    """Angle to the direction that the glare on the table tells, one lamp of perhaps several."""

    unexplained: float
    """Median difference of a patch from the model of the other half, as a share of the mean."""

    by_constant: float
    """The same from the mean of the other half."""

    certainty: float
    """By all pictures."""


def real_light() -> RealLight:
    """Measure the light in photographs that we did not make."""
    body, body_from_cube = body_model()
    # The faces are pentagons: only a little of the margin is sure to be paper.
    cube = replace(body, edge=1.2 * SIDE)
    sampler = PaperSampler(cube, camera())
    found = [
        sampler.measure(photograph(number), pose @ body_from_cube)
        for number, pose in reference().camera_from_body.items()
    ]
    halves = [found[: len(found) // 2], found[len(found) // 2 :]]
    normals, values = (
        [np.concatenate([getattr(p, name) for p in half]) for half in halves]
        for name in ("normals", "irradiance")
    )
    lights = [
        fit_patches(n, v, np.ones(len(n)), DEFAULT_UP) for n, v in zip(normals, values, strict=True)
    ]
    whole = fit_patches(
        np.concatenate(normals), np.concatenate(values), np.ones(sum(map(len, values))), DEFAULT_UP
    )
    errors, constants = [], []
    for one, other in ((0, 1), (1, 0)):
        light = lights[one]
        model = light.ambient + np.maximum(normals[other] @ light.to_light, 0)[:, None] * light.key
        errors.append(np.abs((values[other] - model).mean(axis=1)))
        constants.append(np.abs((values[other] - values[one].mean(axis=0)).mean(axis=1)))
    mean = float(np.concatenate(values).mean())
    return RealLight(
        len(np.concatenate(normals)),
        between_deg(lights[0].to_light, lights[1].to_light),
        between_deg(whole.to_light, glare()),
        float(np.median(np.concatenate(errors))) / mean,
        float(np.median(np.concatenate(constants))) / mean,
        whole.certainty,
    )


def glare() -> Array:
    """Direction to the lamp that the table of the photographs mirrors, by hand-picked pixels, (3,).

    The table's normal follows from the vanishing points of the sheet of paper on it.
    """
    corners = np.array([(549, 314), (772, 314), (811, 456), (544, 456)], float)
    a, b, c, d = np.c_[Projection(camera()).rays(corners), np.ones(4)]
    along = np.cross(np.cross(a, b), np.cross(d, c)), np.cross(np.cross(a, d), np.cross(b, c))
    up = np.cross(*along)
    up *= -np.sign(up[1]) / np.linalg.norm(up)
    sight = np.append(Projection(camera()).rays(np.array([GLARE_PX], float))[0], 1.0)
    sight /= np.linalg.norm(sight)
    return np.asarray(sight - 2 * (sight @ up) * up)


def between_deg(a: Array, b: Array) -> float:
    """Return the angle between two directions [deg]."""
    return float(np.rad2deg(np.arccos(np.clip(a @ b, -1, 1))))
