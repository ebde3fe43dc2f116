"""Shifts of the weight before acts: `python -m tests.bench.coming_acts [CHARACTER …] [--acts N]`.

A character stands, and at times of a seed an action or a gesture begins. Each is played twice from
the moment on that is `TOLD_S` before: once the character is told of what comes, as plays, blocks
and tagged speech do, and once it is not. For actions, prints how far hips and legs are from the
pose in which the action begins, in the last frame before it; for gestures, how often the weight is
being shifted when they begin, and how far the hips go in the second after that.

Exits with 1 if what is left, told, of any of the three exceeds `MAX_SHARE` of it untold.
"""

import argparse
import sys

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.checkpoint import Checkpoint
from cubeling.characters import Animator, Character, CharacterCommand, ComingAct
from cubeling.characters.behaviour.gestures.collection import GestureCollection
from cubeling.characters.behaviour.gestures.timing import natural_times
from cubeling.characters.behaviour.intents import BehaviourIntent, GestureIntent
from cubeling.characters.motion.motion import StandingMotion
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Array, Pose

MAX_SHARE = 0.5
"""Bar: what is left with the act told, as a share of what is left without."""

FRAME_S = 1 / 60
TOLD_S, AFTER_S = 3.0, 1.0
"""How long before an act it is told, and how long after its beginning the hips are watched [s]."""

SHIFTING_HZ = 0.03
"""Speed of the hips above which weight is being shifted, in heights of the character [1/s]."""

GESTURE = "WAVE"


class Stander:
    """A character that stands, without layers, so that only its weight moves."""

    def __init__(self, character: Character) -> None:
        self._animator, self._now = Animator(character, layers=()), 0.0
        self._height = character.height
        joints = character.anatomy.joints
        self._hips = joints["hips"]
        self._below = [j for part, j in joints.items() if "leg" in part.lower() or part == "hips"]
        self.actions = self._animator.actions

    @property
    def standing(self) -> StandingMotion:
        """The motion that it stands with."""
        motion: StandingMotion = self._animator.controller._standing.motion  # type: ignore[attr-defined]
        return motion

    def play(
        self, seconds: float, coming: ComingAct | None = None, **intents: object
    ) -> list[Pose]:
        """Return the poses of the next frames."""
        poses = []
        for _ in range(round(seconds / FRAME_S)):
            self._now += FRAME_S
            command = CharacterCommand(self._now, coming=coming, **intents)  # type: ignore[arg-type]
            poses.append(self._animator.update(command).pose)
        return poses

    def copies(self) -> tuple[Checkpoint, float]:
        """Return what `restore` takes."""
        return Checkpoint({"animator": self._animator}), self._now

    def restore(self, kept: tuple[Checkpoint, float]) -> None:
        """Go back to a copy."""
        self._animator, self._now = kept[0].content()["animator"], kept[1]

    def away(self, pose: Pose, first: Pose) -> float:
        """Return how far hips and legs are from another pose: the largest angle [degrees]."""
        a, b = pose.rotations[self._below], first.rotations[self._below]
        turns = rotations.to_rotation_vector(rotations.multiply(rotations.conjugate(a), b))
        return float(np.degrees(np.linalg.norm(turns, axis=-1).max()))

    def way(self, poses: list[Pose]) -> Array:
        """Return how far the hips go from frame to frame, in heights."""
        places = np.array([pose.translations[self._hips] for pose in poses])
        return np.asarray(np.linalg.norm(np.diff(places, axis=0), axis=1) / self._height)

    def before(self, action: str, *, told: bool) -> float:
        """Return how far it is from where an action begins, just before that."""
        coming = ComingAct(self._now + TOLD_S, action) if told else None
        last = self.play(TOLD_S - FRAME_S, coming)[-1]
        return self.away(last, first_pose(self._animator, action))

    def during(self, *, told: bool) -> tuple[bool, float]:
        """Return whether it shifts as a gesture begins, and how far the hips go in that [heights].

        Shoulders and arms do not count, so the hands themselves may stay at rest here.
        """
        begins = self._now + TOLD_S
        self.play(TOLD_S - FRAME_S, ComingAct(begins) if told else None)
        gesture = GestureCollection.load_bundled().get(GESTURE)
        asked = BehaviourIntent((GestureIntent("it", gesture, natural_times(gesture, begins)),))
        way = self.way(self.play(AFTER_S, behaviour=asked))
        return bool(way[0] / FRAME_S > SHIFTING_HZ), float(way.sum())


def first_pose(animator: Animator, action: str) -> Pose:
    """Return the pose in which an action of a character begins."""
    pose: Pose = animator.controller._actions.first_pose(ComingAct(0.0, action))  # type: ignore[attr-defined]
    return pose


def measure(name: str, acts: int, console: Console) -> bool:
    """Print the table of a character, and return whether the bar holds."""
    stander, rng = Stander(Character.load(name)), np.random.default_rng(1)
    action = next(each for each in stander.actions if each in ("nod", "kiss", "jump", "wave"))
    found: dict[bool, list[tuple[float, bool, float]]] = {True: [], False: []}
    for _ in range(acts):
        stander.play(rng.uniform(4.0, 8.0))
        kept = stander.copies()
        for told, each in found.items():
            stander.restore(kept)
            away = stander.before(action, told=told)
            stander.restore(kept)
            each.append((away, *stander.during(told=told)))
        stander.restore(kept)
    told_, untold = (np.array(found[told], float).mean(0) for told in (True, False))
    table = Table(f"{name}, {acts} acts", "told", "not told", "share")
    labels = (
        f"from where {action} begins [degrees]",
        "shifting as hands begin [%]",
        "hips [% of h]",
    )
    shares = told_ / np.maximum(untold, 1e-9)
    for label, a, b, share, factor in zip(
        labels, told_, untold, shares, (1, 100, 100), strict=True
    ):
        table.add_row(label, f"{factor * a:.2f}", f"{factor * b:.2f}", f"{share:.2f}")
    console.print(table)
    return bool((shares <= MAX_SHARE).all())


def main() -> int:
    """Print the tables and return an exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("characters", nargs="*", default=["human", "vleo"])
    parser.add_argument("--acts", type=int, default=40, help="how many of each character")
    asked = parser.parse_args()
    console = Console(highlight=False)
    held = [measure(each, asked.acts, console) for each in asked.characters]
    return int(not all(held))


if __name__ == "__main__":
    sys.exit(main())
