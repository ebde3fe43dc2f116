"""Joints of other makers' characters stand where an independent walk over the nodes puts them."""

import json
import struct
from functools import cache

import numpy as np
import pytest

from cubeling.characters import Character
from tests.characters.formats.built_gltf import SAMPLES
from tests.examples import some

DTYPE_OF_COMPONENT = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
TYPE_WIDTHS = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}


@cache
def contents(path):
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), data[28 + length :]


def numbers(path, index):
    """An accessor as floats, one row after the other."""
    document, blob = contents(path)
    accessor = document["accessors"][index]
    view = document["bufferViews"][accessor["bufferView"]]
    wide = TYPE_WIDTHS[accessor["type"]]
    kind = np.dtype(DTYPE_OF_COMPONENT[accessor["componentType"]])
    start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
    step = view.get("byteStride", wide * kind.itemsize)
    rows = [np.frombuffer(blob, kind, wide, start + row * step) for row in range(accessor["count"])]
    return np.array(rows, float)


def value(times, values, how, time):
    """The value of a sampler at a time, after appendix C of the specification."""
    time = min(max(time, times[0]), times[-1])
    after = min(int(np.searchsorted(times, time, side="right")), len(times) - 1)
    before = max(after - 1, 0)
    span = times[after] - times[before]
    t = (time - times[before]) / span if span else 0.0
    if how == "CUBICSPLINE":
        (_, a, out), (into, b, _) = values.reshape(-1, 3, values.shape[1])[[before, after]]
        basis = [2 * t**3 - 3 * t**2 + 1, t**3 - 2 * t**2 + t, -2 * t**3 + 3 * t**2, t**3 - t**2]
        return basis[0] * a + span * basis[1] * out + basis[2] * b + span * basis[3] * into
    a, b = values[before], values[after]
    if how == "STEP":
        return b if t >= 1 else a
    if len(a) == 4:
        cosine = abs(float(a @ b))
        angle = np.arccos(min(cosine, 1.0))
        if angle > 1e-4:
            sign = np.copysign(1.0, a @ b)
            return (np.sin((1 - t) * angle) * a + sign * np.sin(t * angle) * b) / np.sin(angle)
        b = b * np.copysign(1.0, a @ b)
    return a + t * (b - a)


def matrix(translation, rotation, scale):
    x, y, z, w = np.array(rotation) / np.linalg.norm(rotation)
    turn = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    whole = np.eye(4)
    whole[:3, :3], whole[:3, 3] = np.array(turn) * scale, translation
    return whole


def walked(path, animation, time):
    """Where every node is in the scene: its name and its origin."""
    document, _ = contents(path)
    moved: dict[int, dict[str, np.ndarray]] = {}
    for channel in animation["channels"]:
        target, sampler = channel["target"], animation["samplers"][channel["sampler"]]
        if target["path"] != "weights":
            times = keys(path, sampler["input"])[:, 0]
            values = keys(path, sampler["output"])
            how = sampler.get("interpolation", "LINEAR")
            moved.setdefault(target["node"], {})[target["path"]] = value(times, values, how, time)
    origins: dict[str, np.ndarray] = {}

    def walk(number, above):
        node = document["nodes"][number]
        if "matrix" in node and number not in moved:
            own = np.array(node["matrix"]).reshape(4, 4).T
        else:
            parts = {**node, **moved.get(number, {})}
            own = matrix(
                parts.get("translation", [0, 0, 0]),
                parts.get("rotation", [0, 0, 0, 1]),
                parts.get("scale", [1, 1, 1]),
            )
        origins.setdefault(node.get("name", f"node{number}"), (above @ own)[:3, 3])
        for child in node.get("children", []):
            walk(child, above @ own)

    children = {child for node in document["nodes"] for child in node.get("children", [])}
    for root in set(range(len(document["nodes"]))) - children:
        walk(root, np.eye(4))
    return origins


keys = cache(numbers)


@pytest.mark.parametrize("path", some(SAMPLES, 2), ids=lambda path: path.stem)
def test_joint_positions_agree_with_products_of_node_matrices(path):
    character = Character.load(path)
    document, _ = contents(path)
    # Of a person's height; some of these are modelled in other units than metres.
    tolerance = 1e-4 * max(character.height / 1.7, 1.0)
    assert len(document["animations"]) == len(character.clips)
    for animation, clip in zip(document["animations"], character.clips.values(), strict=True):
        start = min(numbers(path, s["input"]).min() for s in animation["samplers"])
        for time in np.linspace(0.003, clip.duration - 0.002, 10):
            placed = clip.sample(float(time)).globals(character.skeleton)[:, :3, 3]
            stands = walked(path, animation, start + time)
            expected = [stands[name] for name in character.skeleton.names]
            assert placed == pytest.approx(np.array(expected), abs=tolerance)
