"""A character shows what it feels: on its face, and in how it bears itself."""

import dataclasses
import functools
import itertools
import math

import numpy as np
import pytest
from hypothesis import Phase, given, settings, strategies as st

from cubeling.affect import Emotion
from cubeling.affect.words import WORD_PLACES
from cubeling.characters import (
    ActionIntent,
    Animator,
    CharacterCommand,
    LocomotionIntent,
)
from cubeling.characters.body.posture import (
    NEUTRAL_EXPRESSIVITY,
    ExpressivityFilter,
    Posture,
    expressivity_of,
)
from cubeling.characters.control.controllers.in_place import InPlaceController
from cubeling.characters.face.affect_display import FACE_RECIPES, AffectDisplay, expression_weights
from cubeling.characters.face.blink import BlinkTimer
from cubeling.characters.face.expressions import EXPRESSIONS, ExpressionMorphs
from cubeling.characters.face.lids import Lids, blink_shares
from cubeling.characters.model.character import skin
from tests.bundled_characters import bundled_character
from tests.characters.commands import command
from tests.examples import examples, some

STEP_S = 1 / 30
MAX_WEIGHT_RATE = 8.0
"""What a morph of a face may change by at most [1/s]; a lid that falls is faster."""

SEED = 2
"""That of the characters and of their animators, which then share the gaits of a character."""

CAST = {
    name: dataclasses.replace(bundled_character(name), seed=SEED)
    for name in ("human", "vleo", "robot")
}
ACTIONS = {name: ("idle", *Animator(character).actions) for name, character in CAST.items()}

GAZE = np.array([0.1, 0.15, 1.0])


@pytest.fixture(scope="module", params=some(["human", "vleo", "robot"], 2))
def someone(request):
    return CAST[request.param]


def lived(character, feelings, action="idle"):
    """Return the poses of frames with (valence, arousal, word) or None each."""
    animator = Animator(character, seed=SEED)
    poses = []
    for number, felt in enumerate(feelings):
        emotion = None if felt is None else Emotion(*felt)
        asked = command(number * STEP_S, action, gaze=GAZE, emotion=emotion)
        poses.append(animator.update(asked).pose)
    return poses


def felt(word, seconds):
    return [(*WORD_PLACES[word], word)] * round(seconds / STEP_S)


@functools.cache
def four_seconds(name, word):
    """Return the poses of a character that feels one thing; tests look at parts of them."""
    return lived(CAST[name], felt(word, 4))


def face(character, pose):
    """Return the weights of the expressions, in the order of `EXPRESSIONS`."""
    return np.array([pose.morphs[character.morphs.index(name)] for name in EXPRESSIONS])


def pitch(character, pose):
    """Return how far the head looks up [rad]."""
    head = character.anatomy.joint("head")
    rest = character.skeleton.rest.globals(character.skeleton)[head, :3, :3]
    ahead = pose.globals(character.skeleton)[head, :3, :3] @ rest.T @ [0.0, 0.0, 1.0]
    return math.asin(ahead[1] / np.linalg.norm(ahead))


def test_who_feels_nothing_moves_as_ever_to_the_bit(someone):
    never = lived(someone, [None] * 45)
    neutral = lived(someone, [(0.0, 0.0, "neutral")] * 45)
    for one, other in zip(never, neutral, strict=True):
        assert one.rotations.tobytes() == other.rotations.tobytes()
        assert one.translations.tobytes() == other.translations.tobytes()
        assert one.morphs.tobytes() == other.morphs.tobytes()


def test_a_feeling_that_is_over_leaves_nothing_behind(someone):
    expressivity = ExpressivityFilter()
    own = AffectDisplay(someone.morphs, np.zeros(len(someone.morphs)))
    for number in range(900):
        emotion = Emotion(-0.7, 0.6, "angry") if number < 60 else None
        expressivity.update(STEP_S, emotion)
        own.update(STEP_S, emotion)
    assert expressivity.value is NEUTRAL_EXPRESSIVITY
    assert not own.active


@pytest.mark.parametrize("word", some(["happy", "sad", "angry", "surprised"], 2))
def test_a_face_says_what_is_felt(someone, word):
    shown = face(someone, four_seconds(someone.name, word)[-1])
    assert EXPRESSIONS[int(np.argmax(shown))] == word
    assert shown.max() > 0.75
    others = np.delete(shown, EXPRESSIONS.index(word))
    assert others.max() < 0.3


def test_the_sleepy_have_heavy_lids_and_bow_their_heads(someone):
    awake, sleepy = (four_seconds(someone.name, word)[-40:] for word in ("neutral", "sleepy"))
    blinks = blink_shares(someone.morphs, someone.meshes, Lids.of(someone.morphs))
    assert min(float(pose.morphs @ blinks) for pose in sleepy) > 0.5
    assert min(float(pose.morphs @ blinks) for pose in awake) < 0.1
    assert pitch(someone, sleepy[-1]) < pitch(someone, awake[-1]) - math.radians(3)


def test_the_sad_hang_their_heads_and_the_happy_hold_them_high(someone):
    sad, plain, happy = (
        np.mean([pitch(someone, pose) for pose in four_seconds(someone.name, word)[-60:]])
        for word in ("sad", "neutral", "happy")
    )
    assert sad + math.radians(10) < plain < happy - math.radians(5)


@pytest.mark.parametrize("valence", [-0.8, -0.3, 0.3, 0.8])
def test_without_a_word_or_with_an_unknown_one_the_place_tells(valence):
    for word in ("", "jaunty", "neutral"):
        happy, angry, sad, *_ = expression_weights(Emotion(valence, 0.2, word))
        assert (happy > angry + sad) == (valence > 0)


def test_every_word_that_pleases_smiles_and_none_that_hurts():
    for word, place in WORD_PLACES.items():
        happy, angry, sad, surprised, relaxed, _ = expression_weights(Emotion(*place, word))
        if place[0] > 0.2:
            assert happy + relaxed > angry + sad, word
        if place[0] < -0.2 and place[1] > -0.5:
            assert angry + sad > happy + relaxed, word
        if word in FACE_RECIPES:
            assert max(happy, angry, sad, surprised, relaxed) > 0.2, word


def test_who_is_called_angry_looks_angry_from_the_first(someone):
    shown = face(someone, lived(someone, [(-0.3, 0.3, "angry")] * 90)[-1])
    assert shown[EXPRESSIONS.index("angry")] > 0.35


words = st.sampled_from(["", "neutral", "unheard of", *FACE_RECIPES])
moods = st.tuples(st.floats(-1, 1), st.floats(-1, 1), words)


@settings(
    max_examples=examples(20), deadline=None, phases=(Phase.explicit, Phase.reuse, Phase.generate)
)
@given(
    name=st.sampled_from(list(CAST)),
    plan=st.lists(st.tuples(st.one_of(st.none(), moods), st.integers(1, 15)), max_size=6),
    action=st.integers(0, 9),
)
def test_no_morph_leaves_its_range_and_none_pops(name, plan, action):
    character = CAST[name]
    actions = ACTIONS[name]
    frames = list(itertools.chain.from_iterable([mood] * count for mood, count in plan))
    poses = lived(character, frames, actions[action % len(actions)])
    plain = lived(character, [None] * len(frames), actions[action % len(actions)])
    numbers = [character.morphs.index(name) for name in EXPRESSIONS]
    if not poses:
        return
    weights = np.array([pose.morphs for pose in poses])
    clips = np.array([pose.morphs for pose in plain])
    assert np.isfinite(weights).all()
    assert weights.min() >= 0.0
    assert weights.max() <= max(1.0, clips.max()) + 1e-9
    allowed = np.abs(np.diff(clips[:, numbers], axis=0)) + MAX_WEIGHT_RATE * STEP_S
    surprised = EXPRESSIONS.index("surprised")  # falls with the lids
    allowed[:, surprised] += 12.0 * STEP_S
    assert (np.abs(np.diff(weights[:, numbers], axis=0)) <= allowed).all()


def test_a_bearing_changes_without_a_jolt():
    posture = Posture(CAST["human"].skeleton, CAST["human"].anatomy, np.zeros(0, np.intp))
    expressivity = ExpressivityFilter()
    last = posture.rotation_vectors(expressivity.value, 1.0)
    for number in range(300):
        expressivity.update(
            STEP_S, (Emotion(-1, -1), Emotion(1, 1), Emotion(-1, 1))[number // 20 % 3]
        )
        now = posture.rotation_vectors(expressivity.value, 1.0)
        assert np.abs(now - last).max() < math.radians(45) * STEP_S
        last = now


WORDS = ("happy", "sad", "angry", "surprised", *sorted(FACE_RECIPES.keys() & WORD_PLACES.keys()))


@pytest.mark.parametrize("word", some(dict.fromkeys(WORDS), 4))
def test_a_blink_closes_the_eyes_whatever_is_felt(someone, word):
    lids = Lids.of(someone.morphs)
    blinks = blink_shares(someone.morphs, someone.meshes, lids)
    own = AffectDisplay(someone.morphs, blinks)
    for _ in range(150):
        own.update(STEP_S, Emotion(*WORD_PLACES[word], word))
    weights = np.zeros(len(someone.morphs))
    shut, _ = own.apply(weights, STEP_S, 1.0, 0.0)
    lids.close(weights, 1.0)
    lids.limit(weights, 1.0 - shut)
    blink = {"blink": 1.0}
    shown = dict(zip(someone.morphs, weights, strict=True))
    left = []
    at_rest = someone.skeleton.rest.globals(someone.skeleton)
    for mesh in someone.meshes:
        way = skin(mesh, at_rest, blink) - skin(mesh, at_rest)
        lid = np.linalg.norm(way, axis=1) > 1e-6
        done = skin(mesh, at_rest, shown) - skin(mesh, at_rest)
        lengths = np.einsum("va,va->v", way[lid], way[lid])
        left += list(np.einsum("va,va->v", way[lid], done[lid]) / lengths)
    # Where a lid is slanted its outer end may be a little behind.
    assert np.quantile(left, 0.15) > 0.85


def test_an_action_that_speaks_wins_and_the_mood_comes_back():
    vleo = CAST["vleo"]
    sad = felt("sad", 8)
    kissing = lived(vleo, sad, "kiss")[60:]
    plain = lived(vleo, [None] * len(sad), "kiss")[60:]
    for one, other in zip(kissing, plain, strict=True):
        assert face(vleo, one)[EXPRESSIONS.index("sad")] < 0.25
        lips = vleo.morphs.index("ou")
        assert one.morphs[lips] == pytest.approx(other.morphs[lips], abs=0.25)
    animator = Animator(vleo)
    for number in range(270):
        action = "kiss" if number < 120 else "idle"
        command = CharacterCommand(
            number * STEP_S,
            action=ActionIntent(action),
            emotion=Emotion(*WORD_PLACES["sad"], "sad"),
        )
        pose = animator.update(command).pose
    assert face(vleo, pose)[EXPRESSIONS.index("sad")] > 0.6


def test_a_clip_named_by_a_mood_shows_it_without_the_face_doing_so_twice():
    robot = CAST["robot"]
    pose = lived(robot, felt("happy", 3), "happy")[-1]
    assert not face(robot, pose).any()
    assert face(robot, lived(robot, felt("sad", 3), "neutral")[-1])[2] > 0.6


def test_a_smile_of_the_clip_does_not_stay_on_an_angry_face():
    human = CAST["human"]
    animator = Animator(human)
    for number in range(120):
        command = CharacterCommand(
            number * STEP_S,
            LocomotionIntent(5.0, np.array([0.0, 99.0])),
            emotion=Emotion(*WORD_PLACES["angry"], "angry"),
        )
        posed = animator.update(command)
    assert posed.state == "run"
    assert face(human, posed.pose)[0] < 0.1


def test_arousal_quickens_and_enlarges_and_calm_does_the_opposite():
    calm, plain, stirred = (
        expressivity_of(0.0, -0.9),
        expressivity_of(0.0, 0.0),
        expressivity_of(0.0, 0.9),
    )
    assert calm.tempo < plain.tempo == 1.0 < stirred.tempo
    assert calm.amplitude < plain.amplitude == 1.0 < stirred.amplitude
    counts = []
    for tempo in (calm.tempo, stirred.tempo):
        blinking = BlinkTimer(4)
        lids = np.array([blinking.update(1 / 60, tempo=tempo) for _ in range(60 * 300)])
        counts.append(int(((lids[1:] > 0.9) & (lids[:-1] <= 0.9)).sum()))
    assert counts[1] > 1.5 * counts[0]


def test_a_calm_animal_idles_more_slowly():
    """After the emotion has built up, a second of idling shows another part of the clip."""
    vleo = CAST["vleo"]
    slow, quick = InPlaceController(vleo, 1.0, None), InPlaceController(vleo, 1.0, None)
    for _ in range(30):
        one = slow.update(CharacterCommand(0.0), 0.06).pose
        other = quick.update(CharacterCommand(0.0), 0.04, tempo=1.5).pose
    np.testing.assert_allclose(one.rotations, other.rotations, atol=1e-9)
    calm, plain, excited = (
        expressivity_of(*WORD_PLACES[word]).tempo for word in ("sleepy", "neutral", "excited")
    )
    assert calm < 0.81
    assert plain == 1.0
    assert excited > 1.21


@pytest.mark.parametrize(
    ("names", "able"),
    [
        (["Joy", "Angry", "Sorrow", "Fun", "Surprised"], EXPRESSIONS),
        (["Fcl_ALL_Joy", "Fcl_ALL_Sorrow"], ("happy", "sad")),
        (["mouthSmileLeft", "mouthSmileRight", "jawOpen"], ("happy", "relaxed")),
        (["browInnerUp", "eyeWide_L", "eyeWide_R"], ("sad", "surprised")),
        (["jawOpen", "eyeBlinkLeft", "eyeBlinkRight", "eyeSquintLeft"], ()),
    ],
)
def test_faces_are_made_of_whatever_morphs_there_are(names, able):
    found = ExpressionMorphs.of(names)
    assert tuple(name for name, there in zip(EXPRESSIONS, found.able, strict=True) if there) == able
    assert found.weights.max(initial=0.0) <= 1.0


def test_a_body_without_a_face_shows_it_in_its_bearing():
    human = CAST["human"]
    meshes = tuple(dataclasses.replace(mesh, morphs=()) for mesh in human.meshes)
    faceless = dataclasses.replace(human, meshes=meshes, morphs=())
    sad, plain = Animator(faceless), Animator(faceless)
    for number in range(90):
        bowed = sad.update(
            CharacterCommand(number * STEP_S, emotion=Emotion(*WORD_PLACES["sad"], "sad"))
        ).pose
        straight = plain.update(CharacterCommand(number * STEP_S)).pose
    assert pitch(human, bowed) < pitch(human, straight) - math.radians(4)
