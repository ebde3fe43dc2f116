"""What is shown on a face, by name: expressions, emotions, BML's lexemes, action units, morphs.

Action units: Ekman and Friesen, *Facial Action Coding System*, 1978. Their parts of the face have
ARKit's names; a face without such parts shows the nearest expression that it has.
"""

import re
from collections.abc import Mapping, Sequence
from functools import cached_property

import numpy as np

from cubeling.characters.behaviour.intents import FaceIntent
from cubeling.characters.behaviour.realization.planned_values import presence
from cubeling.characters.face.affect_display import FACE_RECIPES
from cubeling.characters.face.expressions import EXPRESSIONS, ExpressionMorphs
from cubeling.characters.face.lids import Lids, numbers_by_name
from cubeling.characters.skeleton.pose import Array

Mix = Mapping[str, float]
"""Parts of a face, or expressions, with their weights."""

ACTION_UNITS: dict[int, tuple[Mix, Mix]] = {
    1: ({"browInnerUp": 1.0}, {"sad": 0.6}),
    2: ({"browOuterUp": 1.0}, {"surprised": 0.5}),
    4: ({"browDown": 1.0}, {"angry": 0.6}),
    5: ({"eyeWide": 1.0}, {"surprised": 0.5}),
    6: ({"cheekSquint": 1.0, "eyeSquint": 0.4}, {"relaxed": 0.5}),
    7: ({"eyeSquint": 1.0}, {"relaxed": 0.4}),
    9: ({"noseSneer": 1.0}, {"angry": 0.5}),
    10: ({"mouthUpperUp": 1.0}, {"angry": 0.4}),
    12: ({"mouthSmile": 1.0}, {"happy": 0.8}),
    14: ({"mouthDimple": 1.0}, {"happy": 0.3}),
    15: ({"mouthFrown": 1.0}, {"sad": 0.7}),
    16: ({"mouthLowerDown": 1.0}, {"ee": 0.4}),
    17: ({"mouthShrugLower": 1.0}, {"sad": 0.4}),
    18: ({"mouthPucker": 1.0}, {"ou": 0.9}),
    20: ({"mouthStretch": 1.0}, {"ee": 0.6}),
    22: ({"mouthFunnel": 1.0}, {"ou": 0.7}),
    23: ({"mouthRollUpper": 0.6, "mouthRollLower": 0.6}, {"viseme_PP": 0.5}),
    24: ({"mouthPress": 1.0}, {"viseme_PP": 0.8}),
    25: ({"mouthLowerDown": 0.4, "mouthUpperUp": 0.3}, {"ih": 0.4}),
    26: ({"jawOpen": 0.5}, {"aa": 0.5}),
    27: ({"jawOpen": 1.0}, {"aa": 1.0}),
    43: ({"eyeBlink": 1.0}, {"blink": 1.0}),
    45: ({"eyeBlink": 1.0}, {"blink": 1.0}),
    46: ({"eyeBlinkLeft": 1.0}, {"blinkLeft": 1.0}),
}
"""For each action unit the parts of the face that show it, and what a face without them shows."""

LEXEMES: dict[str, tuple[str, ...]] = {
    "OBLIQUE_BROWS": ("AU1",),
    "RAISE_BROWS": ("AU1", "AU2"),
    "RAISE_LEFT_BROW": ("AU2_LEFT",),
    "RAISE_RIGHT_BROW": ("AU2_RIGHT",),
    "LOWER_BROWS": ("AU4",),
    "LOWER_LEFT_BROW": ("AU4_LEFT",),
    "LOWER_RIGHT_BROW": ("AU4_RIGHT",),
    "RAISE_MOUTH_CORNERS": ("AU12",),
    "LOWER_MOUTH_CORNERS": ("AU15",),
    "OPEN_MOUTH": ("AU26",),
    "OPEN_LIPS": ("AU25",),
    "WIDEN_EYES": ("AU5",),
    "CLOSE_EYES": ("AU43",),
    "BLINK": ("AU45",),
    "SMILE": ("AU12",),
    "PUCKER": ("AU18",),
}
"""Action units of BML's lexemes; `_LEFT` and `_RIGHT` are for one side, where a face can do so."""

NEUTRAL_NAMES = ("neutral", "rest", "none")
"""Names of a face at rest, which every face can show."""

_SIDES = {"": ("left", "right", "l", "r"), "left": ("left", "l"), "right": ("right", "r")}
_AU = re.compile(r"au_?(\d+)(?:_(left|right))?", re.IGNORECASE)


class FaceNames:
    """What names mean for one face.

    `morphs` are the names of the character's morphs.
    """

    def __init__(self, morphs: Sequence[str]) -> None:
        self._morphs = tuple(morphs)
        self._found: dict[str, Array | None] = {}

    def weights(self, name: str) -> Array | None:
        """Return the morph weights (morphs,) that a name stands for; None if it cannot be shown.

        Case does not matter.

        >>> FaceNames(["happy", "browDown"]).weights("AU4").tolist()
        [0.0, 1.0]
        """
        if name not in self._found:
            self._found[name] = self._resolve(name)
        return self._found[name]

    def morph_weights(self, intents: Sequence[FaceIntent], now: float) -> Array:
        """Return the morph weights that intents show at a time [s], (morphs,)."""
        total = np.zeros(len(self._morphs))
        for intent in intents:
            there = presence(intent.times, now)
            for name, weight in zip(intent.names, intent.weights, strict=True):
                shown = self.weights(name)
                if shown is not None and there > 0.0:
                    total += there * weight * shown
        return total

    @cached_property
    def _numbers(self) -> dict[str, int]:
        return numbers_by_name(self._morphs)

    @cached_property
    def _expressions(self) -> dict[str, Array]:
        found, shown = ExpressionMorphs.of(self._morphs), {}
        for column, (name, able) in enumerate(zip(EXPRESSIONS, found.able, strict=True)):
            if able:
                shown[name] = np.zeros(len(self._morphs))
                shown[name][found.numbers] = found.weights[:, column]
        return shown

    def _resolve(self, name: str) -> Array | None:
        lower = name.lower()
        if lower in NEUTRAL_NAMES:
            return np.zeros(len(self._morphs))
        unit = _AU.fullmatch(name)
        if unit is not None:
            return self._unit(int(unit[1]), (unit[2] or "").lower())
        if name.upper() in LEXEMES:
            parts = [self._resolve(each) for each in LEXEMES[name.upper()]]
            able = [part for part in parts if part is not None]
            return np.minimum(np.sum(able, axis=0), 1.0) if able else None
        if lower in FACE_RECIPES:
            *recipe, closed = FACE_RECIPES[lower]
            mixed = self._mix(dict(zip(EXPRESSIONS, recipe, strict=True)))
            if mixed is not None:
                Lids.of(self._morphs).close(mixed, closed)
            return mixed
        return self._mix({name: 1.0})

    def _unit(self, number: int, side: str) -> Array | None:
        for mix in ACTION_UNITS.get(number, ()):
            shown = self._mix(mix, side)
            if shown is not None:
                return shown
        return None

    def _mix(self, mix: Mix, side: str = "") -> Array | None:
        """Return the weights of a mix of parts and expressions; None if the face has none."""
        total, able = np.zeros(len(self._morphs)), False
        for name, weight in mix.items():
            if name.lower() in self._expressions:
                total += weight * self._expressions[name.lower()]
                able = True
                continue
            for number in self._part(name, side):
                total[number] += weight
                able = True
        return total if able else None

    def _part(self, name: str, side: str) -> set[int]:
        """Return the morphs of a part of the face, on one side if there are any, else whole."""
        stem = re.sub(r"[\W_]", "", name).lower()
        sides = {self._numbers[stem + s] for s in _SIDES[side] if stem + s in self._numbers}
        if stem in self._numbers and not (side and sides):
            return {self._numbers[stem]}
        return sides
