"""A pipeline that goes on from a checkpoint makes the messages that it made the first time."""

import itertools

import pytest

from app.pipeline import step_renderer
from app.pipeline.playground import Playground
from app.pipeline.surroundings import Surroundings
from app.running.opening import intrinsics_for
from app.scenarios import SCENARIOS
from app.session.bundled import bundled
from app.session.encoding import encode
from tracking import StoredFrames, open_source

SKIPPED, BEFORE, AFTER = 150, 12, 5


def messages(playground, frames):
    return [
        encode(message)
        for frame in frames
        for message in playground.step(frame, drawn=False).messages().values()
    ]


@pytest.mark.parametrize("name", SCENARIOS)
def test_what_follows_a_checkpoint_is_the_same_every_time(name):
    with open_source(str(bundled(name))) as source:
        assert isinstance(source, StoredFrames)
        playground = Playground(name, intrinsics_for(source.intrinsics, source.size))
        source.skip(SKIPPED)
        frames = list(itertools.islice(source, BEFORE + AFTER))
    messages(playground, frames[:BEFORE])
    checkpoint = playground.checkpoint()
    first = messages(playground, frames[BEFORE:])
    for _ in range(2):
        playground.restore(checkpoint)
        assert messages(playground, frames[BEFORE:]) == first


def test_after_a_checkpoint_the_light_of_a_later_time_is_forgotten(monkeypatch):
    made = []

    class Counted(Surroundings):
        def __init__(self, *given):
            made.append(given)
            super().__init__(*given)

    monkeypatch.setattr(step_renderer, "Surroundings", Counted)
    with open_source(str(bundled("companion"))) as source:
        playground = Playground("companion", intrinsics_for(source.intrinsics, source.size))
        playground.step(next(iter(source)), drawn=False)
    checkpoint, begun = playground.checkpoint(), len(made)
    playground.restore(checkpoint)
    assert len(made) == begun + 1
