"""The fingers of a skeleton, by the names of joints, else by the shape of the hand."""

from collections.abc import Mapping, Sequence

import numpy as np

from cubeling.characters.skeleton.body_parts.joint_tree import JointTree
from cubeling.characters.skeleton.joint_chains import longest_chain_below, longest_chain_of
from cubeling.characters.skeleton.pose import Array

_FINGERS = ("Index", "Middle", "Ring", "Little")
_THREE_FINGERS = ("Index", "Middle", "Little")
_FINGER_PARTS: tuple[str, ...] = ("Proximal", "Intermediate", "Distal")
_THUMB_PARTS = ("Metacarpal", "Proximal", "Distal")
_MIN_THUMB_ANGLE_COS = 0.95  # of the thumb and the fingers, about 18°


def find_fingers(tree: JointTree, found: Mapping[str, int]) -> dict[str, int]:
    """Return the joints of the fingers of both hands; `found` are the limbs."""
    fingers: dict[str, int] = {}
    for side in ("left", "right"):
        chains = _chains_by_name(tree, side)
        hand = found.get(f"{side}Hand")
        if not chains and hand is not None:
            chains = _by_shape(tree, hand)
        for finger, chain in chains.items():
            parts = _FINGER_PARTS
            if finger == "Thumb":  # the metacarpal is seldom rigged
                parts = _THUMB_PARTS if len(chain) > 2 else _THUMB_PARTS[1:]
            fingers |= {side + finger + p: j for p, j in zip(parts, chain, strict=False)}
    return fingers


def _chains_by_name(tree: JointTree, side: str) -> dict[str, list[int]]:
    """Return the chain of each finger that names tell."""
    joints = [j for j, name in enumerate(tree.names) if name.finger and tree.side(j) == side]
    chains = {
        finger: longest_chain_of([j for j in joints if tree.names[j].finger == finger], tree.chains)
        for finger in ("Thumb", *_FINGERS)
    }
    return {finger: chain for finger, chain in chains.items() if chain}


def _by_shape(tree: JointTree, hand: int) -> dict[str, list[int]]:
    """Return the chain of each finger of a hand with a thumb and three or four fingers.

    The thumb begins nearest to the wrist, at one edge of the hand, and points elsewhere.
    """
    chains = [
        [joint for joint in longest_chain_below(child, tree.children) if not tree.names[joint].end]
        for child in tree.children.get(hand, ())
        if not tree.names[child].auxiliary
    ]
    chains = [chain for chain in chains if len(chain) > 1]
    if len(chains) not in (4, 5):
        return {}
    bases = tree.positions[[chain[0] for chain in chains]] - tree.positions[hand]
    ways = _units(tree.positions[[chain[-1] for chain in chains]] - bases - tree.positions[hand])
    along = _units(ways.sum(0)[None])[0]
    order = _across(bases, along)
    if bases[order[0]] @ along > bases[order[-1]] @ along:
        order = order[::-1]
    thumb, *fingers = order
    others = _units(ways[fingers].sum(0)[None])[0]
    if len(chains) == 4 and float(ways[thumb] @ others) > _MIN_THUMB_ANGLE_COS:
        return {}
    names = _FINGERS if len(fingers) == 4 else _THREE_FINGERS
    return {"Thumb": chains[thumb]} | {
        name: chains[finger] for name, finger in zip(names, fingers, strict=True)
    }


def _across(bases: Array, along: Array) -> Sequence[int]:
    """Return the order of fingers across a hand, from their bases (n, 3)."""
    level = bases - (bases @ along)[:, None] * along
    level -= level.mean(0)
    across = np.linalg.svd(level)[2][0]
    return [int(number) for number in np.argsort(level @ across)]


def _units(vectors: Array) -> Array:
    lengths = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return np.asarray(vectors / np.maximum(lengths, 1e-9))
