"""The face: blinks, the expression of an emotion, and the mouth of a speech."""

import numpy as np

from cubeling.affect import Emotion
from cubeling.affect.words import WORD_LABELS
from cubeling.characters.control.layers.layer import FrameContext
from cubeling.characters.face.affect_display import EMOTIONAL_WORDS, FACE_RECIPES, AffectDisplay
from cubeling.characters.face.blink import BlinkTimer
from cubeling.characters.face.jaw import JawJoint
from cubeling.characters.face.lids import Lids, blink_shares
from cubeling.characters.face.speech_display import SpeechDisplay
from cubeling.characters.face.word_emotion import face_of
from cubeling.characters.model.character import Character
from cubeling.characters.skeleton.pose import Pose

WIDE_EYES_MORPH = "surprised"
"""A morph that opens the eyes wide, and keeps them from closing."""


class FaceLayer:
    """Sets the morphs of lids, expressions and speech."""

    def __init__(self, character: Character, seed: int) -> None:
        morphs = character.morphs
        self._count = len(morphs)
        self._lids = Lids.of(morphs)
        self._blinks = BlinkTimer(seed)
        self._display = AffectDisplay(morphs, blink_shares(morphs, character.meshes, self._lids))
        self._speech = SpeechDisplay(morphs, seed)
        self._jaw = JawJoint(character.skeleton, character.anatomy)
        self._wide = morphs.index(WIDE_EYES_MORPH) if WIDE_EYES_MORPH in morphs else None

    def update(self, pose: Pose, context: FrameContext) -> Pose:
        """Return the pose with lids and expression."""
        frame = context.frame
        speaking = context.speaking
        emotion = face_of(context.emotion, speaking.emotion)
        acted = frame.state if frame.shows_emotion else ""
        if acted and not _is_finer(emotion, acted):
            emotion, acted = None, ""
        self._display.update(context.elapsed, emotion, acted)
        closed = self._blinks.update(
            context.elapsed,
            context.gaze_shift,
            context.expressivity.tempo,
            talking=speaking.talking,
            phrase_ends=speaking.phrase_ends,
        )
        self._update_speech(context)
        if not self._lids and not self._display.active and not self._speech.active:
            return pose
        weights = np.zeros(self._count) if pose.morphs is None else pose.morphs.copy()
        if self._display.active:
            closing, lowered = self._display.apply(
                weights, context.elapsed, closed, float(frame.acting)
            )
            # A lid that an expression holds half closed is only closed by the other half.
            self._lids.close(weights, max(closed, lowered - closing))
            self._lids.limit(weights, 1.0 - closing)
        else:
            self._lids.close(weights, closed)
        if self._wide is not None:
            weights[self._wide] *= 1.0 - closed  # morphs add up: wide eyes would not close
        shown = pose.with_morphs(weights)
        if not self._speech.active:
            return shown
        self._speech.apply(weights, closed)
        return shown if self._speech.has_morphs else self._jaw.open_by(shown, self._speech.opening)

    def _update_speech(self, context: FrameContext) -> None:
        """Bring the mouth to the time of the frame."""
        speech, now = context.command.speech, context.command.timestamp
        if speech is None:
            self._speech.update(context.elapsed, None, 0.0, now, 0.0)
            return
        profile = speech.profile
        self._speech.visemes = profile.visemes
        self._speech.update(
            context.elapsed,
            speech.utterance,
            speech.start,
            now,
            profile.face_emphasis + speech.emphasis,
        )


def _is_finer(emotion: Emotion | None, action: str) -> bool:
    """Return whether an emotion has another face than an action that stands for its mood.

    A character that can act only angry is angry where it is afraid, but looks afraid.
    """
    word = (emotion and emotion.word) or ""
    if not {word, action} <= EMOTIONAL_WORDS & WORD_LABELS.keys():
        return False
    return WORD_LABELS[word] == WORD_LABELS[action] and FACE_RECIPES[word] != FACE_RECIPES[action]
