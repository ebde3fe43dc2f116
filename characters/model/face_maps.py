"""Face maps: what skin does beyond its shape, as pictures in the texture coordinates of a head.

Twelve wrinkle layers (Huang, *3D emotional rendering and animation models*, 2013, Table 4.1), and
where blood shows. A table of the sidecar file names the folder of the pictures:

    [face]
    maps = "me_face"        # the folder, beside the sidecar file
    depth_mm = 2.0          # height of white above mid-grey
    meshes = ["Head"]       # left out: every mesh with texture coordinates
    scattering = 1.0        # how far light spreads below it, 1 as in human skin, 0 not at all

A picture of a layer is grey: 128 is skin at rest, darker a groove, lighter a bulge. In `blood.png`,
white is where skin flushes most. A picture that is left out is empty.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.model.mesh import FaceMaps, Mesh
from cubeling.files import FileKind
from cubeling.toml_file import TomlTable

WRINKLE_LAYERS: Mapping[int, tuple[int, ...]] = {
    1: (0,),
    2: (1, 2),
    4: (3,),
    6: (4, 5),
    10: (6, 7),
    12: (8, 9),
    20: (10, 11),
}
"""Layers of each action unit; of two layers, the first is the left side (Huang 2013, Table 4.1)."""

LAYER_NAMES = tuple(
    f"au{unit}" + ("" if len(layers) == 1 else side)
    for unit, layers in WRINKLE_LAYERS.items()
    for side in ("_left", "_right")[: len(layers)]
)
"""Names of the pictures of the layers, without suffix, in the order of the layers."""

BLOOD_NAME = "blood"
"""Name of the picture of where blood shows."""

SUFFIX = ".png"
"""Ending of the files beside the table."""

DEPTH_MM = 1.0
"""Height of white above mid-grey where the table does not say [mm]."""

MAX_SIDE_PX = 4096
"""Pictures may be this large [px]."""

FACE_MAP_FILE = FileKind(
    "face map",
    (".png",),
    CharacterError,
    64_000_000,
    "cubeling.characters.model.face_maps:read_face_map",
)
"""A grey picture of a face's surface."""
_REST_SHARE = 128 / 255  # the grey of skin at rest


@dataclass(frozen=True)
class FaceTable:
    """The table [face] of a sidecar file."""

    maps: FaceMaps

    meshes: tuple[str, ...]
    """Names of the meshes that they are for; empty for all with texture coordinates."""

    scattering: float
    """How far light spreads below these meshes, relative to human skin."""

    def on(self, meshes: Sequence[Mesh], source: str) -> tuple[Mesh, ...]:
        """Return a character's meshes, those of this table with its maps; `source` is the file.

        Raises
        ------
        CharacterError
            There is no such mesh, or it has no texture coordinates.
        """
        able = [mesh.name for mesh in meshes if mesh.uvs is not None]
        for name in self.meshes or able[:1] or ("",):
            if name not in able:
                known = ", ".join(dict.fromkeys(able)) or "none in this character"
                raise CharacterError(
                    f"{source}: face.meshes: no mesh {name!r} with texture coordinates; there are "
                    f"{known}"
                )
        wanted = self.meshes or able
        return tuple(
            replace(
                mesh,
                material=replace(mesh.material, face=self.maps, scattering=self.scattering),
            )
            if mesh.name in wanted and mesh.uvs is not None
            else mesh
            for mesh in meshes
        )


def read_face_table(file: TomlTable, folder: Path) -> FaceTable | None:
    """Return the table [face] of a sidecar file in a folder; None if it has none.

    Raises
    ------
    CharacterError
        It has another key or value than those above, or a picture cannot be read.
    """
    if "face" not in file:
        return None
    table = file.table("face", "maps", "depth_mm", "meshes", "scattering")
    depth_m = 1e-3 * table.number("depth_mm", 0.001, 1000.0, DEPTH_MM)
    return FaceTable(
        read_face_maps(folder / table.text("maps"), depth_m),
        table.texts("meshes"),
        table.number("scattering", 0.0, default=0.0),
    )


def read_face_maps(folder: Path, depth_m: float) -> FaceMaps:
    """Return the pictures of a folder; see the top of this module for their meaning."""
    names = [name for name in (*LAYER_NAMES, BLOOD_NAME) if (folder / f"{name}{SUFFIX}").exists()]
    if not names:
        raise CharacterError(
            f"{folder}: no picture of a face in it; there may be "
            f"{', '.join(name + SUFFIX for name in (*LAYER_NAMES, BLOOD_NAME))}"
        )
    pictures = {name: read_face_map(folder / f"{name}{SUFFIX}") for name in names}
    shape = pictures[names[0]].shape
    for name, picture in pictures.items():
        if picture.shape != shape:
            raise CharacterError(
                f"{folder / name}{SUFFIX}: {picture.shape[1]}×{picture.shape[0]} px, but "
                f"{names[0]}{SUFFIX} has {shape[1]}×{shape[0]}; make all of one size"
            )
    flat = np.full(shape, _REST_SHARE, np.float32)
    heights = np.stack([pictures.get(name, flat) - flat for name in LAYER_NAMES])
    heights /= np.float32(1.0 - _REST_SHARE)
    return FaceMaps(heights, pictures.get(BLOOD_NAME, np.zeros(shape, np.float32)), depth_m)


def read_face_map(path: Path) -> NDArray[np.float32]:
    """Return a grey picture of 8 or 16 bits as shares of white, (height, width)."""
    data = np.frombuffer(FACE_MAP_FILE.read(path), np.uint8)
    read = None
    if data.size:
        read = cv2.imdecode(data, cv2.IMREAD_GRAYSCALE | cv2.IMREAD_ANYDEPTH)
    if read is None or read.dtype not in (np.uint8, np.uint16):
        raise CharacterError(f"{path}: not a picture of 8 or 16 bits; save it as PNG")
    if max(read.shape) > MAX_SIDE_PX or min(read.shape) < 2:
        raise CharacterError(f"{path}: a picture has 2 to {MAX_SIDE_PX} pixels along each side")
    white = np.float32(255.0 if read.dtype == np.uint8 else 65535.0)
    return np.asarray(read.astype(np.float32) / white, np.float32)
