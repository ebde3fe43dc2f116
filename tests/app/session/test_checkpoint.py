"""A pipeline that goes on from a checkpoint makes the messages that it made the first time."""

import itertools
from dataclasses import astuple, replace

import cv2
import numpy as np
import pytest

from cubeling.app.pipeline.playground import Playground
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.session.bundled import RECORDED_SCENARIOS, bundled_session
from cubeling.app.session.encoding import encode
from cubeling.characters.rendering import create_context
from cubeling.tracking import StoredFrames, open_source

SKIPPED, BEFORE, AFTER = 30, 12, 5


def messages(playground, frames):
    return [
        encode(message)
        for frame in frames
        for message in playground.step(frame, drawn=False).messages().values()
    ]


@pytest.mark.parametrize("name", RECORDED_SCENARIOS)
def test_what_follows_a_checkpoint_is_the_same_every_time(name):
    with open_source(str(bundled_session(name))) as source:
        assert isinstance(source, StoredFrames)
        playground = Playground(name, intrinsics_for(source.intrinsics, source.size))
        source.restart(SKIPPED)
        frames = list(itertools.islice(source, BEFORE + AFTER))
    messages(playground, frames[:BEFORE])
    checkpoint = playground.checkpoint()
    first = messages(playground, frames[BEFORE:])
    for _ in range(2):
        playground.restore(checkpoint)
        assert messages(playground, frames[BEFORE:]) == first


def darker(frame):
    """The frame as if a lamp had been switched off, and the lens was not clean."""
    image = cv2.convertScaleAbs(cv2.GaussianBlur(frame.image, (0, 0), 2.0), alpha=0.4)
    return replace(frame, image=np.asarray(image, np.uint8))


@pytest.fixture
def straight_and_after_a_seek():
    """Draw some frames, once straight on, and once after a later time that looks otherwise."""
    with open_source(str(bundled_session("companion"))) as source:
        assert isinstance(source, StoredFrames)
        intrinsics = intrinsics_for(source.intrinsics, source.size)
        source.restart(SKIPPED)
        frames = list(itertools.islice(source, BEFORE + AFTER))
    context = create_context()

    def steps(later, **settings):
        playground = Playground("companion", intrinsics, context=context, **settings)
        messages(playground, frames[:BEFORE])
        checkpoint = playground.checkpoint()
        for frame in later:
            playground.step(frame)
        if later:
            playground.restore(checkpoint)
        yield from (playground.step(frame) for frame in frames[BEFORE:])
        playground.close()

    def both(**settings):
        later = [darker(frame) for frame in frames[BEFORE:]]
        return [list(steps(each, **settings)) for each in ([], later)]

    yield both
    context.release()


@pytest.mark.slow(reason="pictures are measured and drawn")
def test_after_a_seek_what_is_measured_is_as_in_a_straight_run(straight_and_after_a_seek):
    straight, after_a_seek = (
        [astuple(step.appearance) for step in steps] for steps in straight_and_after_a_seek()
    )
    np.testing.assert_equal(after_a_seek, straight)


@pytest.mark.slow(reason="pictures are drawn")
def test_after_a_seek_the_pictures_are_as_in_a_straight_run(straight_and_after_a_seek):
    straight, after_a_seek = (
        [step.picture for step in steps] for steps in straight_and_after_a_seek(realism=())
    )
    np.testing.assert_array_equal(after_a_seek, straight)
