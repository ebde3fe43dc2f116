"""Faces of every family speak by their own morphs, without configuration."""

import numpy as np
import pytest

from cubeling.characters.face.visemes.mouth_morphs import MouthMorphs
from cubeling.characters.face.visemes.sets import MOUTH_SHAPES

OCULUS = [f"viseme_{shape}" for shape in MOUTH_SHAPES]
VRCHAT = [f"vrc.v_{shape.lower()}" for shape in MOUTH_SHAPES[:12]] + [
    "vrc.v_ih",
    "vrc.v_oh",
    "vrc.v_ou",
]
ARKIT = [
    *("eyeBlinkLeft", "eyeBlinkRight", "jawOpen", "jawForward", "mouthClose", "mouthFunnel"),
    *("mouthPucker", "mouthRollLower", "mouthRollUpper", "mouthPressLeft", "mouthPressRight"),
    *("mouthStretchLeft", "mouthStretchRight", "mouthSmileLeft", "mouthSmileRight", "tongueOut"),
    *("mouthUpperUpLeft", "mouthUpperUpRight", "mouthLowerDownLeft", "mouthLowerDownRight"),
]
VRM = ["happy", "blink", "aa", "ih", "ou", "ee", "oh"]
VRM_0 = ["joy", "a", "i", "u", "e", "o"]
VROID = [f"Face.Fcl_MTH_{vowel}" for vowel in "AIUEO"]
MIKU = ["まばたき", "あ", "い", "う", "え", "お", "ん"]
FAMILIES = {
    "oculus": (OCULUS, "visemes"), "vrchat": (VRCHAT, "visemes"), "arkit": (ARKIT, "arkit"),
    "vrm": (VRM, "vowels"), "vrm 0": (VRM_0, "vowels"), "vroid": (VROID, "vowels"),
    "miku": (MIKU, "vowels"), "jaw": (["Mouth_Open"], "jaw"),
    "both": ([*OCULUS, *ARKIT], "visemes"), "none": (["blink", "smirk"], ""),
}  # fmt: skip


def shown(morphs: list[str], shape: str, level: int = 1) -> dict[str, float]:
    """Return the weights above 0 of a shape."""
    mouth, shapes = MouthMorphs.of(morphs), np.zeros((3, len(MOUTH_SHAPES)))
    shapes[level, MOUTH_SHAPES.index(shape)] = 1.0
    weights = mouth.of_shapes(shapes).tolist()
    names = [morphs[number] for number in mouth.numbers.tolist()]
    return {name: weight for name, weight in zip(names, weights, strict=True) if weight > 0}


@pytest.mark.parametrize("name", FAMILIES)
def test_a_face_speaks_by_its_richest_family_alone(name):
    morphs, family = FAMILIES[name]
    mouth = MouthMorphs.of(morphs)
    assert mouth.family == family
    assert bool(mouth) == (family != "")
    assert mouth.weights.min(initial=0.0) >= 0
    assert mouth.weights.max(initial=0.0) <= 1
    if name == "both":
        assert all(number < len(OCULUS) for number in mouth.numbers)


@pytest.mark.parametrize("name", [name for name in FAMILIES if name != "none"])
def test_vowels_open_lips_close_and_emphasis_grows(name):
    morphs, _ = FAMILIES[name]
    assert sum(shown(morphs, "aa").values()) > 0.4
    assert shown(morphs, "sil") == {}
    levels = [sum(shown(morphs, "aa", level).values()) for level in range(3)]
    assert levels[0] < levels[1] < levels[2]
    assert shown(morphs, "FF", 0) == shown(morphs, "FF", 2)


def test_arkit_faces_press_and_round_their_lips():
    assert "jawOpen" not in shown(ARKIT, "PP")
    assert shown(ARKIT, "PP")["mouthPressLeft"] == shown(ARKIT, "PP")["mouthPressRight"]
    assert shown(ARKIT, "U")["mouthPucker"] > 0.5
    assert shown(ARKIT, "TH")["tongueOut"] > 0.2
