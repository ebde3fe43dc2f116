"""How the eyes of a VRM follow a point: "lookAt" of VRM 1.0, "firstPerson" of VRM 0.x."""

import math

from cubeling.characters.formats.gltf.document import Json, error_context
from cubeling.characters.formats.gltf.file import GltfFile
from cubeling.characters.model.look_at import LookAt, RangeMap
from cubeling.characters.model.springs import Point

_DEFAULT_GREATEST_DEG = 90.0
_DEFAULT_TURN_DEG = 10.0
_LEAST_GREATEST_DEG = 0.01  # a smaller range would divide by zero

_MAPS = ("HorizontalInner", "HorizontalOuter", "VerticalDown", "VerticalUp")


def read_look_at(file: GltfFile) -> LookAt | None:
    """Return how the eyes of a file's character follow a point; None if it does not say so."""
    extensions = file.document.get("extensions", {})
    with error_context("lookAt"):
        if "VRMC_vrm" in extensions:
            stated = extensions["VRMC_vrm"].get("lookAt")
            return None if stated is None else _look_at_1(stated)
        stated = extensions.get("VRM", {}).get("firstPerson", {})
        return _look_at_0(stated) if "lookAtTypeName" in stated else None


def _look_at_1(stated: Json) -> LookAt:
    by_morphs = stated.get("type") == "expression"
    maps = [stated.get(f"rangeMap{name}", {}) for name in _MAPS]
    offset: Point | None = None
    if "offsetFromHeadBone" in stated:
        x, y, z = stated["offsetFromHeadBone"]
        offset = x, y, z
    return _look_at(
        by_morphs, [(each.get("inputMaxValue"), each.get("outputScale")) for each in maps], offset
    )


def _look_at_0(stated: Json) -> LookAt:
    by_morphs = stated["lookAtTypeName"] == "BlendShape"
    maps = [stated.get(f"lookAt{name}", {}) for name in _MAPS]
    offset: Point | None = None
    if "firstPersonBoneOffset" in stated:
        place = stated["firstPersonBoneOffset"]
        # Its coordinates are those of Unity, whose z is the other way round.
        offset = place.get("x", 0.0), place.get("y", 0.0), -place.get("z", 0.0)
    return _look_at(by_morphs, [(each.get("xRange"), each.get("yRange")) for each in maps], offset)


def _look_at(
    by_morphs: bool, maps: list[tuple[float | None, float | None]], offset: Point | None
) -> LookAt:
    """Return it for the greatest angle and the output of the inner, outer, lower and upper map."""
    read: list[RangeMap] = []
    for greatest, output in maps:
        limit = _DEFAULT_GREATEST_DEG if greatest is None else max(greatest, _LEAST_GREATEST_DEG)
        if by_morphs:
            most = 1.0 if output is None else output
        else:
            most = math.radians(_DEFAULT_TURN_DEG if output is None else output)
        read.append(RangeMap(math.radians(limit), most))
    inner, outer, down, up = read
    return LookAt("expression" if by_morphs else "bone", inner, outer, down, up, offset)
