"""Vleo's markings with crisp edges: spots, cheeks, nostrils, plates and claws."""

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.lathe import circle_profile, frame_toward, lathe
from tools.authoring.vleo.body import CLAW, LASH, ORANGE, PINK, SPOT, spine_line
from tools.authoring.vleo.pieces import attached, patches
from tools.authoring.vleo.skin import SkinSurface

SPOTS_MM = (  # x, y, z, radius [mm]; mirrored unless x is 0
    (0, 300, 100, 11), (23, 292, 88, 8), (17, 280, 62, 9), (0, 262, 55, 8),
    (30, 200, 78, 7), (21, 176, 62, 8), (33, 150, 40, 9),
    (35, 166, 14, 10), (52, 132, 22, 7), (47, 148, -14, 11), (26, 172, -8, 7),
    (33, 158, -38, 9), (53, 118, -32, 8), (40, 128, -62, 9), (22, 138, -72, 7),
    (26, 112, -94, 7), (17, 104, -124, 6), (13, 96, -156, 5), (10, 96, -188, 4),
)  # fmt: skip
PLATE_COUNT = 13
"""Number of plates along the back."""
PLATE_SCALE = np.array([0.62, 1.22, 1.15])
"""Thickness, length and height of a plate, relative to a cone."""


def markings(body: SkinSurface, bound: Skeleton) -> list[Mesh]:
    """Return all markings, bound to the skeleton."""
    return [*_round(body, bound), *_spines(body, bound), *_claws(1.0, bound), *_claws(-1.0, bound)]


def _round(body: SkinSurface, bound: Skeleton) -> list[Mesh]:
    """Return the round patches of colour: cheeks, nostrils and the spots on the back."""
    cheek = (62.0, 233.0, 133.0, 9.5)
    nostril = (13.0, 242.0, 193.0, 3.3)
    rows = [(cheek, PINK), (nostril, LASH), *((spot, SPOT) for spot in SPOTS_MM)]
    both = [
        ((side * x, *rest), color)
        for (x, *rest), color in rows
        for side in (1, -1)
        if x or side > 0
    ]
    places = np.array([row for row, _ in both]) / 1000
    return patches(places[:, :3], places[:, 3], [color for _, color in both], body, bound)


def _spines(body: SkinSurface, bound: Skeleton) -> list[Mesh]:
    """Return a row of soft orange plates from the neck to the tail."""
    line = spine_line(200)
    along = np.gradient(line[:, :3], axis=0)
    along /= np.linalg.norm(along, axis=1, keepdims=True)
    spines = []
    for share in np.linspace(0.06, 0.90, PLATE_COUNT):
        i = round(share * 199)
        up = np.array([0.0, along[i, 2], -along[i, 1]])
        size = 0.0045 + 0.0085 * np.sin(np.pi * share) ** 0.8
        profile = size * np.array(
            [[0, -0.5], [1, -0.45], [0.95, 0.30], [0.66, 0.92], [0.28, 1.32], [0, 1.44]]
        )
        lean = up - 0.35 * along[i]
        place = frame_toward(lean / np.linalg.norm(lean), line[i, :3] + up * (line[i, 3] - 0.001))
        place[:3, :3] = place[:3, :3] @ np.diag(PLATE_SCALE)
        cone = lathe(profile, [ORANGE] * 5, place, "hips", bound, 10)
        base = np.tile(line[i, :3] + up * line[i, 3], (len(cone.positions), 1))
        spines.append(attached(cone, base, body))
    return spines


def _claws(side: float, bound: Skeleton) -> list[Mesh]:
    """Return three claws on each foot of one side."""
    name = "Left" if side > 0 else "Right"
    claws = []
    for which, x, z in (("Front", 0.043, 0.060), ("Hind", 0.045, -0.048)):
        for across, ahead in ((-0.0150, 0.0205), (0.0, 0.0268), (0.0150, 0.0205)):
            rings = 0.0066 * circle_profile(np.radians([180, 120, 75, 40, 0]))
            place = frame_toward(
                np.array([side * across * 20, -0.1, 1.0]),
                np.array([side * (x + across), 0.0072, z + ahead]),
            )
            claws.append(lathe(rings, [CLAW] * 4, place, f"{name}{which}Foot", bound, 8))
    return claws
