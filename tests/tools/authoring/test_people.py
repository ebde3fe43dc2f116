"""The .idle files of the bundled characters are what their code makes; no knee snaps straight."""

from itertools import islice

import numpy as np
import pytest

from cubeling.affect import NEUTRAL, Emotion
from cubeling.affect.regions import SECTOR_WORDS
from cubeling.affect.words import WORD_PLACES
from cubeling.characters import Character, Pose
from cubeling.characters.model.standing import recordings_beside
from tools.authoring.__main__ import ASSETS
from tools.authoring.modelling.standing import MOODS
from tools.authoring.people import STANDING, recording_of

pytestmark = pytest.mark.full


@pytest.fixture(scope="module", params=Character.bundled_names())
def someone(request: pytest.FixtureRequest) -> Character:
    return Character.load(request.param)


def test_the_assets_are_what_the_code_makes(someone: Character) -> None:
    kept = recordings_beside(ASSETS / f"{someone.name}.glb", someone.skeleton)
    assert [each.name for each in kept] == list(MOODS)
    every = islice(zip(kept, STANDING[someone.name](someone), strict=True), 0, None, 3)
    for old, (mood, clip) in every:
        new = recording_of(someone, mood, clip)
        np.testing.assert_allclose(new.vectors, old.vectors, rtol=1e-6, atol=1e-3)
        assert new.rests == old.rests
        assert new.feeling == old.feeling


def test_nobody_jolts_in_any_mood(someone: Character) -> None:
    legs = [j for part, j in someone.anatomy.joints.items() if part.endswith(("Leg", "Foot"))]
    for emotion in (NEUTRAL, *(Emotion(*WORD_PLACES[word]) for word in SECTOR_WORDS)):
        motion = someone.stand()
        assert motion is not None
        motion.feel(emotion)
        poses = Pose.of_frames(motion.sample(time) for time in np.arange(0.0, 20.0, 1 / 30))
        places = poses.globals(someone.skeleton)[30:, legs][..., :3, 3]
        jolts = np.linalg.norm(np.diff(places, 2, axis=0), axis=-1) * 30.0**2
        assert jolts.max() < 6.0 * someone.height  # a knee that snaps straight has 20
