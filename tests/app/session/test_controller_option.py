"""The controller that a user chooses, from the command line to the recording and back."""

import pytest

from cubeling.app.running.opening import open_session
from cubeling.app.session import SessionOptions
from cubeling.characters import CharacterError


def test_metadata_keep_the_controller_and_its_motions():
    options = SessionOptions(
        scenario="follow", source="camera:0", controller="matching", motions=("a b.bvh", "c.amc")
    )
    again = SessionOptions.from_metadata(options.metadata(), "session.mcap")
    assert (again.controller, again.motions) == ("matching", ("a b.bvh", "c.amc"))


def test_sessions_without_a_controller_are_played_by_the_tree():
    options = SessionOptions.from_metadata({"scenario": "follow"}, "session.mcap")
    assert (options.controller, options.motions) == ("tree", ())
    assert not options.keeps_scenario


@pytest.mark.parametrize(
    ("controller", "motions", "problem"),
    [
        ("flying", (), "no controller is called 'flying': choose one of tree"),
        ("tree", ("walk.bvh",), "walk.bvh: the controller 'tree' plays the character's own clips"),
    ],
)
def test_an_unsuitable_controller_is_refused_before_the_camera_is_opened(
    controller, motions, problem
):
    options = SessionOptions(
        scenario="follow", source="camera:99", controller=controller, motions=motions
    )
    with pytest.raises(CharacterError, match=problem), open_session(options):
        pass


@pytest.mark.parametrize("own", [False, True])
def test_metadata_keep_whether_a_character_plays_its_own_motions_only(own):
    options = SessionOptions(scenario="follow", source="camera:0", own_motions_only=own)
    again = SessionOptions.from_metadata(options.metadata(), "session.mcap")
    assert again.own_motions_only is own


def test_detached_feet_stay_so_in_what_was_recorded_before_they_were_led():
    options = SessionOptions(scenario="follow", source="camera:0")
    metadata = options.metadata()
    assert SessionOptions.from_metadata(metadata, "session.mcap").whole_limbs
    del metadata["whole_limbs"]
    assert not SessionOptions.from_metadata(metadata, "session.mcap").whole_limbs


def test_a_session_from_before_there_were_lent_motions_is_replayed_without_them():
    options = SessionOptions.from_metadata({"scenario": "follow"}, "session.mcap")
    assert options.own_motions_only
