"""A character that speaks: its lips, who owns the mouth, cuts, and nothing without speech."""

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cubeling.affect import Emotion
from cubeling.characters.control.animator import Animator
from cubeling.characters.control.command import ActionIntent, CharacterCommand, SpeechIntent
from cubeling.characters.control.layers.face import FaceLayer
from cubeling.characters.control.speaking.state import NOT_SPEAKING
from cubeling.characters.face.speech_display import CLOSING_S
from cubeling.characters.model.character import Character
from cubeling.characters.speech.speech import Accent, Phone, Utterance
from tests.characters.face.mouths import MeasuredMouth
from tests.characters.face.test_coarticulation import spoken
from tests.examples import some

RATE = 30.0
HAPPY = Emotion(0.7, 0.6, "happy")
FELT = (None, HAPPY, Emotion(-0.6, -0.4, "sad"), Emotion(-0.7, 0.6, "angry"), Emotion(0.1, 0.8))
SYLLABLES = spoken(*[(symbol, 0.125) for symbol in "ɑmɑbifɑvupɔmɛfi"])


@pytest.fixture(scope="module", params=["human", "vleo"])
def speaker(request) -> Character:
    return Character.load(request.param)


@pytest.fixture(scope="module")
def mouth(speaker) -> MeasuredMouth:
    return MeasuredMouth.of(speaker)


def shown(character: Character, commands: list[CharacterCommand], seed: int = 0) -> np.ndarray:
    """Return the morph weights of the face under commands, (frames, morphs)."""
    animator = Animator(character, layers=(FaceLayer,), seed=seed)
    poses = [animator.update(command).pose for command in commands]
    nothing = np.zeros(len(character.morphs))
    return np.array([nothing if pose.morphs is None else pose.morphs for pose in poses])


def commands(
    said: Utterance | None, until: float, emotion: Emotion | None = None, action: str | None = None
) -> list[CharacterCommand]:
    """Return commands that say something from 0.5 s on."""
    intent = None if said is None else SpeechIntent(said, 0.5)
    acting = None if action is None else ActionIntent(action, 1.0)
    times = np.arange(0.0, until, 1 / RATE).tolist()
    return [CharacterCommand(t, speech=intent, emotion=emotion, action=acting) for t in times]


def smallest(gaps: np.ndarray, symbols: str) -> float:
    """Return the largest, over phones, of their smallest gap."""
    times = np.arange(len(gaps)) / RATE - 0.5
    found = [
        gaps[(times >= phone.start) & (times < phone.end)].min()
        for phone in SYLLABLES.phones
        if phone.symbol in symbols
    ]
    return float(max(found))


@pytest.mark.parametrize("emotion", some(FELT, 2))
def test_lips_close_and_teeth_touch_at_eight_phones_a_second_whatever_is_felt(
    speaker, mouth, emotion
):
    weights = shown(speaker, commands(SYLLABLES, 2.5, emotion))
    opened = np.zeros(len(speaker.morphs))
    opened[speaker.morphs.index("viseme_aa")] = 1.0
    widest = float(mouth.gap(opened))
    assert smallest(mouth.gap(weights), "pbm") <= 0.02 * widest
    assert smallest(mouth.teeth_over_lip(weights), "fv") <= 0.02 * widest
    assert mouth.gap(weights).max() > 0.35 * widest


def test_vowels_are_wide_or_narrow_as_they_should(speaker, mouth):
    weights = shown(speaker, commands(spoken(("u", 0.3), ("i", 0.3)), 1.2))
    rounded, spread = (mouth.width(weights[round((0.5 + t) * RATE)]) for t in (0.15, 0.45))
    assert rounded < 0.7 * mouth.width(np.zeros(len(speaker.morphs)))
    assert spread > 1.3 * rounded


def test_without_speech_a_face_is_as_it_was(speaker):
    silent = shown(speaker, commands(None, 2.0, HAPPY))
    never = replace(SYLLABLES, phones=(Phone("", 0.0, 1.0),), duration=1.0)
    future = [replace(c, speech=SpeechIntent(never, 100.0)) for c in commands(None, 2.0, HAPPY)]
    assert np.array_equal(silent, shown(speaker, future))
    assert not silent[:, len(speaker.morphs) - 25 :].any()  # the morphs of speech


def test_a_face_that_never_speaks_or_feels_is_left_alone(speaker):
    bare = replace(speaker, morphs=(), standing=None)
    pose, layer = bare.skeleton.rest, FaceLayer(bare, 0)
    frame = SimpleNamespace(shows_emotion=False, acting=0.0)
    for command in commands(None, 0.5):
        context: Any = SimpleNamespace(
            frame=frame, elapsed=1 / RATE, command=command, emotion=None, gaze_shift=0.0,
            expressivity=SimpleNamespace(tempo=1.0),
            speaking=NOT_SPEAKING,
        )  # fmt: skip
        assert layer.update(pose, context) is pose


def test_the_mouth_belongs_to_the_speech_and_the_brows_to_the_expression(speaker, mouth):
    plain = shown(speaker, commands(SYLLABLES, 2.5))
    happy = shown(speaker, commands(SYLLABLES, 2.5, HAPPY))
    alone = shown(speaker, commands(None, 2.5, HAPPY))
    within = slice(round(0.7 * RATE), round(2.0 * RATE))
    smile = float(mouth.gap(alone[within]).max())
    error = np.abs(mouth.gap(happy[within]) - mouth.gap(plain[within])).max()
    assert error < 0.3 * smile
    number = speaker.morphs.index("happy")
    assert np.allclose(happy[within, number], alone[within, number])


def test_the_mouth_never_jumps_and_closes_softly_after_a_cut(speaker, mouth):
    other = spoken(("i", 0.2), ("m", 0.1), ("u", 0.2))
    times = np.arange(0.0, 3.0, 1 / 120).tolist()
    first, second = SpeechIntent(SYLLABLES, 0.5), SpeechIntent(other, 1.29)
    said = [
        CharacterCommand(t, speech=None if t > 1.6 else second if t >= 1.29 else first)
        for t in times
    ]
    gap = mouth.gap(shown(speaker, said))
    rest = gap[0]
    usual = np.abs(np.diff(gap[: round(1.28 * 120)])).max()
    assert np.abs(np.diff(gap)).max() <= 1.05 * usual
    assert gap[round(1.6 * 120)] > rest + 0.002
    assert np.allclose(gap[round((1.62 + CLOSING_S) * 120) :], rest, atol=1e-6)


def test_a_speech_that_cuts_in_is_in_time_at_once(speaker, mouth):
    alone = mouth.gap(shown(speaker, commands(SYLLABLES, 2.5)))
    before = SpeechIntent(spoken(("ɔ", 0.4), ("i", 0.4)), 0.0)
    cutting = [
        c if c.timestamp >= 0.5 else replace(c, speech=before) for c in commands(SYLLABLES, 2.5)
    ]
    cut = mouth.gap(shown(speaker, cutting))
    assert np.allclose(cut[round(0.62 * RATE) :], alone[round(0.62 * RATE) :], atol=1e-9)


def test_a_speech_that_a_replay_makes_again_is_the_same_speech(speaker):
    again = [
        replace(c, speech=SpeechIntent(replace(SYLLABLES, text=str(SYLLABLES.text)), 0.5))
        for c in commands(None, 2.0)
    ]
    assert np.array_equal(shown(speaker, again), shown(speaker, commands(SYLLABLES, 2.0)))


def test_the_mouth_of_a_kiss_gives_way_to_a_speech_and_returns(speaker):
    if speaker.name != "vleo":
        pytest.skip("only Vleo kisses")
    plain = shown(speaker, commands(None, 2.6, action="kiss"))
    said = spoken(*[("ɑ", 0.2)] * 10)
    spoke = shown(speaker, commands(said, 2.6, action="kiss"))
    pout, opened = (speaker.morphs.index(name) for name in ("ou", "viseme_aa"))
    kissing = plain[:, pout] > 0.9
    assert kissing.any()
    assert spoke[kissing, pout].max() < 0.01
    assert spoke[kissing, opened].min() > 0.5


def test_brows_rise_with_most_accents_and_not_always_alike(speaker):
    accents = tuple(Accent(0.5 + n, 0.9) for n in range(12))
    said = replace(spoken(*[("ɑ", 0.25)] * 50), accents=accents)
    raised = shown(speaker, commands(said, 13.0))[:, speaker.morphs.index("browInnerUp")]
    peaks = np.array(
        [raised[round((1.0 + n) * RATE) - 3 : round((1.0 + n) * RATE) + 3].max() for n in range(12)]
    )
    assert 4 <= np.count_nonzero(peaks > 0.2) <= 12
    assert np.ptp(peaks[peaks > 0.2]) > 0.05
    assert raised.max() <= 1.0


def test_a_face_without_morphs_speaks_by_its_jaw(speaker):
    if speaker.name != "vleo":
        pytest.skip("only Vleo has a jaw")
    bare = replace(
        speaker,
        morphs=(),
        meshes=tuple(replace(mesh, morphs=()) for mesh in speaker.meshes),
        clips={
            name: replace(clip, poses=replace(clip.poses, morphs=None))
            for name, clip in speaker.clips.items()
        },
        standing=None,
    )
    animator = Animator(bare, layers=(FaceLayer,))
    still = Animator(bare, layers=())
    jaw = bare.skeleton.index("jaw")
    turned = []
    for command in commands(SYLLABLES, 2.5):
        spoke, rest = animator.update(command).pose, still.update(command).pose
        turned.append(1 - abs(float(spoke.rotations[jaw] @ rest.rotations[jaw])))
        assert np.array_equal(np.delete(spoke.rotations, jaw, 0), np.delete(rest.rotations, jaw, 0))
    assert max(turned) > 0.002
    assert turned[0] == pytest.approx(0.0, abs=1e-9)
