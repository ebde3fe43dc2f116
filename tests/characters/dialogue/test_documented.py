"""The page "Talk to it" names every condition and action."""

import re
from pathlib import Path

from cubeling.app.scenarios.dialogue.vocabulary import TALK_VOCABULARY
from cubeling.app.show.script import CUES, read_show
from cubeling.characters.dialogue.reading import read_script

PAGE = Path(__file__).parents[3] / "docs" / "talking.md"


def test_every_condition_and_action_is_on_the_page():
    rows = [line for line in PAGE.read_text().splitlines() if line.startswith("| `")]
    named = {name for row in rows for name in re.findall(r"`(\w+)`", row.split("|")[1])}
    assert {*TALK_VOCABULARY.conditions, *TALK_VOCABULARY.actions, *CUES} <= named


def test_the_script_and_the_play_on_the_page_can_be_read(tmp_path):
    example, play = re.findall(r"```xml\n(.*?)```", PAGE.read_text(), re.DOTALL)
    path = tmp_path / "cats.xml"
    path.write_text(example)
    script = read_script(path, TALK_VOCABULARY)
    assert [unit.name for unit in script.units] == ["cats"]
    (tmp_path / "my.show").write_text(play)
    assert {cue.kind for cue in read_show(tmp_path / "my.show").cues} == CUES.keys() - {"talk"}
