"""The robot's body: a trunk of two shells, neck, tail and legs of cups, and lamps."""

from itertools import pairwise

import numpy as np

from cubeling.characters.model.mesh import Mesh
from cubeling.characters.skeleton.pose import Skeleton
from tools.authoring.modelling.lathe import circle_profile, frame_toward, lathe
from tools.authoring.modelling.rig import rest_positions
from tools.authoring.modelling.sculpt import BodyPart, sculpt
from tools.authoring.modelling.shapes import Array, Difference, Ellipsoid, HalfSpace, Vector
from tools.authoring.modelling.surface import normals_of, project
from tools.authoring.modelling.tube import tube
from tools.authoring.robot.parts import (
    PANEL,
    RUBBER,
    SHELL,
    TRIM,
    cup,
    lens,
    panel,
    servo_cap,
    socket,
)
from tools.authoring.robot.rig import FEET, NECK, TAIL, TAIL_TIP_M

FRONT_SHELL = Ellipsoid(
    (0.0, 0.122, 0.020), (0.0560, 0.0520, 0.0600), power=2.25, bones=("chest",), color=SHELL
)
REAR_SHELL = Ellipsoid(
    (0.0, 0.117, -0.050), (0.0620, 0.0560, 0.0630), power=2.25, bones=("hips",), color=SHELL
)
WAIST_GAP_M = -0.014, 0.0045
"""Position of the gap between the two shells along z, and half its width [m]."""
CHEST_LAMP_RADIUS_M = 0.0175
"""Radius of the lamp on the chest [m]."""
CELL_M = 0.0118
"""Edge of a triangle of the trunk [m]."""


def body(bound: Skeleton) -> list[Mesh]:
    """Return the body without head and lit lamps, bound to the skeleton."""
    return [*_trunk(bound), *_cores(bound), *_neck(bound), *_tail(bound), *_legs(bound)]


def _trunk(bound: Skeleton) -> list[Mesh]:
    """Return the two shells with a plate on the back of each."""
    middle, gap = WAIST_GAP_M
    front = Difference(FRONT_SHELL, HalfSpace((0.0, 0.0, middle + gap), (0.0, 0.0, 1.0)), 0.006)
    rear = Difference(REAR_SHELL, HalfSpace((0.0, 0.0, middle - gap), (0.0, 0.0, -1.0)), 0.006)
    shells = sculpt("", [BodyPart(each, CELL_M, soft_skin=0.0) for each in (front, rear)], bound)
    plates = []
    for solid, forward, long in ((FRONT_SHELL, 0.020, 0.023), (REAR_SHELL, -0.053, 0.027)):
        back = _on(solid, (0.0, 0.2, forward), (0.0, 0.0, 1.0))
        plates.append(panel(solid, back, (0.028, long), PANEL, solid.bones[0], bound))
    return [shells, *plates]


def _on(solid: Ellipsoid, near: Vector, along: Vector) -> Array:
    """Return the frame on a shell near a point, with +z outward and +y along a direction."""
    place = project(solid.distance, np.array([near]), 0.05, 10)
    normal = normals_of(solid.distance, place, 0.004)[0]
    right = np.cross(along, normal)
    right /= np.linalg.norm(right)
    frame = np.eye(4)
    frame[:3, :3] = np.stack([right, np.cross(normal, right), normal], axis=1)
    frame[:3, 3] = place[0]
    return frame


def _cores(bound: Skeleton) -> list[Mesh]:
    """Return the dark rubber visible between shells, cups and head."""
    at = rest_positions(bound)
    waist = [[0.0, 0.118, -0.046], [0.0, 0.119, -0.030], [0.0, 0.119, -0.014]]
    waist += [[0.0, 0.120, 0.004], [0.0, 0.121, 0.022]]
    spine = ("hips", "hips", "spine1", "chest", "chest")
    neck = [at["neck1"] - [0, 0.018, 0.016], *(at[name] for name in NECK), at["head"]]
    neck += [at["head"] + [0, 0.015, 0.012]]
    tail = [at["tail1"] + [0, 0.006, 0.03], *(at[name] for name in TAIL), np.array(TAIL_TIP_M)]
    return [
        tube(waist, [0.044, 0.0505, 0.0515, 0.0500, 0.042], RUBBER, spine, bound, 18),
        tube(neck, 0.0245, RUBBER, ("chest", *NECK, "head", "head"), bound, 10),
        tube(
            tail,
            [0.026, 0.026, 0.0215, 0.017, 0.013, 0.0095, 0.008],
            RUBBER,
            ("hips", *TAIL, TAIL[-1]),
            bound,
            8,
        ),
    ]


def _neck(bound: Skeleton) -> list[Mesh]:
    """Return three cups, wider at the foot of the neck."""
    at = rest_positions(bound)
    ends = [*(at[name] for name in NECK), at["head"]]
    radii = ((0.0340, 0.0315), (0.0312, 0.0298), (0.0298, 0.0292))
    cups = []
    for (a, b), each, name in zip(pairwise(ends), radii, NECK, strict=True):
        cups.append(cup(a + 0.10 * (b - a), a + 0.86 * (b - a), each, SHELL, name, bound))
    return cups


def _tail(bound: Skeleton) -> list[Mesh]:
    """Return five cups, increasingly thin and alternately light and blue."""
    at = rest_positions(bound)
    ends = [*(at[name] for name in TAIL), np.array(TAIL_TIP_M)]
    radii = (0.0375, 0.0315, 0.0258, 0.0205, 0.0158, 0.0122)
    cups = []
    for number, ((a, b), name) in enumerate(zip(pairwise(ends), TAIL, strict=True)):
        color = PANEL if number % 2 else SHELL
        low, high = a + 0.05 * (b - a), a + 0.86 * (b - a)
        each = radii[number], 0.35 * radii[number] + 0.65 * radii[number + 1]
        cups.append(cup(low, high, each, color, name, bound, 14))
    return cups


def _legs(bound: Skeleton) -> list[Mesh]:
    """Return the four legs: two cups, a dark knee, a foot with toes, and the cap of a servo."""
    at, pieces = rest_positions(bound), []
    for foot in FEET:
        side, which = (1.0 if foot.startswith("Left") else -1.0), foot[:-4]
        hip, knee = f"{which}UpperLeg", f"{which}LowerLeg"
        wide = 0.0270 if "Front" in foot else 0.0300
        top, low = at[hip] + [-0.002 * side, 0.004, 0], at[knee] + 0.22 * (at[hip] - at[knee])
        shin = at[knee] + 0.16 * (at[foot] - at[knee])
        servo = frame_toward([side, 0.10, 0], at[hip] + [side * (wide - 0.002), 0, 0])
        pieces += [
            cup(low, top, (wide - 0.004, wide), SHELL, hip, bound, dome=True),
            _ball(at[knee], wide - 0.0065, knee, bound),
            cup(at[foot] + [0, 0.004, 0], shin, (wide - 0.0030, wide - 0.0050), PANEL, knee, bound),
            servo_cap(servo, 0.0150, hip, bound),
            *_foot(at[foot] * [1, 0, 1] + [0, 0, 0.008], wide, foot, bound),
        ]
    return pieces


def _ball(place: Array, radius: float, joint: str, bound: Skeleton) -> Mesh:
    rings = radius * circle_profile(np.radians([180, 135, 90, 45, 0]))
    return lathe(rings, [RUBBER] * 4, frame_toward([1.0, 0, 0], place), joint, bound, 10)


def _foot(place: Array, wide: float, joint: str, bound: Skeleton) -> list[Mesh]:
    """Return a round foot on a rubber sole, with three toes."""
    profile = np.array(
        [[0, 0], [0.94, 0], [1, 0.16], [1, 0.30], [0.93, 0.62], [0.62, 0.95], [0, 1]]
    )
    frame = frame_toward([0.0, 1.0, 0.0], place)
    frame[:3, :3] = frame[:3, :3] @ np.diag([wide * 1.02, wide * 1.16, 0.0310])
    pieces = [lathe(profile, [RUBBER] * 3 + [SHELL] * 3, frame, joint, bound, 16)]
    for across in (-0.5, 0.0, 0.5):
        way = np.array([np.sin(across), 0.0, np.cos(across)])
        toe = place + wide * way * [0.98, 0, 1.08] + [0, 0.0115, 0]
        dome = 0.0064 * np.array([[0, -1], [0.9, -0.6], [1, 0], [0.7, 0.7], [0, 1]])
        pieces.append(lathe(dome, [TRIM] * 4, frame_toward(way, toe), joint, bound, 6))
    return pieces


def sockets(bound: Skeleton) -> list[Mesh]:
    """Return the unlit lamps of chest and tail."""
    return [
        socket(_chest_lamp(), CHEST_LAMP_RADIUS_M, "chest", bound),
        socket(_tail_lamp(), 0.0140, TAIL[-1], bound),
    ]


def lit_lenses(mood: str, color: Vector, bound: Skeleton) -> list[Mesh]:
    """Return the lit lamps of chest and tail."""
    bulb = 0.0168 * circle_profile(np.radians([180, 140, 100, 60, 30, 0]))
    place = _tail_lamp()
    place[:3, 3] += 0.0075 * place[:3, 2]
    return [
        lens(_chest_lamp(), CHEST_LAMP_RADIUS_M, color, f"chest_{mood}", bound),
        lathe(bulb, [color] * 5, place, f"tail_{mood}", bound, 14),
    ]


def _chest_lamp() -> Array:
    near = np.array([[0.0, 0.107, 0.085]])
    place = project(FRONT_SHELL.distance, near, 0.05, 8)
    return frame_toward(normals_of(FRONT_SHELL.distance, place, 0.004)[0], place[0])


def _tail_lamp() -> Array:
    return frame_toward([0.0, 0.42, -1.0], np.array(TAIL_TIP_M))
