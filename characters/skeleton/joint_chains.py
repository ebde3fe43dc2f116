"""Chains of joints in a skeleton, and their assignment to the parts of a limb."""

from collections.abc import Mapping, Sequence

_ESSENTIAL_BONUS = 0.5  # score of a long bone beyond that of a collarbone or toes


def assign(
    chain: Sequence[int],
    roles: Sequence[str],
    essential: Sequence[str],
    fits: Sequence[Mapping[str, float]],
) -> tuple[float, dict[str, int]]:
    """Return the best assignment of the joints of a chain to roles, both in order, and its score.

    Weighted longest common subsequence by dynamic programming. Of two joints with equal scores the
    lower one wins, because rigs put connecting joints above the joint they connect.
    """
    best: list[tuple[float, dict[str, int]]] = [(0.0, {})] * (len(roles) + 1)
    for joint, fit in zip(chain, fits, strict=True):
        before = list(best)
        for number, role in enumerate(roles):
            if role in fit:
                score, taken = before[number]
                score += fit[role] + (_ESSENTIAL_BONUS if role in essential else 0.0)
                if score >= best[number + 1][0]:
                    best[number + 1] = (score, taken | {role: joint})
        for number in range(len(roles)):
            if best[number][0] > best[number + 1][0]:
                best[number + 1] = best[number]
    return best[-1]


def chains_to_root(parents: Sequence[int]) -> list[list[int]]:
    """Return for each joint the chain from its root down to itself."""
    chains: list[list[int]] = []
    for joint, parent in enumerate(parents):
        chains.append([*(chains[parent] if parent >= 0 else ()), joint])
    return chains


def children_of(parents: Sequence[int]) -> dict[int, list[int]]:
    """Return the children of each joint; those of −1 are the roots."""
    children: dict[int, list[int]] = {}
    for joint, parent in enumerate(parents):
        children.setdefault(parent, []).append(joint)
    return children


def longest_chain_below(joint: int, children: Mapping[int, Sequence[int]]) -> list[int]:
    """Return the longest chain from a joint downward."""
    order = [joint]
    for above in order:  # grows as it goes
        order += children.get(above, ())
    lengths: dict[int, int] = {}
    for each in reversed(order):
        lengths[each] = 1 + max((lengths[child] for child in children.get(each, ())), default=0)
    chain = [joint]
    while below := children.get(chain[-1]):
        chain.append(max(below, key=lengths.__getitem__))
    return chain


def longest_chain_of(joints: Sequence[int], chains: Sequence[Sequence[int]]) -> list[int]:
    """Return the longest chain that consists of the given joints only, from the top down."""
    among = [[above for above in chains[joint] if above in joints] for joint in joints]
    return max(among, key=len, default=[])
