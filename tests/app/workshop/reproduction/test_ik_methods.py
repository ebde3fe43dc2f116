"""Table 7.1 again."""

import numpy as np
import pytest

from cubeling.app.workshop.reproduction.bodies import ik_figures, ik_methods
from cubeling.characters.ik.solvers.solving import SOLVERS


def test_what_the_thesis_prints_is_of_known_methods() -> None:
    assert set(ik_methods.PRINTED) <= set(SOLVERS)
    assert all(set(sizes) == {6, 10} for sizes in ik_methods.PRINTED.values())


def test_figures_are_numbers_and_stand_beside_the_printed_ones(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    for name, few in (("_PATH_FRAMES", 10), ("_REPEATS", 1), ("_SINGLES", 3), ("_FOLLOWED", 3)):
        monkeypatch.setattr(ik_figures, name, few)
    alone = ik_figures.measure_alone("springs", 6, 20)
    sure = ik_figures.measure_sure("damped", 6, 20)
    for figures in (alone, sure):
        values = [value for value in vars(figures).values() if not isinstance(value, str)]
        assert np.isfinite(values).all()
    assert (sure.solved, sure.violations, sure.zig_zag) == (1.0, 0, 0.0)
    table = ik_methods.printed_table([alone])
    row = dict(zip(table.columns, table.rows[0], strict=True))
    assert (row["printed steps"], row["printed ms"]) == ("26.9", "0.13")
    assert float(row["steps"]) == pytest.approx(alone.iterations, abs=0.05)
