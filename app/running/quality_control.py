"""Choosing the quality of the pictures that holds the camera's rate."""

from cubeling.app.errors import AppError
from cubeling.characters.rendering import FULL, QUALITIES, Quality

AUTO_QUALITY = "auto"
"""The name of the quality that is chosen by the time that frames take."""

BUDGET_SHARE, SPARE_SHARE = 0.95, 0.5
"""Shares of the time between frames: more is too slow, less leaves time for a better quality."""

PATIENCE_S, FIRST_TRIAL_S = 1.5, 10.0
"""So long must frames be too slow for a lower quality, and fast enough for a higher one [s]."""

MAX_TRIAL_S = 320.0
"""Each higher quality that was too slow doubles the time to the next trial, up to this [s]."""

SMOOTHING_S = 0.5
"""Time constant of the mean time of a frame [s], so that one slow frame changes nothing."""


def checked_quality(name: str) -> str:
    """Return the name of a quality.

    Raises
    ------
    AppError
        There is no such quality.
    """
    if name != AUTO_QUALITY and name not in QUALITIES:
        known = ", ".join((AUTO_QUALITY, *QUALITIES))
        raise AppError(f"there is no quality '{name}': choose one of {known}")
    return name


class QualityControl:
    """Steps down where frames take too long, and up where there is time; `full` comes first.

    `rate` is that of the camera [frames/s]. In `software`, deferred shading is not tried: it takes
    four times as long, and each trial would be seen.
    """

    def __init__(self, rate: float, software: bool = False) -> None:
        self._interval = 1.0 / max(rate, 1.0)
        self._qualities = tuple(
            each for each in QUALITIES.values() if not (software and each.deferred)
        )
        self._level = self._qualities.index(FULL)
        self._mean = 0.0
        self._waited = 0.0  # since frames are too slow, or fast enough [s]
        self._since_trial = float("inf")
        self._trial_s = FIRST_TRIAL_S

    @property
    def quality(self) -> Quality:
        """The quality for the next frame."""
        return self._qualities[self._level]

    def update(self, seconds: float) -> Quality:
        """Take the time that a frame took into account [s], and return the quality for the next."""
        step = max(seconds, self._interval)
        self._mean += self._interval / SMOOTHING_S * (seconds - self._mean)
        self._since_trial += step
        too_slow = self._mean > BUDGET_SHARE * self._interval
        fast = self._mean < SPARE_SHARE * self._interval
        down = too_slow and self._level + 1 < len(self._qualities)
        up = fast and self._level > 0
        self._waited = self._waited + step if down or up else 0.0
        if down and self._waited > PATIENCE_S:
            if self._since_trial < self._trial_s:
                self._trial_s = min(2 * self._trial_s, MAX_TRIAL_S)
            self._change(1)
        elif up and self._waited > self._trial_s:
            self._since_trial = 0.0
            self._change(-1)
        return self.quality

    def _change(self, levels: int) -> None:
        self._level += levels
        self._waited = 0.0
