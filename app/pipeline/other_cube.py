"""Another cube than the one that is played with: the player is told which it is."""

from app.pipeline.registry import SCENARIOS
from tracking import CubeModel, CubeRecognizer, CubeState, Frame, bundled_cubes

LOOK_AFTER_S, LOOK_EVERY_S, SHOWN_S = 1.0, 0.5, 1.5
"""After so long without the cube other cubes are looked for, so often; one that was recognised is
named for so long."""


class OtherCube:
    """Recognises the bundled cubes while the cube in play is not seen."""

    def __init__(self, cube: CubeModel) -> None:
        self._cube = cube
        self._recognizer: CubeRecognizer | None = None
        self._unseen_since: float | None = None
        self._looked_at = self._named_at = float("-inf")
        self._name = ""

    def update(self, frame: Frame, state: CubeState) -> str:
        """Return the name of another cube in view, "" for none."""
        now = frame.timestamp
        if state.visible or self._unseen_since is None:
            self._unseen_since, self._name = now, ""
        waited = now - self._unseen_since >= LOOK_AFTER_S
        if waited and now - self._looked_at >= LOOK_EVERY_S:
            self._looked_at = now
            self._look(frame)
        return self._name if now - self._named_at < SHOWN_S else ""

    def _look(self, frame: Frame) -> None:
        if self._recognizer is None:
            others = [each for each in map(CubeModel.load, bundled_cubes()) if self._differs(each)]
            self._recognizer = CubeRecognizer((self._cube, *others))
        found = self._recognizer.recognize(frame.image)
        if found is not None and found is not self._cube:
            self._name, self._named_at = found.name, frame.timestamp

    def _differs(self, other: CubeModel) -> bool:
        markers = {face.marker_id for face in other.faces}
        same = other.dictionary == self._cube.dictionary
        return not (same and markers == {face.marker_id for face in self._cube.faces})


def advice(cube: str, fixed: bool) -> str:
    """Return what to tell the player about another cube; `fixed` if no key changes the scenario.

    >>> advice("companion", False)
    'This is the companion cube: press 3 to play companion'
    >>> advice("locomotion", True)
    'This is the locomotion cube: it plays follow'
    """
    for key, (name, scenario) in enumerate(SCENARIOS.items(), start=1):
        if scenario.cube == cube:
            how = f"it plays {name}" if fixed else f"press {key} to play {name}"
            return f"This is the {cube} cube: {how}"
    return f"This is the {cube} cube"
