"""`cubeling motions`: what it builds and shows, and what it refuses."""

import numpy as np
import pytest

from cubeling.app.errors import AppError
from cubeling.app.input_path import check_motions
from cubeling.app.workshop.motion_graphs.transition import find_transitions
from cubeling.characters.synthesis.graphs.storage import load_graph


@pytest.mark.parametrize("name", ["nosuch", "nosuch#Walk"])
def test_motions_that_are_nowhere_are_refused_before_anything_is_opened(name):
    with pytest.raises(AppError, match=f"there are no motions '{name}'"):
        check_motions(["human#wave", name])


@pytest.fixture
def graph(cubeling, tmp_path):
    cubeling("motions", "build", "human#Walk", "human#Run", "-o", "my.graph")
    return tmp_path / "my.graph"


def test_builds_a_graph_of_clips_and_shows_it(cubeling, graph, tmp_path) -> None:
    stored = load_graph(graph)
    assert stored.library.names == ("Walk", "Run")
    assert len(stored.library) == 62 + 42
    code, out, _ = cubeling("motions", "show", "my.graph", "-o", "my.png")
    assert code == 0
    assert "2 clips, 104 frames at 60 Hz" in out
    assert "BP56" in out
    assert (tmp_path / "my.png").stat().st_size > 10_000


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("build", "nobody.bvh"), "nobody.bvh"),
        (("build", "human#Walk", "--profile", "SP9"), "no split profile 'SP9'"),
        (("build", "human#Walk", "--distance", "far"), "no distance 'far'"),
        (("build", "human#Walk", "--threshold", "-1"), "joins nothing"),
        (("build", "human#wave", "--threshold", "1e-7"), "connects nothing"),
        (("build", "human#Walk", "-o", "walk.txt"), "written as .graph"),
        (("build", "human#Walk", "--character", "vleo"), "quadruped"),
        (("show", "no.graph"), "no.graph': No such file"),
    ],
)
def test_refuses_in_one_line(cubeling, arguments, message) -> None:
    code, _, error = cubeling("motions", *arguments)
    assert code == 2
    assert message in error
    assert error.count("\n") == 1


def test_one_clip_is_a_graph_too(cubeling, tmp_path) -> None:
    code, _, _ = cubeling("motions", "build", "human#Walk", "-o", "one.graph")
    assert code == 0
    stored = load_graph(tmp_path / "one.graph")
    assert np.array_equal(stored.library.loops, [True])


def test_a_transition_is_shown_part_by_part(cubeling, graph, tmp_path) -> None:
    stored = load_graph(graph)
    whole, parts = find_transitions(stored, "Walk", "Run", 0.4, as_printed=False)
    assert whole.parts == ("whole body",)
    assert parts.parts == ("legs", "head, trunk", "right arm", "left arm")
    for found in (whole, parts):
        assert found.transition.request == round(0.4 * stored.library.rate)
        clips = found.clips(stored.library, 5)
        times = found.transition.duration + 1 + 2 * 5
        assert clips.shape == (len(found.parts), times)
        assert (clips[:, :6] == 0).all()
        assert (clips[:, -6:] == 1).all()
    code, out, _ = cubeling(
        *("motions", "transition", "my.graph", "Walk", "Run"), "--as-printed", "-o", "t.png"
    )
    assert code == 0
    assert "Parts as printed" in out
    assert (tmp_path / "t.png").stat().st_size > 10_000


def test_a_graph_can_be_built_as_printed(cubeling, tmp_path) -> None:
    code, out, _ = cubeling("motions", "build", "human#Walk", "human#Run", "--as-printed")
    assert code == 0
    assert "compared by angles, as printed" in out
    assert load_graph(tmp_path / "my.graph").rule == "same"


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("Walk", "Fly"), "no clip 'Fly'; there are Walk, Run"),
        (("Run", "Run"), "'Run' is where it begins"),
        (("Walk", "Run", "--at", "9"), "clip 'Walk' lasts 0.97 s"),
    ],
)
def test_a_transition_that_is_none_is_refused_in_one_line(
    cubeling, graph, arguments, message
) -> None:
    code, _, error = cubeling("motions", "transition", "my.graph", *arguments)
    assert code == 2
    assert message in error
    assert error.count("\n") == 1
