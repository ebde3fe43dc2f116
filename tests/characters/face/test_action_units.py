"""Action units are read off morph weights, and drive the wrinkle layers of the thesis' table."""

import numpy as np
import pytest

from cubeling.characters import Character
from cubeling.characters.face.action_units import WRINKLE_UNITS, ActionUnits, layer_intensities
from cubeling.characters.model.face_maps import LAYER_NAMES, WRINKLE_LAYERS

FACE_PARTS = ("AU1", "AU2_L", "AU2_R", "AU4", "au06Left", "au06Right", "AU10_L", "AU10_R",
              "AU12_L", "AU12_R", "AU20_L", "AU20_R")  # fmt: skip


def layers_of(morphs, **weights):
    """Return which layers a face with some weights shows."""
    values = np.array([weights.get(name, 0.0) for name in morphs])
    return set(np.flatnonzero(layer_intensities(ActionUnits.of(morphs).intensities(values))))


def test_the_table_is_that_of_the_thesis():
    assert WRINKLE_LAYERS == {
        1: (0,), 2: (1, 2), 4: (3,), 6: (4, 5), 10: (6, 7), 12: (8, 9), 20: (10, 11)
    }  # fmt: skip
    assert sorted(sum(WRINKLE_LAYERS.values(), ())) == list(range(12))
    assert len(LAYER_NAMES) == 12


@pytest.mark.parametrize("layer", range(12))
def test_a_morph_named_after_a_unit_and_a_side_shows_its_layer_alone(layer):
    assert layers_of(FACE_PARTS, **{FACE_PARTS[layer]: 1.0}) == {layer}


def test_raised_brows_show_the_three_layers_of_the_forehead():
    assert layers_of(FACE_PARTS, AU1=1.0, AU2_L=1.0, AU2_R=1.0) == {0, 1, 2}
    assert layers_of(("browInnerUp", "browOuterUp"), browInnerUp=1.0, browOuterUp=1.0) == {0, 1, 2}


def test_names_of_arkit_have_sides():
    morphs = ("mouthSmileLeft", "mouthStretch_R", "Head.cheekSquintLeft", "noseSneerRight")
    shown = layers_of(morphs, mouthSmileLeft=1.0, mouthStretch_R=1.0)
    assert shown == {8, 11}
    assert layers_of(morphs, **{"Head.cheekSquintLeft": 1.0, "noseSneerRight": 1.0}) == {4, 7}


def test_a_smile_that_speech_takes_off_the_mouth_leaves_the_crow_s_feet():
    morphs = ("happy", "happyMouth")
    assert layers_of(morphs, happy=1.0) == {4, 5, 8, 9}
    assert layers_of(morphs, happy=1.0, happyMouth=-1.0) == {4, 5}


def test_intensities_stay_within_one():
    units = ActionUnits.of(("happy", "mouthSmile"))
    full = units.intensities(np.array([1.0, 1.0]))
    assert full.max() == 1.0
    assert not units.intensities(np.array([-1.0, 0.0])).any()
    assert not units.intensities(None).any()


def test_a_layer_for_both_sides_has_their_mean():
    units = np.zeros((len(WRINKLE_UNITS), 2))
    units[WRINKLE_UNITS.index(4), 0] = 1.0
    assert layer_intensities(units)[3] == 0.5


@pytest.mark.parametrize("mood", ["happy", "angry", "sad", "surprised", "relaxed"])
def test_every_expression_of_the_bundled_human_wrinkles_both_sides_alike(mood):
    morphs = Character.load("human").morphs
    weights = np.array([float(name == mood) for name in morphs])
    units = ActionUnits.of(morphs).intensities(weights)
    assert units.any()
    assert np.array_equal(units[:, 0], units[:, 1])
