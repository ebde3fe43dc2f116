"""The line that a character says, and the cube as its knob."""

from dataclasses import replace

import numpy as np
import pytest

from cubeling.app.pipeline.table.spoken_line import Speaking, SpokenLine
from cubeling.characters import ActionIntent, CharacterCommand
from cubeling.characters.speech import DEFAULT_PROFILE, Utterance


@pytest.mark.parametrize(("knob", "emphasis"), [(0.0, 0.0), (1.0, 0.5), (0.4, 0.2)])
def test_a_turn_of_the_cube_emphasises_what_is_said_as_far_as_the_profile_lets_it(knob, emphasis):
    profile = replace(DEFAULT_PROFILE, cube_emphasis=knob)
    line = SpokenLine(Utterance("Hello", "en", 2.0), np.zeros(8, np.float32), 8000, profile)
    speaking = Speaking()
    command = CharacterCommand(1.0, action=ActionIntent("idle", 0.5))
    first = speaking.update(line, command, silence=False)
    later = speaking.update(None, replace(command, timestamp=1.5), silence=False)
    assert first is not None
    assert later is not None
    assert first.start == later.start == 1.0
    assert [first.emphasis, later.emphasis] == pytest.approx([emphasis, emphasis])
