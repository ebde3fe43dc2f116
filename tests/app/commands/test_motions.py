"""`cubeling motions`: what it builds and shows, and what it refuses."""

import numpy as np
import pytest

from characters.synthesis.storage import load_graph


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
        (("show", "no.graph"), "no.graph: No such file"),
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
