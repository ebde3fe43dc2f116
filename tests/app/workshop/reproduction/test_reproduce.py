"""`cubeling reproduce`."""

import csv
from collections.abc import Callable
from importlib import import_module
from pathlib import Path

from matplotlib.figure import Figure

from cubeling.app.workshop.pages.report_table import ReportTable
from cubeling.app.workshop.reproduction import page, registry
from cubeling.app.workshop.reproduction.registry import TABLES
from cubeling.app.workshop.reproduction.result import DrawnFigure, Reproduction, ReproductionRequest


def test_a_page_and_a_csv_hold_the_printed_figures_and_ours(cubeling, monkeypatch) -> None:
    code, out, err = cubeling("reproduce", "gesture-graph", "expressions", "-o", "report")
    assert (code, err) == (0, "")
    assert "36.20" in out
    text = Path("report", "index.html").read_text("utf-8")
    assert "table 4.2" in text
    assert "fear-confirmed" in text
    assert "http" not in text  # it loads nothing
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
        (["motion-graphs", "--clip", "no.bvh"], "cannot read the motion 'no.bvh'"),
        (["visemes", "--clip", "human#Walk"], "visemes: it is made from no clips"),
        (["gesture-strength"], "gesture-strength: the labels of two experts"),
        (["idle-study"], "idle-study: name the folder that holds 'idle' by --data"),
    ):
        code, _, err = cubeling("reproduce", *arguments)
        assert code == 2
        assert err.startswith(f"cubeling: {message}"), err
        assert err.count("\n") == 1
    for name, message in (
        ("cmu-mocap", "16_15.amc"),
        ("speech", "there is no .wav file"),
        ("idle", "there are not two .bvh files"),
    ):
        (tmp_path / name).mkdir()
        table = next(each for each in TABLES.values() if each.needs == (name,))
        code, _, err = cubeling("reproduce", table.name, "--data", tmp_path)
        assert code == 2
        assert message in err


class _Anything:
    """A module whose every function makes the same table."""

    def __getattr__(self, name: str) -> Callable[[ReproductionRequest], Reproduction]:
        table = ReportTable("t", ("", "printed", "ours"), (("a", "1", "2"),))
        return lambda request: Reproduction((table,), "x", "y", (DrawnFigure("p", _draw_line),))


def _draw_line(figure: Figure) -> None:
    figure.subplots().plot([0.0, 1.0], [1.0, 0.0])


def test_all_tables_leave_out_what_cannot_be_made(cubeling, monkeypatch) -> None:
    monkeypatch.setattr(registry, "import_module", lambda name: _Anything())
    code, _, err = cubeling("reproduce", "-o", "report")
    assert (code, err) == (0, "")
    text = Path("report", "index.html").read_text("utf-8")
    kept = [each for each in TABLES.values() if not each.needs and not each.missing]
    assert text.count("Not made:") == len(TABLES) - len(kept)
    assert f"{len(kept)} of {len(TABLES)} could be made here" in text
    assert text.count("<figure><svg") == len(kept)
    assert text.count("of processor time") == len(kept)
    assert all(f'id="{name}"' in text for name in TABLES)
    assert "0.563" in text  # what cannot be made is printed all the same
    assert not Path("report", "motion-graphs.csv").exists()
    code, out, _ = cubeling("reproduce", "--list")
    assert code == 0
    assert "needs cmu-mocap" in out


def test_a_page_has_no_plots_without_matplotlib(cubeling, monkeypatch) -> None:
    monkeypatch.setattr(registry, "import_module", lambda name: _Anything())
    monkeypatch.setattr(page, "find_spec", lambda name: None)
    code, _, err = cubeling("reproduce", "visemes", "-o", "report")
    assert (code, err) == (0, "")
    text = Path("report", "index.html").read_text("utf-8")
    assert "Plots need matplotlib: pip install matplotlib" in text
    assert "<svg" not in text


def test_every_entry_names_a_function_that_is_there() -> None:
    for table in TABLES.values():
        assert bool(table.module) != bool(table.missing)
        if table.module:
            module, _, function = table.module.partition(":")
            found = import_module(f"{registry.__package__}.{module}")
            assert callable(getattr(found, function or "reproduce"))
