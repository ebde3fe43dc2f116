"""The path of one foot over the ground, constant while it stands."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.motion.contacts import spans
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.smoothing import smoothstep

_SETTLING_S = 0.12  # to leave or reach the speed of the correction during a contact


@dataclass(frozen=True)
class FootPath:
    """The path of one foot over the ground."""

    goal: Array  # position of its end without corrections, (frames, 3) [m]
    heel_to_end: Array  # from the heel to the end, (frames, 3) [m]
    heel: NDArray[np.bool_]  # whether it stands on its heel alone, (frames,)
    ball: NDArray[np.bool_]  # whether it stands on its end, (frames,)
    lowest: Array  # height of its end with the sole on the ground, (frames,) [m]; −inf without
    max_correction: float  # a contact that needs a larger correction is dropped [m]
    rate: float  # [Hz]
    steps: Array | float = 0.0  # how contacts are moved into reach, (frames, 3) [m]

    @cached_property
    def contacts(self) -> list[tuple[int, int]]:
        """First frame and number of frames of each contact that can be held."""
        found = spans(self.heel | self.ball, loop=False)
        return [each for each in found if np.abs(self._goal(*each)).max() < self.max_correction]

    @cached_property
    def standing(self) -> NDArray[np.bool_]:
        """Whether it is held, (frames,)."""
        standing = np.zeros(len(self.goal), bool)
        for first, length in self.contacts:
            standing[first : first + length] = True
        return standing

    @cached_property
    def corrections(self) -> Array:
        """How its end moves to be held, (frames, 3) [m]; zero between the contacts."""
        corrections = np.zeros_like(self.goal)
        for first, length in self.contacts:
            corrections[first : first + length] = self._goal(first, length)
        return np.asarray(corrections + self.steps)

    def with_steps_moved(self, missing: Array) -> "FootPath":
        """Return the path with each contact moved by the farthest that it is out of reach.

        `missing` leads from its end to where it can be, (frames, 3) [m].
        """
        steps = np.zeros_like(self.goal) + self.steps
        for first, length in self.contacts:
            span = slice(first, first + length)
            farthest = np.linalg.norm(missing[span], axis=-1).argmax()
            steps[span] += missing[span][farthest]
        return replace(self, steps=steps)

    def hold(self, shift: Array) -> Array:
        """Return the positions of its end, (frames, 3) [m], constant during contacts.

        A swinging foot moves with the body, which is shifted by (frames, 3) [m].
        """
        correction = np.where(self.standing[:, None], self.corrections - shift, 0.0)
        self._interpolate(correction, self.contacts)
        held: Array = self.goal + shift + correction
        held[:, 1] = np.maximum(held[:, 1], self.lowest)
        return held

    def _goal(self, first: int, length: int) -> Array:
        span = np.arange(first, first + length)
        return np.asarray(self._contact_positions(span) - self.goal[span])

    def _contact_positions(self, span: NDArray[np.intp]) -> Array:
        """Return the positions of the end during a contact: on the heel first, then on the ball."""
        goal, heel_to_end = self.goal[span], self.heel_to_end[span]
        ball = self.ball[span]
        if not ball.any():  # the contact is cut off, or too short to roll onto the ball
            return np.asarray((goal - heel_to_end).mean(0) + heel_to_end)
        spot = goal[ball].mean(0)
        first = int(ball.argmax())
        at = np.tile(spot, (len(span), 1))
        # The foot turns about its heel until the ball is down.
        at[:first] = spot - heel_to_end[first] + heel_to_end[:first]
        if np.isfinite(self.lowest).all():
            at[:, 1] = self.lowest[span]
        return at

    def _interpolate(self, correction: Array, contacts: Sequence[tuple[int, int]]) -> None:
        """Fill in the correction between contacts, smoothly."""
        if not contacts:
            return
        ends = [(0, 0), *contacts, (len(correction), 0)]
        for (first, length), (after, _) in pairwise(ends):
            start, gap = first + length, after - first - length
            if gap <= 0:
                continue
            here = correction[start - 1] if length else correction[after]
            there = correction[after] if after < len(correction) else here
            zero = np.zeros(3)
            leaving = _slope(correction, start - 1, -1) if length > 1 else zero
            arriving = _slope(correction, after, 1) if after + 1 < len(correction) else zero
            u: Array = np.arange(1.0, gap + 1)[:, None]
            width = min(_SETTLING_S * self.rate, (gap + 1) / 2)
            correction[start:after] = here + (there - here) * smoothstep(u / (gap + 1))
            correction[start:after] += leaving * _decay(u, width)
            correction[start:after] -= arriving * _decay(gap + 1 - u, width)


def _slope(correction: Array, frame: int, inward: int) -> Array:
    """Return the change per frame at an end of a contact, forward in time."""
    change: Array = (correction[frame + inward] - correction[frame]) * inward
    return change


def _decay(frames: Array, width: float) -> Array:
    """Return a curve that starts from 0 with slope 1 and is 0 from `width` on."""
    return np.asarray(frames * np.clip(1 - frames / width, 0.0, 1.0) ** 2)
