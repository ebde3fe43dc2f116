"""A step as its picture is shown: larger or smaller, and perhaps as in a mirror."""

from dataclasses import replace

import numpy as np

from cubeling.app.pipeline.step import Rect, Step


def shown_step(step: Step, scale: float, mirrored: bool) -> Step:
    """Return a step whose places are those in a picture that is shown at a scale, or mirrored."""
    width = step.picture.shape[1] if mirrored and step.picture is not None else 0
    close_up = step.close_up
    if close_up is not None and mirrored:
        close_up = np.ascontiguousarray(close_up[:, ::-1])
    return replace(
        step,
        subjects=tuple(scaled_rect(each, scale, width) for each in step.subjects),
        figures=tuple(each and scaled_rect(each, scale, width) for each in step.figures),
        close_up=close_up,
    )


def scaled_rect(rect: Rect, scale: float, mirrored_width: float = 0.0) -> Rect:
    """Return a place in a picture that is shown larger, or as in a mirror if its width is given.

    >>> scaled_rect((1.0, 2.0, 3.0, 4.0), 2.0), scaled_rect((1.0, 2.0, 3.0, 4.0), 2.0, 10.0)
    ((2.0, 4.0, 6.0, 8.0), (14.0, 4.0, 18.0, 8.0))
    """
    left, top, right, bottom = rect
    if mirrored_width:
        left, right = mirrored_width - right, mirrored_width - left
    return scale * left, scale * top, scale * right, scale * bottom
