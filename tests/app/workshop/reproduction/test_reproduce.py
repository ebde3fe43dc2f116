"""`cubeling reproduce`."""

import csv
from pathlib import Path

from cubeling.app.workshop.reproduction.registry import TABLES
from cubeling.app.workshop.reproduction.result import Reproduction, ResultTable


def test_a_page_and_a_csv_hold_the_printed_figures_and_ours(cubeling, monkeypatch) -> None:
    code, out, err = cubeling("reproduce", "gesture-graph", "expressions", "-o", "report")
    assert (code, err) == (0, "")
    assert "36.20" in out
    page = Path("report", "index.html").read_text("utf-8")
    assert "table 4.2" in page
    assert "fear-confirmed" in page
    assert "http" not in page  # it loads nothing
    with Path("report", "gesture-graph.csv").open(newline="", encoding="utf-8") as file:
        heads, *rows = csv.reader(file)
    assert heads[1].startswith("printed")
    assert [row[0] for row in rows] == [f"{n / 10:g}" for n in range(3, 11)]
    printed, ours = ([float(row[column].rstrip("%")) for row in rows] for column in (3, 4))
    assert sorted(ours) == ours
    assert (printed[-1], ours[-1]) == (100.0, 100.0)
    code, out, err = cubeling("reproduce", "expressions", "-o", "report")
    assert code == 2
    assert err.startswith("cubeling: 'report' holds reproduced tables already")


def test_each_of_the_24_emotions_has_the_printed_face(cubeling) -> None:
    code, out, _ = cubeling("reproduce", "expressions")
    assert code == 0
    assert "What differs: nothing." in out


def test_a_table_that_cannot_be_made_says_why(cubeling, tmp_path) -> None:
    for arguments, message in (
        (["nothing"], "there is no table 'nothing': choose from motion-graphs, "),
        (["motion-graphs"], "motion-graphs: name the folder that holds 'cmu-mocap' by --data"),
        (["motion-graphs", "--data", "."], "motion-graphs: there is no folder 'cmu-mocap' in '.'"),
        (["motion-graphs", "--data", "no"], "there is no folder 'no'"),
        (["accent-strength"], "accent-strength: the labels of two experts"),
    ):
        code, _, err = cubeling("reproduce", *arguments)
        assert code == 2
        assert err.startswith(f"cubeling: {message}")
        assert err.count("\n") == 1
    (tmp_path / "cmu-mocap").mkdir()
    code, _, err = cubeling("reproduce", "motion-graphs", "--data", tmp_path)
    assert code == 2
    assert "16_15.amc" in err


def test_all_tables_leave_out_what_cannot_be_made(cubeling, monkeypatch) -> None:
    made = Reproduction((ResultTable("t", ("", "printed", "ours"), (("a", "1", "2"),)),), "x", "y")
    module = "cubeling.app.workshop.reproduction"
    for name in ("ik_methods", "gesture_graph"):
        monkeypatch.setattr(f"{module}.{name}.reproduce", lambda folder, progress: made)
    code, out, err = cubeling("reproduce", "-o", "report")
    assert (code, err) == (0, "")
    page = Path("report", "index.html").read_text("utf-8")
    assert page.count("Not made:") == 3
    assert all(f"id={name}" in page for name in TABLES)
    assert not Path("report", "motion-graphs.csv").exists()
    code, out, _ = cubeling("reproduce", "--list")
    assert code == 0
    assert "needs cmu-mocap" in out
