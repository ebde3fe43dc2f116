"""`cubeling ik`."""

import re

import numpy as np
import pytest
from typer.testing import CliRunner

from cubeling.app.commands.study.ik import app
from cubeling.app.commands.study.ik_figures import PRINTED, measure_alone, measure_sure
from cubeling.characters.ik.solvers.solving import SOLVERS


@pytest.mark.full  # it measures solvers
def test_bench_prints_table_7_1_beside_what_we_measure(monkeypatch: pytest.MonkeyPatch) -> None:
    some = {name: SOLVERS[name] for name in ("springs", "damped")}
    monkeypatch.setattr("cubeling.characters.motion.SOLVERS", some)
    for name, few in (("_PATH_FRAMES", 5), ("_REPEATS", 1), ("_SINGLES", 3), ("_FOLLOWED", 3)):
        monkeypatch.setattr(f"cubeling.app.commands.study.ik_figures.{name}", few)
    run = CliRunner(env={"COLUMNS": "80"}).invoke(app, ["bench", "--targets", "10"])
    assert run.exit_code == 0, run.output
    for method in some:
        rows = re.findall(rf"^{method} ", run.output, re.MULTILINE)
        assert len(rows) == 4  # two tables, two sizes
    assert "…" not in run.output
    assert "26.9" in run.output
    assert "100.00%" in run.output


def test_what_the_thesis_prints_is_of_known_methods() -> None:
    assert set(PRINTED) <= set(SOLVERS)
    assert all(set(sizes) == {6, 10} for sizes in PRINTED.values())


def test_figures_are_numbers(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cubeling.app.commands.study.ik_figures._PATH_FRAMES", 10)
    alone, sure = measure_alone("damped", 6, 20), measure_sure("damped", 6, 20)
    for figures in (alone, sure):
        values = [value for value in vars(figures).values() if not isinstance(value, str)]
        assert np.isfinite(values).all()
    assert (sure.solved, sure.violations, sure.zig_zag) == (1.0, 0, 0.0)
