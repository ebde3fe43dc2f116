"""The stimuli of the experiment with facial actions: what moves and wrinkles; the manifest."""

import csv

import cv2
import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.workshop.study.face_stimuli import (
    APEX_S,
    ONSET_S,
    RATE,
    RECIPES,
    course,
    draw_faces,
    morph_weights,
)
from cubeling.app.workshop.study.manifest import MANIFEST
from cubeling.characters import Character
from cubeling.tracking import open_source

BOTH = {"woman": "human", "man": "human"}


def wanted(stimulus):
    """The frown of the woman: strong with and without wrinkles, weak, and animated."""
    own = stimulus["action"] == "AU4" and stimulus["agent"] == "woman"
    moving = stimulus["intensity"] == "high" and stimulus["wrinkles"] == "with"
    return own and (stimulus["mode"] == "picture" or moving)


@pytest.mark.slow(reason="51 portraits are drawn")
def test_wrinkles_and_strength_are_seen_and_the_manifest_says_so(tmp_path):
    assert draw_faces(BOTH, tmp_path, wanted) == 5
    with (tmp_path / MANIFEST).open(encoding="utf-8", newline="") as file:
        rows = {row["file"]: row for row in csv.DictReader(file)}
    assert all((tmp_path / name).is_file() for name in rows)
    assert {row["character"] for row in rows.values()} == {"human"}

    def picture(strength, wrinkles):
        name = f"AU4-woman-{strength}-{wrinkles}-picture.png"
        assert (rows[name]["intensity"], rows[name]["wrinkles"]) == (strength, wrinkles)
        return np.asarray(cv2.imread(str(tmp_path / name)), float)

    strong, smooth, weak = (
        picture("high", "with"),
        picture("high", "without"),
        picture("low", "with"),
    )
    skin = np.abs(strong - smooth).max(2)
    places = np.argwhere(skin > 8)
    assert len(places) > 50  # between the brows, and nowhere else
    assert np.ptp(places[:, 0]) < 80
    assert np.ptp(places[:, 1]) < 80
    assert np.abs(weak - smooth).mean() > 0.01
    with open_source(str(tmp_path / "AU4-woman-high-with-animation.mp4")) as source:
        frames = [frame.image.astype(float) for frame in source]
    assert len(frames) == round((2 * ONSET_S + APEX_S) * RATE) + 1
    change = [np.abs(frame - frames[0]).mean() for frame in frames]
    apex = frames[len(frames) // 2]
    assert max(change) == pytest.approx(np.abs(apex - frames[0]).mean(), rel=0.2)
    assert change[-1] < max(change) / 3


def test_each_action_moves_what_it_is_called_after():
    morphs = Character.load("human").morphs
    moved = {
        action: {morphs[n] for n in np.flatnonzero(morph_weights(morphs, action, 1.0))}
        for action in RECIPES
    }
    assert moved["AU1+2"] == {"browInnerUp", "browOuterUp"}
    assert moved["AU12"] == {"mouthSmile"}
    assert moved["AU6"] == {"happy", "happyMouth"}
    assert all(moved.values())
    strong, weak = (morph_weights(morphs, "AU4", each) for each in (1.0, 0.45))
    np.testing.assert_allclose(weak, 0.45 * strong)


def test_names_of_both_sides_count_as_one_and_a_missing_morph_is_named():
    names = ["Face.browDown_L", "Face.browDown_R", "mouthSmileLeft", "mouthSmileRight"]
    assert morph_weights(names, "AU4", 1.0).tolist() == [1, 1, 0, 0]
    assert morph_weights(names, "AU12", 1.0).tolist() == [0, 0, 1, 1]
    with pytest.raises(AppError, match="cannot show AU1\\+2: it has no morph browInnerUp"):
        morph_weights(names, "AU1+2", 1.0)


def test_an_action_comes_and_goes_smoothly():
    values = np.array([course(t) for t in np.linspace(0.0, 2 * ONSET_S + APEX_S, 400)])
    assert (values[0], values.max()) == (0.0, 1.0)
    np.testing.assert_allclose(values, values[::-1], atol=1e-9)
    assert np.abs(np.diff(values, 2)).max() < 2e-3
