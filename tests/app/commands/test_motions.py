"""`cubeling motions`: what it builds and shows, and what it refuses."""

import numpy as np
import pytest

from cubeling.app.workshop.motion_graphs.page import write_page
from cubeling.app.workshop.motion_graphs.tables import TABLE_3_2, TABLE_3_3, Tables
from cubeling.characters.synthesis.graphs.storage import load_graph


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


def test_tables_are_a_page_and_a_csv_file(tmp_path) -> None:
    tables = Tables(("walk <1>", "run", "long", "slow"), {"SMG": 0.3})
    tables.add("3.2", "0.06", "SMG TBF", 19.99, 21.5)
    tables.add("3.4", "C1 → C2", "best profile", "SP4b", "SP5")
    for curves in (tables.connectivity, tables.cost):
        curves["SMG"] = np.array([0.1, 0.2]), np.array([0.4, 0.9])
    page = tmp_path / "tables.html"
    table = write_page(tables, page)
    text = page.read_text(encoding="utf-8")
    assert "21.50 <span class=printed>(19.99)</span>" in text
    assert "walk &lt;1&gt;" in text
    assert "data:image/png;base64," in text
    rows = table.read_text(encoding="utf-8").splitlines()
    assert rows[0] == "table,row,column,printed,ours"
    assert rows[2] == "3.4,C1 → C2,best profile,SP4b,SP5"


def test_printed_tables_agree_with_what_the_thesis_says_of_them() -> None:
    """Errata 5 and 6 of the specification, from the raw entries."""
    ratios = [standard[1] / parts[1] for standard, parts in TABLE_3_2.values()]
    assert [round(ratio, 2) for ratio in ratios] == [3.28, 3.08, 3.02, 2.94, 2.92, 2.87]
    standard, parts = TABLE_3_3["SMG"], TABLE_3_3["BPMG"]
    assert sum(parts[pair][0] < standard[pair][0] for pair in standard) == 10
    assert sum(parts[pair][1] < standard[pair][1] for pair in standard) == 11
    means = [np.mean([value[0] for value in table.values()]) for table in (standard, parts)]
    assert np.round(means, 2).tolist() == [7.75, 4.80]


def test_tables_need_four_clips(cubeling) -> None:
    code, _, error = cubeling("motions", "tables", "human#Walk", "human#Run")
    assert code == 2
    assert "2 clips: give four" in error
