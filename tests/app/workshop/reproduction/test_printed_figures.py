"""The printed figures are those of the specifications, where these are at hand."""

import re
from pathlib import Path

import pytest

from cubeling.app.workshop.reproduction.bodies.ik_methods import PRINTED as IK
from cubeling.app.workshop.reproduction.bodies.occlusion_timing import THESIS_MS
from cubeling.app.workshop.reproduction.gesturing import accent_strength, timing
from cubeling.app.workshop.reproduction.gesturing.connectivity import PRINTED_ROWS
from cubeling.app.workshop.reproduction.gesturing.visemes import PRINTED_CLASSES
from cubeling.app.workshop.reproduction.motion_graphs.printed import (
    TABLE_3_2,
    TABLE_3_3,
    TABLE_3_4,
)
from cubeling.app.workshop.reproduction.registry import TABLES
from cubeling.app.workshop.reproduction.standing.expressions import PRINTED_FACES
from cubeling.app.workshop.reproduction.studies import PRINTED_QUESTIONS
from cubeling.app.workshop.study.bundled import gesture_and_speech, single_facial_actions

SPECS = Path(__file__).parents[5] / "shared" / "specs"

pytestmark = pytest.mark.skipif(not SPECS.is_dir(), reason="no specifications beside the project")

MOTION = "tangible-control-motion-graphs-and-speech.md"
IDLE = "idle-motion-and-interactive-humans.md"
FACES = "emotional-rendering-and-expressive-ik.md"

Rows = list[list[str]]


def tables(name: str) -> dict[str, Rows]:
    """Return the tables of a specification by the first line of each, without bold and so on."""
    found: dict[str, Rows] = {}
    rows: Rows = []
    for line in [*(SPECS / name).read_text("utf-8").splitlines(), ""]:
        if line.startswith("|"):
            rows.append([cell.strip(" *`") for cell in line.strip("|").split("|")])
        elif rows:
            found.setdefault(" ".join(rows[0]), []).extend(rows[2:])
            rows = []
    return found


def rows_of(name: str, heading: str) -> Rows:
    """Return the rows of the only table whose first line begins with a heading."""
    (rows,) = (rows for first, rows in tables(name).items() if first.startswith(heading))
    return rows


def test_motion_graphs() -> None:
    for st, *values in rows_of(MOTION, "st SMG TBF"):
        printed = [value for pair in TABLE_3_2[float(st)] for value in pair]
        assert printed == [float(value) for value in values[:4]]
    for method, heading in (("SMG", "SMG C1"), ("BPMG", "BPMG C1")):
        for row, cells in enumerate(rows_of(MOTION, heading)):
            for column, cell in enumerate(cells[1:]):
                if row != column:
                    pair = tuple(float(value) for value in cell.split(" / "))
                    assert TABLE_3_3[method][row, column] == pair
    assert tuple(tuple(row[1:]) for row in rows_of(MOTION, " C1 C2 C3 C4")) == TABLE_3_4


def test_gestures_and_accents() -> None:
    assert {
        float(st): (float(edges), int(size), float(within))
        for st, edges, size, within in rows_of(MOTION, "st BF SCC size")
    } == PRINTED_ROWS
    printed = TABLES["gesture-strength"].printed
    assert printed is not None
    classifiers = dict(rows_of(MOTION, "Table 4.1 MCC"))
    assert {row[0]: row[1] for row in printed.rows[1:]} == classifiers
    text = (SPECS / MOTION).read_text("utf-8")
    assert f"FMDistance alone: **{printed.rows[0][1]}**" in text
    both = rows_of(MOTION, "Table 8.1 MCC")
    measures = {row[0]: float(row[1]) for row in both if row[0]}
    assert measures == accent_strength.PRINTED_MEASURES
    others = {row[-2].removesuffix(" regression"): float(row[-1]) for row in both}
    ours = accent_strength.PRINTED_CLASSIFIERS.items()
    assert others == {name.removesuffix(" regression"): value for name, value in ours}
    for figure in (
        f"{100 * timing.LEADING_SHARE:.2f} %",
        f"= **{timing.CORRELATION}**",
        f"{timing.SLOPE}\\,PSI",
        f"{timing.INTERCEPT}+{timing.SLOPE}",
        f"mean +{timing.LEAD_S} s, SD {timing.LEAD_DEVIATION_S} s",
        f"[{timing.WINDOW_S[0]}, {timing.WINDOW_S[1]}] s",
    ):
        assert figure in text


def test_votes_and_children() -> None:
    printed = {
        tuple(row[0].split(" vs ")): [
            cell.replace("-", "−").replace("<0", "< ") for cell in row[1:]
        ]
        for row in rows_of(MOTION, "A vs B")
    }
    for pair, (better, worse, mean, median, p) in gesture_and_speech.PRINTED.items():
        cells = printed[pair]
        assert (better, mean, median, p) == (cells[0], *cells[2:])
        assert cells[1].startswith(worse)
    asked = rows_of(MOTION, "Table 5.1 when")
    assert tuple(map(tuple, asked)) == PRINTED_QUESTIONS


def test_visemes_are_the_printed_classes() -> None:
    text = (SPECS / MOTION).read_text("utf-8")
    listed = text[text.index("**Visemes (Table 4.5, 15 classes):**") :].splitlines()[0]
    classes = re.findall(r"\{([a-z,]+)\}", listed.partition("[E]")[0])
    assert tuple(each.replace(",", " ") for each in classes) == PRINTED_CLASSES


def test_faces_of_emotions() -> None:
    text = (SPECS / IDLE).read_text("utf-8")
    for face, printed in (("Joy", "happy"), ("Sadness", "sad"), ("Anger", "angry")):
        (listed,) = re.findall(rf"{face} ← ([^(]+) \(\d+\)", text)
        assert listed.lower().split(", ") == list(PRINTED_FACES[printed])


def test_solvers_and_ambient_occlusion() -> None:
    names = {
        "Ours 1 (force)": "springs-force",
        "Ours 2 (position)": "springs",
        "CCD [137]": "ccd",
        "PseudoInverse [116,140]": "pseudo-inverse",
        "Transpose [144]": "transpose",
        "DLS [25]": "damped",
    }
    for name, _, steps, times in rows_of(FACES, "Method joints iterations"):
        values = zip(steps.strip("*").split(" / "), times.strip("*").split(" / "), strict=True)
        for joints, (step, time) in zip((6, 10), values, strict=True):
            assert IK[names[name]][joints] == (float(step), float(time))
    estimators = "crytek", "volumetric", "hbao"
    for size, samples, *drawn in rows_of(FACES, "Size Samples / separable"):
        for name, taken in zip(estimators, drawn, strict=True):
            assert THESIS_MS[name][int(size)][samples.endswith("yes")] == float(taken)


def test_facial_actions() -> None:
    for heading, means in (
        ("AU high EXP", single_facial_actions.INTENSITY),
        ("AU anim EXP", single_facial_actions.PRESENTATION),
    ):
        for name, *cells in rows_of(FACES, heading):
            values = [float(cell.strip("*")) for cell in cells]
            assert means[f"AU{name}"] == (tuple(values[:3]), tuple(values[3:]))
    rates = rows_of(FACES, " AU4 AU1+4")
    actions = "AU4", "AU1+4", "AU1+2", "AU20", "AU12", "AU6"
    with_wrinkles, without = ([float(cell) for cell in row[1:]] for row in rates)
    printed = dict(zip(actions, zip(with_wrinkles, without, strict=True), strict=True))
    assert printed == single_facial_actions.FIRST_CHOICE
