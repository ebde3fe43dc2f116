"""Tables 3.2 to 3.4, and the printed figures in them."""

import numpy as np
import pytest

from cubeling.app.workshop.reproduction.motion_graphs.body_parts import plots_of
from cubeling.app.workshop.reproduction.motion_graphs.measuring import (
    SPLIT_PROFILES,
    Measurement,
    measure,
)
from cubeling.app.workshop.reproduction.motion_graphs.printed import (
    CRITICAL,
    SHORTER_AND_SOONER,
    TABLE_3_2,
    TABLE_3_3,
    TABLE_3_4,
)
from cubeling.app.workshop.reproduction.motion_graphs.summary import summarize
from cubeling.app.workshop.reproduction.plots import inline_svg
from cubeling.characters import Character
from cubeling.characters.synthesis.library import MotionLibrary


def _measured(duration: float, profile: str, joined: int) -> Measurement:
    found = Measurement(("walk <1>", "run", "long", "slow"), {"SMG": 0.3})
    for way, more in (("as printed", 1.0), ("ours", 0.0)):
        found.values[way] = {
            ("3.2", "0.06", "SMG TBF"): duration + more,
            ("3.3", "C4 → C2", "BPMG response"): None,
            ("3.4", "C3", "C3"): profile,
        }
        found.joined[way] = {("3.2", "0.06", "SMG TBF"): joined}
        found.pairs[way] = 2, 11, 12
    for curves in (found.connectivity, found.cost):
        curves["SMG"] = np.array([0.1, 0.2]), np.array([0.4, 0.9])
    return found


def test_several_choices_of_clips_have_means_and_intervals() -> None:
    chosen = [_measured(10.0, "SP5", 2), _measured(12.0, "SP2", 4), _measured(14.0, "SP5", 4)]
    found = summarize(chosen)
    duration = found.cells["3.2", "0.06", "SMG TBF"]["ours"]
    assert duration.text == "12.00"
    assert duration.low is not None
    assert duration.high is not None
    assert 10.0 <= duration.low < 12.0 < duration.high <= 14.0
    assert duration.joined == 3
    assert found.cells["3.4", "C3", "C3"]["ours"].spread == "2 of 3"
    assert found.pairs("ours") == (6, 33, 36)
    assert "parts are shorter in 6 of 36 pairs (printed 10 of 12)" in found.order("ours")


def test_printed_tables_agree_with_what_the_thesis_says_of_them() -> None:
    """Errata 5 and 6 of the specification, from the raw entries."""
    ratios = [standard[1] / parts[1] for standard, parts in TABLE_3_2.values()]
    assert [round(ratio, 2) for ratio in ratios] == [3.28, 3.08, 3.02, 2.94, 2.92, 2.87]
    standard, parts = TABLE_3_3["SMG"], TABLE_3_3["BPMG"]
    for which, count in enumerate(SHORTER_AND_SOONER):
        assert sum(parts[pair][which] < standard[pair][which] for pair in standard) == count
    names = [name for row in TABLE_3_4 for name in row]
    assert [names.count(name) for name in ("SP4b", "SP3a", "SP2")] == [6, 6, 4]
    means = [np.mean([value[0] for value in table.values()]) for table in (standard, parts)]
    assert np.round(means, 2).tolist() == [7.75, 4.80]


def test_tables_need_four_clips(cubeling) -> None:
    clips = "--clip", "human#Walk", "--clip", "human#Run"
    code, _, error = cubeling("reproduce", "motion-graphs", *clips)
    assert code == 2
    assert "2 clips: give four" in error


@pytest.mark.full
@pytest.mark.slow(reason="all graphs of four clips are built and searched in both ways")
def test_four_clips_give_all_cells_of_all_tables() -> None:
    human = Character.load("human")
    clips = [human.clips[name] for name in ("Walk", "Run", "WalkLeftWide", "WalkRightShort")]
    library = MotionLibrary.of(clips, human.skeleton, human.anatomy, 12.0)
    found = measure(library, 12, curves=False)
    for way in ("as printed", "ours"):
        values = found.values[way]
        assert len([key for key in values if key[0] == "3.4"]) == 16
        assert {values["3.4", f"C{n}", f"C{n}"] for n in (1, 2, 3, 4)} <= {*SPLIT_PROFILES}
        for method, threshold in CRITICAL.items():
            joined = [values["3.2", f"{st:g}", f"{method} clips"] for st in TABLE_3_2]
            assert (np.diff(np.array(joined, float)) >= 0.0).all()
            assert values["3.2", f"{threshold:g}", f"{method} clips"] == 4.0
        shorter, sooner, pairs = found.pairs[way]
        assert max(shorter, sooner) <= pairs <= 12
    assert found.pairs["ours"][2] == 12  # our own search answers everything
    cells = summarize([found]).cells
    assert cells["3.3", "C1 → C2", "SMG duration"]["ours"].value == pytest.approx(
        found.values["ours"]["3.3", "C1 → C2", "SMG duration"]
    )


def test_the_curves_are_drawn_the_same_each_time() -> None:
    shown = plots_of(_measured(10.0, "SP5", 2))
    assert [each.title.partition(":")[0] for each in shown] == ["Figure 3.14", "Figure 3.15"]
    first, second = (inline_svg(shown[0]) for _ in range(2))
    assert first == second
    assert first.startswith("<svg")
