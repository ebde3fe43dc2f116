"""How far clusters of behaviours are moved so that each comes late enough after others."""

from collections import defaultdict, deque
from collections.abc import Mapping

from cubeling.characters.behaviour.bml.spans import TOLERANCE


class Shifts:
    """The least shifts of clusters that keep their order; what has no shift stays at 0.

    Orders are added one by one, and only what an order moves is looked at again (Cotton and Maler,
    "Fast and flexible difference constraint propagation for DPLL(T)", 2006). So an order that
    closes a circle is found when it comes, and those before it hold.

    Parameters
    ----------
    least
        Shifts without any order [s]; a cluster is never moved less.
    """

    def __init__(self, least: Mapping[int, float]) -> None:
        self._shifts = dict(least)
        self._after: dict[int, list[tuple[int, float]]] = defaultdict(list)

    def of(self, cluster: int) -> float:
        """Return the shift of a cluster [s]."""
        return self._shifts.get(cluster, 0.0)

    def keep_after(self, later: int, earlier: int, distance: float) -> bool:
        """Let a cluster be shifted by `distance` [s] more than an earlier one, at least.

        Return False, and change nothing, if that goes round in a circle.

        >>> shifts = Shifts({1: 0.0, 2: 0.0})
        >>> shifts.keep_after(2, 1, 3.0), shifts.of(2), shifts.keep_after(1, 2, -2.0), shifts.of(2)
        (True, 3.0, False, 3.0)
        """
        before: dict[int, float] = {}
        moved = deque([(later, self.of(earlier) + distance)])
        while moved:
            cluster, least = moved.popleft()
            if least <= self.of(cluster) + TOLERANCE:
                continue
            if cluster == earlier:
                self._shifts |= before
                return False
            before.setdefault(cluster, self.of(cluster))
            self._shifts[cluster] = least
            moved.extend((after, least + more) for after, more in self._after[cluster])
        self._after[earlier].append((later, distance))
        return True
