"""What heads, faces, eyes and bodies do for the intents of a behaviour."""

import math

import numpy as np
import pytest

from cubeling.characters import Animator, CharacterCommand, RootDelta
from cubeling.characters.behaviour.intents import (
    BehaviourIntent,
    FaceIntent,
    GazeIntent,
    HeadIntent,
    PostureIntent,
    StrokeTimes,
    Times,
)
from cubeling.characters.behaviour.realization.face_names import ACTION_UNITS, LEXEMES, FaceNames
from cubeling.characters.behaviour.realization.stances import STANCES, StanceJoints
from cubeling.characters.control.layers.behaviour import FaceShiftLayer, StanceLayer
from cubeling.characters.control.layers.foot_lock import FootLockLayer
from cubeling.characters.control.layers.gaze import GazeLayer
from cubeling.characters.ik.legs import find_legs, find_paws
from cubeling.characters.skeleton import rotations
from tests.bundled_characters import bundled_character

HUMAN, VLEO = bundled_character("human"), bundled_character("vleo")
RATE = 30.0
LAYERS = (FootLockLayer, StanceLayer, GazeLayer, FaceShiftLayer)


def played(character, behaviour_at, seconds, layers=LAYERS):
    """Return the poses of a character that behaves as it is told for each time."""
    animator = Animator(character, place=RootDelta(), layers=layers)
    times = np.arange(round(seconds * RATE) + 1) / RATE
    return times, [
        animator.update(CharacterCommand(float(t), behaviour=behaviour_at(float(t)))).pose
        for t in times
    ]


def largest_step(poses):
    """Return how far any joint turns from one frame to the next, at most [rad]."""
    turns = np.stack([pose.rotations for pose in poses])
    steps = rotations.multiply(rotations.conjugate(turns[:-1]), turns[1:])
    return float(np.linalg.norm(rotations.to_rotation_vector(steps), axis=-1).max())


def pitch_of_head(character, pose):
    head = character.anatomy.joint("head")
    matrices = pose.globals(character.skeleton)[head, :3, :3]
    rest = character.skeleton.rest.globals(character.skeleton)[head, :3, :3]
    ahead = matrices @ np.linalg.inv(rest) @ [0.0, 0.0, 1.0]
    return math.asin(-ahead[1] / np.linalg.norm(ahead))


def shown_by(morphs, name):
    """Return the weights with which morphs show a name; None if they cannot."""
    weights = FaceNames(morphs).weights(name)
    return None if weights is None else weights.tolist()


@pytest.mark.parametrize("character", [HUMAN, VLEO], ids=["human", "vleo"])
@pytest.mark.parametrize("name", [*STANCES])
def test_feet_stay_where_they_are_in_every_stance(character, name):
    joints = StanceJoints(character.skeleton, character.anatomy)
    legs = find_paws(character.skeleton, character.anatomy) or find_legs(character.skeleton)
    assert legs is not None
    pose = character.clips["idle"].sample(0.0)
    stance = PostureIntent("a", name, Times(0.0, 1.0))
    for share in (0.5, 1.0):
        taken = joints.apply(pose, joints.values([stance], share))
        before, after = (legs.globals(each)[legs.joints[:, 3]] for each in (pose, taken))
        moved = np.linalg.norm(after[:, :3, 3] - before[:, :3, 3], axis=1)
        assert moved.max() < 1e-3 * character.height
        assert np.abs(after[:, :3, :3] - before[:, :3, :3]).max() < 1e-6


def test_a_nod_is_deepest_at_its_stroke_and_over_at_its_end():
    times = StrokeTimes(0.4, 0.6, 1.2, 1.5, 0.6, 0.9, 1.2)
    intent = BehaviourIntent(heads=(HeadIntent("n", "NOD", times),))
    at, poses = played(HUMAN, lambda _: intent, 2.0, (GazeLayer,))
    _, still = played(HUMAN, lambda _: None, 2.0, (GazeLayer,))
    pitch = np.array(
        [
            pitch_of_head(HUMAN, a) - pitch_of_head(HUMAN, b)
            for a, b in zip(poses, still, strict=True)
        ]
    )
    assert at[pitch.argmax()] == pytest.approx(0.9, abs=1.01 / RATE)
    assert math.degrees(pitch.max()) == pytest.approx(11.0, abs=1.0)
    assert np.abs(pitch[(at < 0.4) | (at > 1.5)]).max() < 1e-9


@pytest.mark.parametrize("change", ["retimed", "left out"])
def test_nothing_jumps_when_a_behaviour_is_retimed_or_left_out(change):
    def behaviour(now):
        late = 0.5 if change == "retimed" and now >= 0.7 else 0.0
        strokes = StrokeTimes(0.2, 0.5, 1.6 + late, 2.0 + late, 0.5, 0.8 + late, 1.6 + late)
        times = Times(0.2, 0.9 + late, 1.6 + late, 2.2 + late)
        if change == "left out" and now >= 0.7:
            return None
        return BehaviourIntent(
            heads=(HeadIntent("h", "SHAKE", strokes, 1.0),),
            postures=(PostureIntent("p", "CROUCHING", times),),
            faces=(FaceIntent("f", ("happy",), (1.0,), times),),
            gazes=(GazeIntent("g", np.array([0.4, 0.1, 0.2]), times, "WAIST"),),
        )

    def undisturbed(now):
        return behaviour(min(now, 0.69))

    layers = (StanceLayer, GazeLayer, FaceShiftLayer)
    _, poses = played(HUMAN, behaviour, 3.2, layers)
    _, usual = played(HUMAN, undisturbed, 3.2, layers)
    assert largest_step(poses) < 1.5 * largest_step(usual)
    happy = HUMAN.morphs.index("happy")
    smile = np.array([0.0 if pose.morphs is None else pose.morphs[happy] for pose in poses])
    assert np.abs(np.diff(smile)).max() < 5.0 / RATE  # a smile is gone in 0.4 s
    assert smile[-1] == pytest.approx(0.0, abs=1e-6)


def test_eyes_alone_look_or_the_head_too_or_the_trunk():
    def yaws(influence):
        gaze = GazeIntent("g", np.array([0.3, 0.15, 0.2]), Times(0.0, 0.5), influence)
        _, poses = played(
            HUMAN, lambda _: BehaviourIntent(gazes=(gaze,)), 1.5, (StanceLayer, GazeLayer)
        )
        _, rest = played(HUMAN, lambda _: None, 1.5, (StanceLayer, GazeLayer))
        found = []
        for part in ("chest", "head"):
            joint = HUMAN.anatomy.joint(part)
            turned, own = (p[-1].globals(HUMAN.skeleton)[joint, :3, :3] for p in (poses, rest))
            ahead = turned @ own.T @ [0.0, 0.0, 1.0]
            found.append(math.degrees(math.atan2(ahead[0], ahead[2])))
        return found

    eyes, neck, waist = (yaws(each) for each in ("EYES", "NECK", "WAIST"))
    assert max(map(abs, eyes)) < 1.0
    assert abs(neck[0]) < 1.0
    assert neck[1] > 30.0
    assert waist[0] > 20.0
    assert waist[1] > 30.0


@pytest.mark.parametrize(
    "name", [*LEXEMES, *(f"AU{each}" for each in ACTION_UNITS), "disgust", "sad"]
)
def test_a_face_of_few_expressions_shows_something_for_every_name_it_can(name):
    mouth = ("aa", "ih", "ou", "ee", "oh", "viseme_PP")
    morphs = ("happy", "angry", "sad", "surprised", "relaxed", *mouth, "blink", "blinkLeft")
    shown = FaceNames(morphs).weights(name)
    assert shown is not None
    assert 0.0 < shown.max() <= 1.0


def test_a_name_that_a_face_does_not_have_is_not_shown():
    assert shown_by(("happy",), "AU4") is None
    assert shown_by(("happy",), "frobnicate") is None
    assert shown_by(("happy",), "neutral") == [0.0]


def test_one_brow_rises_where_a_face_can_do_so():
    brows = ("browOuterUpLeft", "browOuterUpRight")
    assert shown_by(brows, "RAISE_LEFT_BROW") == [1.0, 0.0]
    assert shown_by(brows, "RAISE_BROWS") == [1.0, 1.0]
    assert shown_by(("browOuterUp",), "AU2_RIGHT") == [1.0]
