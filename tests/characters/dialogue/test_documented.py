"""The pages of talks and of shows name every condition, action and cue."""

import re
from pathlib import Path

from cubeling.app.scenarios.dialogue.vocabulary import TALK_VOCABULARY
from cubeling.app.show.script import CUES, read_show
from cubeling.characters.dialogue.reading import read_script

DOCS = Path(__file__).parents[3] / "docs"
TALKING, SHOWS = ((DOCS / name).read_text() for name in ("talking.md", "shows.md"))


def named_in_tables(page):
    rows = [line for line in page.splitlines() if line.startswith("| `")]
    return {name for row in rows for name in re.findall(r"`(\w+)`", row.split("|")[1])}


def test_every_condition_action_and_cue_is_on_its_page():
    assert {*TALK_VOCABULARY.conditions, *TALK_VOCABULARY.actions} <= named_in_tables(TALKING)
    assert CUES.keys() <= named_in_tables(SHOWS)


def test_the_script_and_the_play_on_the_pages_can_be_read(tmp_path):
    example, play = (
        re.findall(r"```xml\n(.*?)```", page, re.DOTALL)[0] for page in (TALKING, SHOWS)
    )
    path = tmp_path / "cats.xml"
    path.write_text(example)
    script = read_script(path, TALK_VOCABULARY)
    assert [unit.name for unit in script.units] == ["cats"]
    (tmp_path / "my.show").write_text(play)
    assert {cue.kind for cue in read_show(tmp_path / "my.show").cues} == CUES.keys() - {"talk"}
