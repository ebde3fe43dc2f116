"""The lines of scenarios: bundled ones and files of the user."""

from pathlib import Path

import pytest

from cubeling import app
from cubeling.app.errors import AppError
from cubeling.app.scenarios import SCENARIOS
from cubeling.app.speaking.lines import WATCHING, bundled_lines, languages_in, read_lines
from cubeling.characters.speech.tagged_text import TaggedText

LINES = Path(app.__file__).parent / "scenarios" / "lines"


@pytest.mark.parametrize("scenario", [file.stem for file in LINES.glob("*.toml")])
def test_bundled_lines_say_the_same_moments_in_both_languages(scenario):
    english, spanish = (bundled_lines(scenario, language) for language in ("en", "es"))
    assert english is not None
    assert spanish is not None
    assert set(english.lines) == set(spanish.lines)
    for lines in (english, spanish):
        for said in lines.lines.values():
            assert said
            assert all(TaggedText.read(line).text.strip() for line in said)


def test_a_scenario_of_another_package_says_nothing():
    assert bundled_lines("greet", "en") is None


@pytest.mark.parametrize(
    ("text", "problem"),
    [
        ("[voice.de]\nkiss = 'Kuss'", "voice.en: there are no lines in 'en'; has de"),
        ("voice = 3", "voice must be a table, not 3"),
        ("kiss = 'x'", "has none"),
        ("[voice.en]\nkiss = 3", "kiss must be a list of at most 1000 texts, not 3"),
        (
            "[voice.en]\nkiss = ['a', 3]",
            "none of them empty, not 3",
        ),
        ("[voice.en]\nkiss = ['']", "none of them empty, not ''"),
        (f"[voice.en]\nkiss = '{'a' * 301}'", "not 301"),
        ("[voice.en", "Expected"),
    ],
)
def test_what_is_no_file_of_lines_is_refused_in_one_line(tmp_path, text, problem):
    path = tmp_path / "my.toml"
    path.write_text(text)
    with pytest.raises(AppError, match=problem) as error:
        read_lines(path, "en")
    assert "\n" not in str(error.value)


def test_a_single_line_need_not_be_a_list(tmp_path):
    path = tmp_path / "my.toml"
    path.write_text("[voice.en]\nkiss = 'Hello'")
    assert read_lines(path, "en").lines == {"kiss": ("Hello",)}


def test_bundled_lines_are_in_the_package():
    for file in LINES.iterdir():
        languages_in(file)
        assert file.stem in {*SCENARIOS, WATCHING}
