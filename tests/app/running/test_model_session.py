"""A talk with a language model in a whole session: its answers are recorded, and replayed."""

import sys

import numpy as np
import pytest

from cubeling.app.pipeline.cubes.tracked_cube import TrackedCube
from cubeling.app.pipeline.scenario import Inputs, ModelAnswer
from cubeling.app.pipeline.step import Step
from cubeling.app.running.opening import open_session
from cubeling.app.running.runner import run
from cubeling.app.session import SessionOptions
from cubeling.app.speaking import voices
from cubeling.app.ui.screen import NullScreen
from cubeling.characters.speech.voices import Voice
from cubeling.tracking import CubeState
from cubeling.tracking.synthetic import open_synthetic
from tests.app import session_parts
from tests.app.scripted import VARIANCE, Blank
from tests.app.speaking.model.misbehaving import SAYS, model_server
from tests.app.speaking.test_speaker import BUZZ
from tests.examples import some

RATE = 20
SOURCE = f"talk?rate={RATE}&size=320x180&frames={7 * RATE}"
SAID = {3.0: "why is the sky blue", 5.0: "xyzzy"}


class Player(NullScreen):
    """Types at some times, and keeps the steps and what it is told."""

    def __init__(self) -> None:
        self.steps: list[Step] = []
        self.told: list[str] = []
        self._said = sorted(SAID.items())

    def show(self, step, robot):
        self.steps.append(step)
        if self._said and step.frame.timestamp >= self._said[0][0]:
            return Inputs(typed=self._said.pop(0)[1])
        return Inputs()

    def notify(self, words):
        self.told.append(words)


@pytest.mark.slow(reason="a session of seven seconds is animated twice")
@pytest.mark.parametrize("manner", some(["good", "broken"]))
def test_answers_are_recorded_and_a_replay_asks_nobody(manner, tmp_path, monkeypatch):
    source = open_synthetic(SOURCE)

    def track(_, frame, markers):
        pose = source.truth(frame.index)
        return CubeState(True, pose, np.zeros(6), VARIANCE, "markers", (), 0.1, frame.timestamp)

    monkeypatch.setattr(voices, "espeak", lambda: Voice((sys.executable, "-S", "-c", BUZZ)))
    monkeypatch.setattr(TrackedCube, "track", track)
    path, player = tmp_path / "talk.mcap", Player()
    with model_server(manner) as server:
        options = SessionOptions(
            scenario="talk",
            source="script",
            record=path,
            pictures=False,
            model=server.url,
            asks_model=True,
        )
        with open_session(options, source=Blank(source), screen=player) as session:
            run(session)
        assert len(server.asked) == 2
        answers = [each.asked.answer for each in session_parts.inputs(path).values()]
        text = SAYS if manner == "good" else ""
        assert [each for each in answers if each] == [ModelAnswer(1, text), ModelAnswer(2, text)]
        replies = [each.outcome.reply.text for each in player.steps if each.outcome.reply]
        assert len(replies) == 3
        assert (replies[1] == SAYS) == (manner == "good")
        lines = [each for each in player.told if "answers 500" in each]
        assert len(lines) == (0 if manner == "good" else 2)
    result = session_parts.check(path, SessionOptions(scenario="talk", source=str(path)))
    assert result.identical, dict(result.different)
    assert server.url.encode() not in path.read_bytes(), "the address is nobody else's business"
