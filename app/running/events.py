"""What happens in a session, in the words of a recording's events."""

from collections.abc import Iterator

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import Step
from cubeling.app.session import INSIDE_EVENT, START_OVER_EVENT


def events_of(step: Step, inputs: Inputs) -> Iterator[str]:
    """Yield what has happened in a frame, by what came in with it and what it led to."""
    if inputs.clear:
        yield START_OVER_EVENT
    if inputs.inside:
        yield INSIDE_EVENT
    if step.tracker_error:
        yield f"tracker failed: {step.tracker_error}"
    if step.controls.placed:
        yield f"placed {step.controls.top_face}"
    yield from step.controls.gestures
