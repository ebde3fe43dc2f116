"""What the trackers say of two cubes, beside where these are."""

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field

from cubeling.tracking import CubeState, CubesTracker
from tests.campaigns.two_cubes.clips import draw_clip
from tests.tracking.drawn import CAMERA, Array, off

MAX_ERROR_MM, MAX_ERROR_DEG = 20.0, 10.0
"""A trusted pose that is off by more is wrong, as in `make bench-photographs`."""

OTHER_CUBE_MM = 30.0
"""A wrong pose that is so near to the other cube is that of the other cube: half an edge."""

STILL_MM, MOVING_MM, BEHIND_MM = 0.5, 2.0, 5.0
"""A pose that moved by less than the first since the frame before, where the cube moved by more
than the second, and that is off by more than the third, is frozen."""

MAX_SAID_FRAMES = 2
"""After so many frames without a sight of a cube, its loss is said."""

HIDDEN_SHARE, SHOWN_SHARE = 0.01, 0.7
"""A cube is hidden where less of its outline is in view, and should be found where more is."""


@dataclass
class Count:
    """What the trackers said of clips."""

    events: Counter[str] = field(default_factory=Counter)
    """How often something happened, by its name."""

    waits: list[int] = field(default_factory=list)
    """Frames until a cube was found, whenever it came into view."""

    wrong_clips: dict[int, str] = field(default_factory=dict)
    """What went wrong in a clip, by its number."""

    def add(self, other: "Count") -> None:
        """Add those of other clips."""
        self.events += other.events
        self.waits += other.waits
        self.wrong_clips |= other.wrong_clips


@dataclass
class Watch:
    """What is seen of one cube from frame to frame."""

    hidden: int = 0
    """Frames in a row in which nothing of it was in view."""

    shown: int = 0
    """Frames in a row in which it was in view."""

    found: bool = False
    """Whether it was found since it came into view."""

    last: tuple[Array, Array] | None = None
    """The pose that was stated in the frame before, and the true one."""

    def judge(self, state: CubeState, pose: Array | None, other: Array | None, share: float) -> str:
        """Return what is to be said of a state; "" where nothing is."""
        self.hidden = self.hidden + 1 if share < HIDDEN_SHARE else 0
        self.shown = self.shown + 1 if share > SHOWN_SHARE else 0
        stated, last = state.camera_from_cube, self.last
        self.last = None
        if not state.visible or stated is None:
            return ""
        if pose is not None:
            self.last = stated, pose
        if self.hidden > MAX_SAID_FRAMES:
            return "loss not said"
        if other is not None and off(stated, other)[0] < OTHER_CUBE_MM and _wrong(stated, pose):
            return "the other cube"
        if last is not None and pose is not None and off(stated, pose)[0] > BEHIND_MM:
            stays, moves = off(stated, last[0])[0] < STILL_MM, off(pose, last[1])[0] > MOVING_MM
            if stays and moves:
                return "frozen"
        return "wrong" if _wrong(stated, pose) else ""


def _wrong(stated: Array, pose: Array | None) -> bool:
    if pose is None:
        return True
    millimetres, degrees = off(stated, pose)
    return millimetres > MAX_ERROR_MM or degrees > MAX_ERROR_DEG


def show(seed: int, number: int, tell: Callable[[str], None] = lambda line: None) -> Count:
    """Show one clip to the trackers of its cubes."""
    pair, moments = draw_clip(seed, number)
    tracker, count = CubesTracker(pair, CAMERA), Count()
    watches = Watch(), Watch()
    for moment in moments:
        try:
            states = tracker.update(moment.frame)
        except Exception as error:
            count.events["errors"] += 1
            count.wrong_clips[number] = f"{type(error).__name__}: {error}"
            break
        line = f"{moment.frame.index:2}"
        for own, watch in enumerate(watches):
            state, share = states[own], moment.shares[own]
            said = watch.judge(state, moment.poses[own], moment.poses[1 - own], share)
            count.events["poses"] += state.visible
            if watch.shown > MAX_SAID_FRAMES:
                count.events["in view"] += 1
                count.events["found"] += state.visible
            if state.visible and watch.shown and not watch.found:
                count.waits.append(watch.shown - 1)
            watch.found = state.visible or (watch.found and watch.shown > 0)
            line += f"  {pair[own].name} {share:.2f} {state.verdict}"
            pose = moment.poses[own]
            if state.visible and pose is not None:
                line += " {:.1f} mm {:.1f}°".format(*off(state.camera_from_cube, pose))
            if said:
                count.events[said] += 1
                count.wrong_clips[number] = said
                line += f" ({said}!)"
        tell(line)
    return count
