"""Models as VRM describes them, made of a character's T-pose: skeletons, and files of them."""

import json
import struct
from pathlib import Path

import numpy as np

from cubeling.characters import Character
from cubeling.characters.model import TPoseBones
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose, Skeleton

AXES_SEED = 1
"""Seed of the axes of `raw_model`."""


def normalised_model(character: Character, arms: float = 1.0, legs: float = 1.0) -> Skeleton:
    """Return a model as VRM 0 has it: in a T-pose, no bone turned, of other proportions."""
    bones = TPoseBones(character)
    offsets = bones.offsets.copy()
    for bone, part in enumerate(bones.parts):
        if part.endswith(("LowerArm", "Hand")):
            offsets[bone] *= arms
        if part.endswith(("LowerLeg", "Foot")) or part == "hips":
            offsets[bone] *= legs
    rest = Pose(offsets, np.tile(rotations.IDENTITY, (len(offsets), 1)))
    return Skeleton(bones.parts, bones.parents, rest)


def raw_model(character: Character, arms: float, legs: float) -> Skeleton:
    """Return the same as VRM 1.0 may have it: each bone has axes of its own."""
    plain = normalised_model(character, arms, legs)
    world = np.random.default_rng(AXES_SEED).normal(size=(len(plain), 4))
    world /= np.linalg.norm(world, axis=-1, keepdims=True)
    places = plain.rest.globals(plain)[:, :3, 3]
    turns, offsets = world.copy(), places.copy()
    for joint, parent in enumerate(plain.parents):
        if parent >= 0:
            above = rotations.conjugate(world[parent])
            turns[joint] = rotations.multiply(above, world[joint])
            offsets[joint] = rotations.rotate(above, places[joint] - places[parent])
    return Skeleton(plain.names, plain.parents, Pose(offsets, turns))


def write_vrm(skeleton: Skeleton, path: Path, version: str) -> None:
    """Write a model whose joints have VRM 1.0's names, without a mesh, as VRM "0.0" or "1.0".

    One of VRM 0 looks along −z: `skeleton` must have no turned bones then.
    """
    old = version == "0.0"
    axes = np.array([-1.0, 1.0, -1.0]) if old else np.ones(3)
    nodes = [
        {
            "name": name,
            "translation": (skeleton.rest.translations[joint] * axes).tolist(),
            "rotation": skeleton.rest.rotations[joint].tolist(),
            "children": [child for child, above in enumerate(skeleton.parents) if above == joint],
        }
        for joint, name in enumerate(skeleton.names)
    ]
    for node in nodes:
        if not node["children"]:
            del node["children"]
    numbers = {name: joint for joint, name in enumerate(skeleton.names)}
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [joint for joint, p in enumerate(skeleton.parents) if p < 0]}],
        "nodes": nodes,
        **(_vrm_0(numbers) if old else _vrm_1(numbers)),
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(
        struct.pack("<4sII", b"glTF", 2, 20 + len(text))
        + struct.pack("<I4s", len(text), b"JSON")
        + text
    )


def _vrm_0(numbers: dict[str, int]) -> dict[str, object]:
    thumbs = {"Metacarpal": "Proximal", "Proximal": "Intermediate", "Distal": "Distal"}
    bones = []
    for name, node in numbers.items():
        side, thumb, joint = name.partition("Thumb")
        bones.append({"bone": f"{side}Thumb{thumbs[joint]}" if thumb else name, "node": node})
    vrm = {
        "exporterVersion": "cubeling",
        "specVersion": "0.0",
        "meta": {"title": "model"},
        "humanoid": {"humanBones": bones},
        "firstPerson": {},
        "blendShapeMaster": {"blendShapeGroups": []},
        "secondaryAnimation": {"boneGroups": [], "colliderGroups": []},
        "materialProperties": [],
    }
    return {"extensionsUsed": ["VRM"], "extensions": {"VRM": vrm}}


def _vrm_1(numbers: dict[str, int]) -> dict[str, object]:
    vrm = {
        "specVersion": "1.0",
        "meta": {
            "name": "model",
            "authors": ["cubeling"],
            "licenseUrl": "https://vrm.dev/licenses/1.0/",
        },
        "humanoid": {"humanBones": {name: {"node": node} for name, node in numbers.items()}},
    }
    return {"extensionsUsed": ["VRMC_vrm"], "extensions": {"VRMC_vrm": vrm}}
