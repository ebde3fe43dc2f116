"""Small skeletons of people and animals for tests, named as the world's programs name them."""

import numpy as np

from cubeling.characters import Pose, Skeleton
from cubeling.characters.skeleton import rotations

# Parents and rest places, left side only. A part that begins with a capital has two sides.
PERSON = {
    "hips": ("", (0, 1, 0)),
    "spine": ("hips", (0, 1.1, 0)),
    "chest": ("spine", (0, 1.3, 0)),
    "neck": ("chest", (0, 1.5, 0)),
    "head": ("neck", (0, 1.6, 0)),
    "Shoulder": ("chest", (0.05, 1.45, 0)),
    "UpperArm": ("Shoulder", (0.2, 1.45, 0)),
    "LowerArm": ("UpperArm", (0.45, 1.45, 0)),
    "Hand": ("LowerArm", (0.7, 1.45, 0)),
    "UpperLeg": ("hips", (0.1, 0.95, 0)),
    "LowerLeg": ("UpperLeg", (0.1, 0.5, 0)),
    "Foot": ("LowerLeg", (0.1, 0.1, 0)),
    "Toes": ("Foot", (0.1, 0.03, 0.1)),
}
DOG = {
    "hips": ("", (0, 0.6, -0.4)),
    "spine": ("hips", (0, 0.62, 0)),
    "neck": ("spine", (0, 0.7, 0.3)),
    "head": ("neck", (0, 0.85, 0.45)),
    "tail1": ("hips", (0, 0.6, -0.5)),
    "tail2": ("tail1", (0, 0.55, -0.6)),
    "UpperLeg": ("hips", (0.1, 0.55, -0.4)),
    "LowerLeg": ("UpperLeg", (0.1, 0.35, -0.3)),
    "Foot": ("LowerLeg", (0.1, 0.18, -0.45)),
    "Toes": ("Foot", (0.1, 0.03, -0.4)),
    "FrontShoulder": ("spine", (0.07, 0.6, 0.2)),
    "FrontUpperLeg": ("FrontShoulder", (0.1, 0.45, 0.25)),
    "FrontLowerLeg": ("FrontUpperLeg", (0.1, 0.3, 0.15)),
    "FrontFoot": ("FrontLowerLeg", (0.1, 0.12, 0.18)),
    "FrontToes": ("FrontFoot", (0.1, 0.03, 0.22)),
}


def named_body(style, tree):
    """A body, and its right joint names by part.

    A style is the words for left and right, then a name for each part of the tree with {} for the
    side, "-" where it has none. Helper joints follow: "a<b" is a below b, "a>b" is a between b and
    its parent, "a>b@" too but at the origin, "a<b@Foot" is a below b at the place of the foot.
    """
    left, right, *names = style.split()
    names, helpers = names[: len(tree)], names[len(tree) :]
    named = dict(zip(tree, names, strict=True))

    def parent_of(part):
        above = tree[part][0]
        return parent_of(above) if above and named[above] == "-" else above

    joints, truth = {}, {}
    for part, name in named.items():
        for side, word, sign in (("left", left, 1), ("right", right, -1)):
            if name == "-":
                continue
            x, y, z = tree[part][1]
            above = parent_of(part)
            full = name.format(word)
            joints[full] = (named[above].format(word) if above else "", (sign * x, y, z))
            truth[side + part if part[0].isupper() else part] = full
    for helper in helpers:
        for word, sign in ((left, 1), (right, -1)):
            _add_helper(joints, helper.replace("{}", word), sign, tree)
    return skeleton_of(joints), truth


def _add_helper(joints, helper, sign, tree):
    if ">" in helper:
        name, below = helper.split(">")
        if name in joints:
            return
        below = below.removesuffix("@")
        parent, place = joints[below]
        above = joints[parent][1] if parent else place
        middle = (0.0, 0.0, 0.0) if "@" in helper else tuple(np.mean([place, above], axis=0))
        joints[name] = (parent, middle)
        joints[below] = (name, place)
        return
    name, parent = helper.split("<")
    parent, _, part = parent.partition("@")
    x, y, z = joints[parent][1] if parent else (0, 0, 0)
    place = (x, y - 0.02, z + 0.02)
    if part:
        x, y, z = tree[part][1]
        place = (sign * x, y, z)
    joints[name] = (parent, place)


def skeleton_of(joints):
    """A skeleton from parents and places by name, in any order."""
    order: list[str] = []
    while len(order) < len(joints):
        order += [n for n, (up, _) in joints.items() if n not in order and (not up or up in order)]
    names = tuple(order)
    parents = tuple(names.index(joints[n][0]) if joints[n][0] else -1 for n in names)
    world = np.array([joints[n][1] for n in names], float)
    local = world - np.where(np.array(parents)[:, None] >= 0, world[list(parents)], 0.0)
    return Skeleton(names, parents, Pose(local, np.tile(rotations.IDENTITY, (len(names), 1))))
