"""What the hand does with the cube, in words that a script can answer."""

from cubeling.tracking import CubeControls, CubeModel

STRONGLY_TURNS = 0.5
"""Full turns to the right after which an action is meant strongly, and to the left softly."""


class CubeWords:
    """Names what happens to a cube, each once: "the cube was shaken", "face up: heart", "kiss".

    A face is named by its icon when the cube is put down on another one, and then by its role,
    unless that is "idle". Turning the cube says how strongly: "kiss, strongly".
    """

    def __init__(self, cube: CubeModel) -> None:
        self._faces = {face.side: (face.icon, face.role) for face in cube.faces}
        self._top: str | None = None
        self._lifted = False
        self._strength = ""

    def update(self, controls: CubeControls) -> tuple[str, ...]:
        """Return what has just happened."""
        words = [f"the cube was {gesture}" for gesture in controls.gestures]
        if controls.lifted and not self._lifted:
            words.append("the cube was lifted")
        self._lifted = controls.lifted
        first = self._top is None
        if controls.placed and not first:
            words.append("the cube was put down")
        if controls.resting and controls.top_face not in (None, self._top):
            self._top, self._strength = controls.top_face, ""
            icon, role = self._faces.get(controls.top_face or "", ("", ""))
            if not first:
                words += [f"face up: {icon or role}"] if icon or role else []
                words += [role] if role not in ("", "idle") else []
        return (*words, *self._turned(controls))

    def _turned(self, controls: CubeControls) -> tuple[str, ...]:
        """Return how strongly the action of the face on top is meant, if that has changed."""
        _, role = self._faces.get(self._top or "", ("", "idle"))
        strength = ""
        if abs(controls.turns) >= STRONGLY_TURNS:
            strength = "strongly" if controls.turns > 0.0 else "softly"
        changed, self._strength = strength not in ("", self._strength), strength
        return (f"{role}, {strength}",) if changed and role not in ("", "idle") else ()
