"""Playing frames of a library along a path: jumps are blended, and the root keeps going.

Source: Fernández-Baena 2015, M1.3 and M1.6. Each frame moves the root by its own step, in the axes
that the root has then; this accumulates the planar alignments of all jumps.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from cubeling.characters.errors import CharacterError
from cubeling.characters.motion.baking import placed_clip
from cubeling.characters.motion.clip import Clip
from cubeling.characters.motion.curves import ease
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose
from cubeling.characters.synthesis.library import MotionLibrary

BLEND_S = 0.3
"""Length of the blend after a jump [s] (M1.3, [GAP]); over 0.25 s some joints jump."""


@dataclass
class _Stream:
    """A clip that plays."""

    frame: int
    """Its frame in the library."""

    age: int
    """Frames that it has played since the jump to it."""


class GraphPlayer:
    """Plays one frame after another, and blends where they do not follow each other.

    After a jump the left clip plays on under the new one for the length of the blend, and the new
    one has the weight 3u² − 2u³ (M1.3). A left clip that ends stays in its last frame.
    """

    def __init__(self, library: MotionLibrary, frame: int, blend: float = BLEND_S) -> None:
        self.library = library
        self._length = max(round(blend * library.rate), 1)
        self._streams = [_Stream(frame, self._length)]

    @property
    def frame(self) -> int:
        """The frame of the library that is played."""
        return self._streams[-1].frame

    def advance(self, frame: int) -> RootDelta:
        """Go to the next frame, and return how the root moves on the way there."""
        step = self._nest(self.library.steps, lambda a, b, weight: a + (b - a) * weight)
        following = self.library.successors
        jumps = following[self.frame] != frame
        for stream in self._streams if jumps else self._streams[:-1]:
            onward = int(following[stream.frame])
            stream.frame = stream.frame if onward < 0 else onward
            stream.age += 1
        if jumps:
            self._streams.append(_Stream(frame, 1))
        else:
            self._streams[-1] = _Stream(frame, self._streams[-1].age + 1)
        newest_alone = max(n for n, s in enumerate(self._streams) if n == 0 or s.age > self._length)
        self._streams = self._streams[newest_alone:]
        return RootDelta(*step.tolist())

    def pose(self) -> Pose:
        """Return the pose now, with the root at the origin."""
        poses = self.library.poses
        return Pose(
            self._nest(poses.translations, lambda a, b, weight: a + (b - a) * weight),
            self._nest(poses.rotations, rotations.slerp),
        )

    def _nest(self, rows: Array, mix: Callable[[Array, Array, float], Array]) -> Array:
        """Return the mix of the streams' rows: each new stream takes over from all before it."""
        first, *others = self._streams
        value: Array = rows[first.frame]
        for stream in others:
            weight = ease(stream.age / (self._length + 1), "cubic")
            value = mix(value, rows[stream.frame], weight)
        return value


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
