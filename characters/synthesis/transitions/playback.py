"""Playing frames of a library along a path: jumps are inertialized, and the root keeps going.

Source: Fernández-Baena 2015, M1.3 and M1.6. Each frame moves the root by its own step, in the axes
that the root has then; this accumulates the planar alignments of all jumps.
"""

from collections.abc import Sequence

import numpy as np

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.baking import placed_clip
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.inertialization import Inertialization, OffsetDecay
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.synthesis.library import MotionLibrary

BLEND_S = 0.3
"""Time in which a jump passes over to what it leads to [s] (M1.3, [GAP]); in 0.25 s some joints
jump."""


class GraphPlayer:
    """Plays one frame after another, and passes over where they do not follow each other.

    After a jump the new clip plays at once, and its difference from what was shown decays. A blend
    with the left clip, as M1.3 has it, needs that clip to go on; where it ends soon after the jump,
    a limb would stop in the air.
    """

    def __init__(self, library: MotionLibrary, frame: int, blend: float = BLEND_S) -> None:
        self.library = library
        self.frame = frame
        """The frame of the library that is played."""
        self._length = max(blend, 1.0 / library.rate)
        self._offset: Inertialization | None = None
        self._drift = OffsetDecay(np.zeros(3), np.zeros(3), self._length)
        self._age = 0  # frames since the jump
        self._shown = self._before = library.poses[frame]

    def advance(self, frame: int) -> RootDelta:
        """Go to the next frame, and return how the root moves on the way there."""
        library = self.library
        step = library.steps[self.frame] + self._drift.at(self._age / library.rate)
        self._age += 1
        if library.successors[self.frame] != frame:
            self._jump(frame, step)
        self.frame = frame
        self._before, self._shown = self._shown, self._with_offset(library.poses[frame])
        return RootDelta(*step.tolist())

    def pose(self) -> Pose:
        """Return the pose now, with the root at the origin."""
        return self._shown

    def _jump(self, frame: int, step: Array) -> None:
        """Let what was shown pass over into a frame and those after it."""
        library = self.library
        onward = int(library.successors[self.frame])
        # A clip that ends goes on as it was seen to move.
        going = extrapolate(self._before, self._shown)
        if onward >= 0:
            going = self._with_offset(library.poses[onward])
        after = int(library.onward(np.array([frame]), 1)[0])
        self._offset = Inertialization.begin(
            (going, extrapolate(self._shown, going)),
            (library.poses[frame], library.poses[after]),
            1.0 / library.rate,
            self._length,
        )
        self._drift = OffsetDecay(step - library.steps[frame], np.zeros(3), self._length)
        self._age = 0

    def _with_offset(self, pose: Pose) -> Pose:
        if self._offset is None:
            return pose
        return self._offset.apply(pose, self._age / self.library.rate)


def extrapolate(before: Pose, now: Pose) -> Pose:
    """Return the pose that is as far from one as that is from the one before it."""
    turned = rotations.multiply(now.rotations, rotations.conjugate(before.rotations))
    return Pose(
        2 * now.translations - before.translations, rotations.multiply(turned, now.rotations)
    )


def path_clip(
    library: MotionLibrary, frames: Sequence[int], name: str = "path", blend: float = BLEND_S
) -> Clip:
    """Return the motion along a path through a graph, as a clip with root motion.

    Raises
    ------
    CharacterError
        If there is no frame.
    """
    if not len(frames):
        raise CharacterError("a path without frames is no motion")
    player = GraphPlayer(library, frames[0], blend)
    places, poses = [RootDelta()], [player.pose()]
    for frame in frames[1:]:
        places.append(places[-1].then(player.advance(frame)))
        poses.append(player.pose())
    return placed_clip(name, library.rate, Pose.of_frames(poses), places)
