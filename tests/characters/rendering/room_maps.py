"""Painted maps of a room, and the light that characters in it have, exactly."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, replace
from unittest.mock import patch

import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.model.mesh import Material
from cubeling.characters.rendering import CameraView, Quality, Stage, target
from cubeling.characters.rendering.camera_picture.light import (
    LINEAR_FROM_SRGB,
    TO_LIGHT,
    Light,
    LightEstimator,
)
from cubeling.characters.rendering.environment.cube_map import directions
from cubeling.characters.skeleton.pose import Array
from tests.characters.rendering.shapes import Still, ball
from tests.characters.rendering.watch import WatchPass

UNIT = directions(64)
"""Directions of the texels of a map."""

WHITE = np.ones((len(UNIT), 3))
"""White light from everywhere."""


@dataclass(frozen=True)
class Painted:
    """A map of the room, `RoomMap`."""

    planes: NDArray[np.uint8]
    centre: Array
    reach: float = 1.0


def painted(light: Array) -> Painted:
    """Return a map of linear light, (texels, 3) RGB."""
    values = np.rint(np.interp(light, LINEAR_FROM_SRGB, np.arange(256))).astype(np.uint8)
    return Painted(values.T.reshape(-1, 64), np.array([0.0, 0.08, 0.0]))


@contextmanager
def even_light() -> Iterator[None]:
    """Let stages draw without a lamp, in white light from all around, and with 32 bits."""
    white = np.ones(3)
    light = Light(0.0 * white, white, white, TO_LIGHT)
    with (
        patch.object(LightEstimator, "update", lambda *given: light),
        patch.object(
            target, "_texture", lambda context, size: context.texture(size, 4, dtype="f4")
        ),
    ):
        yield


def light_of_ball(
    context: moderngl.Context, view: CameraView, quality: Quality, material: Material, room: Painted
) -> tuple[Array, NDArray[np.bool_]]:
    """Return the light of a ball over the table, (rows, columns, 3), and where it is; see above."""
    assert view.image is not None
    stage, watch = Stage(context, view.image.shape[1::-1]), WatchPass()
    stage.quality = quality
    stage.passes.append(watch)
    # Above what counts as near the table.
    shape = Still((ball(material, at=(0.0, 0.08, 0.0), radius=0.04),))
    stage.draw(replace(view, room=room), [shape.posed()])
    layer = watch.frame.layer
    assert layer is not None
    columns, rows = layer.texels
    data = layer.target.framebuffer.read((0, 0, columns, rows), components=4, dtype="f4")
    stage.release()
    texels = np.frombuffer(data, np.float32).reshape(rows, columns, 4)
    return _linear(texels[..., 2::-1]), texels[..., 3] > 0


def _linear(shown: NDArray[np.float32]) -> Array:
    """Return the light that is shown as a value, 0…1: the inverse of encoding.glsl."""
    light = np.linspace(0.0, 1.3, 4000)
    shoulder = light * 1.06 / (1.0 + 0.12 * light)
    root = np.sqrt(shoulder)
    value = 0.82443678 * root + 0.30650353 * np.sqrt(root) - 0.05245525 * shoulder - 0.07884886
    return np.interp(shown, value, light)
