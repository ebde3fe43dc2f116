"""Vleo's gestures while he speaks: neck, head and tail beat the rhythm; his feet stand."""

from dataclasses import dataclass

import numpy as np

from cubeling.characters.model.character import Character
from cubeling.characters.skeleton import rotations
from cubeling.characters.skeleton.pose import Pose
from cubeling.characters.synthesis.gestures.analysis import APEX_AFTER_S, hand_paths
from cubeling.characters.synthesis.gestures.learning import stroke_strength
from cubeling.characters.synthesis.gestures.library import (
    GestureLibrary,
    GesturePhrase,
    GestureRecording,
    gesture_joints,
)
from tools.authoring.gestures.timeline import RATE_HZ, REST_S, Track
from tools.authoring.modelling.curves import spring_follow
from tools.authoring.modelling.shapes import Array
from tools.authoring.vleo.rig import NECK, TAIL

STRENGTHS = {"weak": (0.5, 0.28), "neutral": (1.0, 0.22), "strong": (1.5, 0.18)}
"""Size of a stroke, and its duration [s]."""

TAIL_UP_DEG = 4.0
"""How high the tail is in rest [degrees]."""


@dataclass(frozen=True)
class HeadPosture:
    """Neck, head and tail; degrees."""

    neck: float = 0.0
    """Up, all its joints together."""

    aside: float = 0.0
    """Neck to the left."""

    head: float = 0.0
    """Up."""

    turn: float = 0.0
    """Head to the left."""

    tilt: float = 0.0
    """Head to the right shoulder."""

    tail: float = 0.0
    """Up, over rest."""

    wag: float = 0.0
    """Tail to the left."""

    def values(self, mirrored: bool = False) -> Array:
        """Return all numbers, (7,)."""
        side = -1.0 if mirrored else 1.0
        return np.array(
            [self.neck, side * self.aside, self.head, side * self.turn, side * self.tilt,
             self.tail, side * self.wag]
        )  # fmt: skip


BEATS = {
    "nod": (HeadPosture(6, 0, 6, tail=-4), HeadPosture(-13, 0, -8, tail=9)),
    "toss": (HeadPosture(-13, 0, -5, tail=6), HeadPosture(9, 0, 6, tail=-3)),
    "thrust": (HeadPosture(14, 0, -4, tail=-4), HeadPosture(-24, 0, 18, tail=12)),
    "swing": (HeadPosture(4, -9, 2, -7, 5, wag=8), HeadPosture(-7, 17, -4, 13, -8, wag=-16)),
    "tilt": (HeadPosture(6, -3, 5, 0, -6, wag=4), HeadPosture(-8, 4, -6, 4, 18, wag=-8)),
}
"""Postures at the top of the stroke and at its apex, by name; the face stays in view."""

UNITS = (
    ("nod", "tilt", "nod"),
    ("swing", "-swing", "nod"),
    ("thrust", "nod", "toss"),
    ("-tilt", "swing", "thrust"),
    ("toss", "nod", "-swing"),
)
"""Beats of the units, each in all strengths; "-" is to the other side."""


def vleo_gestures(character: Character) -> GestureLibrary:
    """Return the library; the result is always the same."""
    skeleton, anatomy = character.skeleton, character.anatomy
    joints = [*gesture_joints(skeleton, anatomy)]
    recordings: list[GestureRecording] = []
    phrases: list[GesturePhrase] = []
    for beats in UNITS:
        for strength in STRENGTHS:
            number = len(recordings)
            curve, bounds = _unit(beats, strength, np.random.default_rng(number))
            turns = _turns(character, curve)
            recordings.append(GestureRecording(f"{strength}: {', '.join(beats)}", turns[:, joints]))
            moved = np.repeat(skeleton.rest.translations[None], len(turns), axis=0)
            path = hand_paths(Pose(moved, turns), skeleton, anatomy)["left"]
            for start, prepared, begin, reached, end, last in bounds:
                late = path[begin : reached + round(APEX_AFTER_S * RATE_HZ) + 1]  # the head is
                apex = begin + int(np.linalg.norm(late - late[0], axis=1).argmax())
                done = max(reached, apex)
                gsi = stroke_strength(turns[begin : done + 1], "both", anatomy)
                phases = start, prepared, begin, done, max(end, done), last
                phrases.append(GesturePhrase(number, "both", phases, apex, gsi))
    rest = recordings[0].turns[0]
    return GestureLibrary(
        skeleton, anatomy, tuple(joints), RATE_HZ, rest, tuple(recordings), tuple(phrases)
    )


Bounds = tuple[int, int, int, int, int, int]
"""Frames at which the phases of a beat begin, and its last frame."""


def _unit(
    beats: tuple[str, ...], strength: str, rng: np.random.Generator
) -> tuple[Array, list[Bounds]]:
    """Return the curves of a unit, (frames, 7) [degrees], and its beats."""
    size, seconds = STRENGTHS[strength]
    track, bounds, held = Track(), list[Bounds](), np.zeros(7)
    frame = round(REST_S * RATE_HZ)
    track.add("body", 0.0, held)
    for number, name in enumerate(beats):
        beat, mirrored = BEATS[name.removeprefix("-")], name.startswith("-")
        top, apex = (size * rng.uniform(0.85, 1.15) * posture.values(mirrored) for posture in beat)
        lengths = (0.3, rng.choice([0.0, 0.06]), seconds, rng.uniform(0.25, 0.45))
        ends = np.rint(np.cumsum(lengths) * rng.uniform(0.92, 1.08) * RATE_HZ).astype(int)
        prepared, stroke, stroke_end, end = (frame + ends).tolist()
        recoil = apex + rng.uniform(0.15, 0.3) * (top - apex)
        last = number == len(beats) - 1
        final = end + round(0.45 * RATE_HZ) if last else end
        track.add("body", frame, held)
        track.add("body", prepared, top)
        track.add("body", stroke, 1.05 * top)
        track.add("body", stroke + 0.55 * (stroke_end - stroke), top + 0.3 * (apex - top))
        track.add("body", stroke_end, apex)
        track.add("body", stroke_end + 7, recoil)
        held = 0.8 * recoil
        track.add("body", end, held)
        bounds.append((frame, prepared, stroke, stroke_end, end, final))
        frame = final
    track.add("body", frame, np.zeros(7))
    return track.curve("body", frame + round(REST_S * RATE_HZ) + 1), bounds


def _turns(character: Character, curve: Array) -> Array:
    """Return the local rotations of all joints, (frames, joints, 4): each follows the one below."""
    skeleton, seconds = character.skeleton, len(curve) / RATE_HZ
    turns = np.repeat(skeleton.rest.rotations[None], len(curve), axis=0)

    def turn(joint: str, up: Array, left: Array, tilt: Array) -> None:
        angles = np.radians(np.stack([left, -up, tilt], axis=-1))
        number = skeleton.index(joint)
        turns[:, number] = rotations.multiply(turns[:, number], rotations.from_euler("yxz", angles))

    neck, aside, head, aside_head, tilt, tail, wag = curve.T
    for number, joint in enumerate(NECK):
        hertz = 9.0 - 1.5 * number
        up, left = (spring_follow(each, seconds, hertz, 0.8) / 3.0 for each in (neck, aside))
        turn(joint, up, left, 0.15 * tilt)
    late = [spring_follow(each, seconds, 7.0, 0.6) for each in (head, aside_head, tilt)]
    turn("head", *late)
    for number, joint in enumerate(TAIL):
        hertz = 3.6 / (1.0 + 0.12 * number)
        tail, wag = (spring_follow(each, seconds, hertz, 0.55) for each in (tail, wag))
        turn(joint, -(TAIL_UP_DEG + tail) / 2.0, -wag / 2.0, 0.0 * wag)
    return rotations.continuous(turns)
