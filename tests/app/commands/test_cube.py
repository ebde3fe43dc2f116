"""The roles of a cube's faces: those of its file, and those that a scenario needs."""

from pathlib import Path

import pytest

from cubeling import app

PAGE = Path(app.__file__).parents[1] / "docs" / "your-own-cube.md"
MUSEUM = PAGE.read_text("utf-8").partition("```toml\n")[2].partition("```")[0]


@pytest.mark.parametrize("command", [["cube"], ["play", "companion", "--cube"]], ids=" ".join)
def test_an_unknown_role_is_one_line_that_names_file_and_roles(cubeling, command):
    Path("museum.toml").write_text(MUSEUM.replace('role = "kiss"', 'role = "kis"'), "utf-8")
    code, _, err = cubeling(*command, "museum.toml")
    assert code == 2
    assert err == (
        "cubeling: museum.toml: face 'front' has the role 'kis'; "
        "use one of idle, kiss, shout, walk, run, turn\n"
    )


def test_a_cube_without_a_role_that_the_scenario_needs_is_refused(cubeling):
    Path("museum.toml").write_text(MUSEUM.replace('role = "shout"', ""), "utf-8")
    code, _, err = cubeling("play", "companion", "--cube", "museum.toml")
    assert code == 2
    assert err == (
        "cubeling: museum.toml: companion needs a face with each of the roles idle, kiss, shout; "
        "missing: shout (the cube has idle, kiss)\n"
    )


@pytest.mark.parametrize("scenario", ["companion", "follow"])
def test_the_example_of_the_page_can_be_played(cubeling, scenario):
    Path("museum.toml").write_text(MUSEUM, "utf-8")
    code, _, err = cubeling("play", scenario, "--cube", "museum.toml")
    assert (code, "no display" in err) == (2, True), "that is all that is missing"


def test_the_example_of_the_page_can_be_printed(cubeling):
    Path("museum.toml").write_text(MUSEUM, "utf-8")
    assert cubeling("cube", "museum.toml")[0] == 0
    assert Path("museum.pdf").exists()


def test_a_sheet_on_other_paper_does_not_overwrite_that_on_a4(cubeling):
    assert cubeling("cube", "companion")[0] == 0
    first = Path("companion.pdf").read_bytes()
    code, out, _ = cubeling("cube", "companion", "--paper", "Letter")
    assert code == 0
    assert "companion-letter.pdf" in out
    assert Path("companion.pdf").read_bytes() == first
    assert Path("companion-letter.pdf").is_file()
