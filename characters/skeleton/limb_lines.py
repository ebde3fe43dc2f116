"""Lines of joints, from a joint down: found in a tree, and read as limbs."""

from collections.abc import Mapping, Sequence

_ESSENTIAL = 0.5  # a limb needs its long bones more than its collarbone or its toes


def assign(
    line: Sequence[int],
    roles: Sequence[str],
    essential: Sequence[str],
    fits: Sequence[Mapping[str, float]],
) -> tuple[float, dict[str, int]]:
    """Return the assignment of joints of a line to roles, both in order, that fits best.

    Longest common subsequence with weights, by dynamic programming; of two joints that fit alike
    the lower one is taken, as a connector is above what it connects.
    """
    best: list[tuple[float, dict[str, int]]] = [(0.0, {})] * (len(roles) + 1)
    for joint, fit in zip(line, fits, strict=True):
        before = list(best)
        for number, role in enumerate(roles):
            if role in fit:
                score, taken = before[number]
                score += fit[role] + (_ESSENTIAL if role in essential else 0.0)
                if score >= best[number + 1][0]:
                    best[number + 1] = (score, taken | {role: joint})
        for number in range(len(roles)):
            if best[number][0] > best[number + 1][0]:
                best[number + 1] = best[number]
    return best[-1]


def lines_of(parents: Sequence[int]) -> list[list[int]]:
    """Return for each joint the line from its root down to itself."""
    lines: list[list[int]] = []
    for joint, parent in enumerate(parents):
        lines.append([*(lines[parent] if parent >= 0 else ()), joint])
    return lines


def children_of(parents: Sequence[int]) -> dict[int, list[int]]:
    """Return the children by joint; those of −1 are the roots."""
    children: dict[int, list[int]] = {}
    for joint, parent in enumerate(parents):
        children.setdefault(parent, []).append(joint)
    return children


def longest(joint: int, children: Mapping[int, Sequence[int]]) -> list[int]:
    """Return the longest line from a joint down."""
    order = [joint]
    for above in order:  # grows as it goes
        order += children.get(above, ())
    lengths: dict[int, int] = {}
    for each in reversed(order):
        lengths[each] = 1 + max((lengths[child] for child in children.get(each, ())), default=0)
    line = [joint]
    while below := children.get(line[-1]):
        line.append(max(below, key=lengths.__getitem__))
    return line


def line_of(joints: Sequence[int], lines: Sequence[Sequence[int]]) -> list[int]:
    """Return the longest line that some joints make, from the top down."""
    among = [[above for above in lines[joint] if above in joints] for joint in joints]
    return max(among, key=len, default=[])
