"""One direction of a line that does harm to what it carries, in virtual time."""

from collections import Counter, deque
from typing import Final

import numpy as np

from robot.simulators.faults import Faults

IN_FLIGHT_MAX: Final = 65536
"""Most bytes on their way [bytes]; what comes on top of them is lost, as in any buffer."""

FRAME_MAX: Final = 4096
"""A frame longer than this is not doubled [bytes]; it is noise without an edge."""

SPLIT_GAP: Final = 0.004
"""Time between the two pieces of a frame that is split [s]."""

BURST_MEAN: Final = 16
"""Mean length of a burst of noise [bytes]."""


class Chance:
    """Strikes each time with the same chance.

    It draws only how many times it does not, so that rare faults cost next to nothing.
    """

    def __init__(self, random: np.random.Generator, chance: float) -> None:
        self._random = random
        self._chance = chance
        self._left: float = float("inf")
        if chance > 0:
            self._draw()

    def strikes(self) -> bool:
        """Whether it strikes this time."""
        self._left -= 1
        if self._left > 0:
            return False
        self._draw()
        return True

    def places(self, count: int) -> list[int]:
        """Return at which of the next `count` times it strikes, from 0."""
        if self._left > count:
            self._left -= count
            return []
        return [place for place in range(count) if self.strikes()]

    def _draw(self) -> None:
        self._left = int(self._random.geometric(self._chance))


class Line:
    """One direction of a line. It loses, damages, doubles and delays, but never reorders.

    A frame is what ends at an edge, with the zero bytes in front of it. Its fate is drawn when its
    first byte comes, and bytes never wait here for their edge.

    Parameters
    ----------
    faults
        What it does; of the robot's own troubles, this knows nothing.
    edge
        The byte at which frames end.
    seed
        Of all that is drawn. Each kind of fault draws by itself, so that adding one leaves the
        others as they are.
    """

    def __init__(self, faults: Faults, edge: bytes, seed: tuple[int, ...]) -> None:
        self.cut = False
        """Whether all that is sent is lost."""
        self.counts: Counter[str] = Counter()
        """How often which fault has struck, by the name of its option; "lost": bytes too many."""
        self._edge = edge
        drop, flip, dup, split, wrong, noise, late = (
            np.random.default_rng((*seed, kind)) for kind in range(7)
        )
        self._drop, self._flip = Chance(drop, faults.drop), Chance(flip, faults.flip)
        self._dup, self._split = Chance(dup, faults.dup), Chance(split, faults.split)
        self._wrong, self._noise, self._late = wrong, noise, late
        self._delay, self._jitter = faults.delay, faults.jitter
        self._babble = faults.babble
        self._noise_at = float("inf")  # until the first byte tells the time
        self._waiting: deque[tuple[float, bytes]] = deque()
        self._size = 0
        self._last = float("-inf")  # when the last byte on its way arrives
        self._started = False
        self._copy: bytes | None = None  # of a frame that is to be doubled, as far as it has come
        self._forget_frame()

    @property
    def due(self) -> float:
        """When the next bytes arrive [s]; infinite if none are on their way."""
        return min(self._waiting[0][0], self._noise_at) if self._waiting else self._noise_at

    @property
    def in_flight(self) -> int:
        """Bytes on their way."""
        return self._size

    @property
    def harmed(self) -> int:
        """How often any fault has struck."""
        return sum(self.counts.values())

    def send(self, data: bytes, now: float) -> None:
        """Put bytes on the line at time `now` [s]."""
        self._make_noise(now)
        if self.cut:
            self._forget_frame()
            return
        start = 0
        while start < len(data):
            if not self._inside:
                self._begin_frame()
            end = self._end_of_frame(data, start)
            if not self._lose:
                self._pass(data[start:end], now)
            start = end

    def receive(self, now: float) -> bytes:
        """Take what has arrived by time `now` [s]."""
        self._make_noise(now)
        waiting = self._waiting
        if not waiting or waiting[0][0] > now:
            return b""
        arrived = waiting.popleft()[1]
        while waiting and waiting[0][0] <= now:
            arrived += waiting.popleft()[1]
        self._size -= len(arrived)
        return arrived

    def clear(self) -> None:
        """Lose all that is on its way."""
        self._waiting.clear()
        self._size = 0
        self._noise_at, self._started = float("inf"), False
        self._forget_frame()

    # --- The fate of a frame -------------------------------------------------------------------

    def _begin_frame(self) -> None:
        self._inside = True
        self._lose = self._drop.strikes()
        self._part = self._split.strikes()
        self._copy = b"" if self._dup.strikes() else None
        self.counts["drop"] += self._lose
        self.counts["split"] += self._part and not self._lose
        self.counts["dup"] += self._copy is not None and not self._lose

    def _forget_frame(self) -> None:
        self._inside = self._filled = self._lose = self._part = False
        self._copy = None

    def _end_of_frame(self, data: bytes, start: int) -> int:
        """Return where the frame ends that begins or goes on at `start`: there, or not yet."""
        if not self._filled and self._edge == b"\0":  # elsewhere an empty line is a frame, too
            filled = data[start:].lstrip(self._edge)
            if not filled:
                return len(data)
            self._filled = True
            start = len(data) - len(filled)
        edge = data.find(self._edge, start)
        if edge < 0:
            return len(data)
        self._inside = self._filled = False
        return edge + 1

    def _pass(self, piece: bytes, now: float) -> None:
        late = self._delay
        if self._jitter:
            late += float(self._late.uniform(-self._jitter, self._jitter))
        arrives = now + late
        if self._part and len(piece) > 1:
            middle = int(self._wrong.integers(1, len(piece)))
            self._put(piece[:middle], arrives)
            self._put(piece[middle:], max(arrives, self._last) + SPLIT_GAP)
            self._part = False
        else:
            self._put(piece, arrives)
        if self._copy is not None:
            self._copy += piece
            if not self._inside:
                self._put(self._copy, arrives)
                self._copy = None
            elif len(self._copy) > FRAME_MAX:
                self._copy = None

    def _put(self, data: bytes, arrives: float) -> None:
        places = self._flip.places(len(data))
        if places:
            wrong = bytearray(data)
            for place in places:
                wrong[place] ^= 1 << int(self._wrong.integers(8))
            data = bytes(wrong)
            self.counts["flip"] += len(places)
        self._append(data, arrives)

    def _append(self, data: bytes, arrives: float) -> None:
        if self._size + len(data) > IN_FLIGHT_MAX:
            self.counts["lost"] += len(data)
            return
        self._size += len(data)
        self._last = max(arrives, self._last)
        self._waiting.append((self._last, data))

    # --- Noise ---------------------------------------------------------------------------------

    def _make_noise(self, now: float) -> None:
        """Put the bursts on the line that are due by now."""
        if not self._babble:
            return
        if not self._started:
            self._started = True
            self._noise_at = now + self._silence()
        while self._noise_at <= now:
            burst = self._noise.bytes(int(self._noise.integers(1, 2 * BURST_MEAN)))
            if not self.cut:
                self.counts["babble"] += len(burst)
                self._append(burst, self._noise_at)
            self._noise_at += self._silence()

    def _silence(self) -> float:
        return float(self._noise.exponential(BURST_MEAN / self._babble))
