"""The character that performs the edited gesture, through the same animator as in play."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import moderngl
import numpy as np
from numpy.typing import NDArray

from cubeling.app.workshop.gesture_editor.editing.document import GestureDocument, moves
from cubeling.app.workshop.gesture_editor.editing.timing import duration
from cubeling.app.workshop.gesture_editor.shown_space import ShownSpace
from cubeling.characters import (
    Animator,
    Character,
    CharacterCommand,
    GestureLayer,
    InPlaceController,
    LayerFactory,
    PosedCharacter,
    layers_of,
)
from cubeling.characters.behaviour import (
    BehaviourIntent,
    GestureIntent,
    GestureRealizer,
    Hand,
    SymbolicGesture,
    natural_times,
)
from cubeling.characters.rendering import (
    CameraView,
    CharacterExtent,
    PortraitCamera,
    SceneCharacter,
    Stage,
)

Picture = NDArray[np.uint8]

BACKDROP_BGR = 240, 246, 250
"""Colour behind the character."""

LEAD_S = 0.5
"""Time that the character stands before the gesture [s]."""

PAUSE_S = 0.6
"""Time that it stands between two plays [s]."""

STEP_S, LONG_STEP_S = 1 / 30, 0.2
"""Steps of the animator up to a time that is shown [s]: the last ones, and those before."""

EXACT_S = 0.1
"""How long before a time that is shown the steps are short [s]."""

MARGIN_SHARE = 0.04
"""What stays free on each side of the picture."""

HEADROOM_SHARE = 0.12
"""What the picture shows above a character, for raised hands, over its height."""

ELEVATION_RAD = 0.12
"""How far the camera looks down [rad]."""


@dataclass(frozen=True)
class PreviewedGesture:
    """What the preview performs; one that differs starts afresh."""

    gesture: SymbolicGesture

    hand: Hand
    """Which hand, if it is one-handed."""

    character: str
    """A bundled name, or a file."""

    @staticmethod
    def of(document: GestureDocument, character: str) -> "PreviewedGesture":
        """Return what a document asks for; its words do not change how it is performed."""
        return PreviewedGesture(
            replace(document.gesture, name="", summary=""), document.hand, character
        )

    @property
    def cycle(self) -> float:
        """Time from one play to the next [s]."""
        return duration(self.gesture) + PAUSE_S

    def command(self, time: float) -> CharacterCommand:
        """Return the command at a time from the first start of the gesture [s]."""
        if not moves(self.gesture):
            return CharacterCommand(time + LEAD_S)
        number = max(int(time // self.cycle), 0)
        intent = GestureIntent(
            f"preview {number}",
            self.gesture,
            natural_times(self.gesture, LEAD_S + number * self.cycle),
            self.hand,
            self.gesture.expressivity,
        )
        return CharacterCommand(time + LEAD_S, behaviour=BehaviourIntent(gestures=(intent,)))


class Preview:
    """Poses and draws the character; a time that is shown again gives the same pose.

    Parameters
    ----------
    context
        Where it draws; it is not released. None to pose only.
    load
        Returns a character by its name; `Character.load` without one.
    """

    def __init__(
        self, context: moderngl.Context | None, load: Callable[[str], Character] | None = None
    ) -> None:
        self._context, self._load = context, load or Character.load
        self._characters: dict[str, Character] = {}
        self._previewed: PreviewedGesture | None = None
        self._animator: Animator | None = None
        self._time = 0.0
        self._posed: PosedCharacter | None = None
        self._stage: Stage | None = None
        self._layers: dict[str, GestureLayer] = {}
        self._realizers: dict[str, GestureRealizer] = {}
        self._cameras: dict[tuple[str, tuple[int, int]], PortraitCamera] = {}

    def character(self, name: str) -> Character:
        """Return a character, which is read once."""
        if name not in self._characters:
            self._characters[name] = self._load(name)
        return self._characters[name]

    def pose(self, previewed: PreviewedGesture, time: float) -> PosedCharacter:
        """Return the character at a time from the start of the gesture [s].

        Times may go on over many plays. A short step ahead is one update; other times, and
        another gesture, are played from the start.
        """
        ahead = time - self._time
        if previewed != self._previewed or not -1e-9 <= ahead <= LONG_STEP_S:
            self._previewed = previewed
            self._animator = self._new_animator(previewed.character)
            self._play(previewed, -LEAD_S, time)
        elif ahead > 1e-9 or self._posed is None:
            self._update(previewed, time)
        assert self._posed is not None, "it was updated"
        return self._posed

    def draw(self, previewed: PreviewedGesture, time: float, size: tuple[int, int]) -> Picture:
        """Return a picture of the character at a time, (height, width, 3) BGR."""
        posed = self.pose(previewed, time)
        if self._stage is None or self._stage.size != size:
            assert self._context is not None, "it was made to draw"
            self.release()
            self._stage = Stage(self._context, size)
        camera = self.camera(previewed.character, size)
        paper = np.full((size[1], size[0], 3), BACKDROP_BGR, np.uint8)
        view = CameraView(paper, camera.matrix, np.zeros(0), camera.camera_from_table)
        character = self.character(previewed.character)
        return self._stage.draw(view, [SceneCharacter(character, posed)])

    def shown_space(
        self, previewed: PreviewedGesture, size: tuple[int, int], left: bool
    ) -> ShownSpace:
        """Return the gesture space of a hand in the pictures of `draw`."""
        name = previewed.character
        assert self._posed is not None, "it was drawn"
        space = self._realizer(name).space
        space = replace(space, spatial=previewed.gesture.expressivity.spatial)
        placed = self._posed.table_from_character
        return ShownSpace(space, placed, self.camera(name, size), left)

    def camera(self, name: str, size: tuple[int, int]) -> PortraitCamera:
        """Return the camera that sees a character and what its hands may reach."""
        key = name, size
        if key not in self._cameras:
            character = self.character(name)
            posed = self._new_animator(name).update(CharacterCommand(0.0))
            extent, sitting = CharacterExtent(character), self._realizer(name).posture
            points = np.concatenate([extent.points(pose) for pose in (posed.pose, sitting)])
            top = points[:, 1].max() + HEADROOM_SHARE * np.ptp(points[:, 1])
            points = np.concatenate([points, [[0.0, top, 0.0]]])
            placed = posed.table_from_character
            table = points @ placed[:3, :3].T + placed[:3, 3]
            self._cameras[key] = PortraitCamera.around(table, ELEVATION_RAD, size, MARGIN_SHARE)
        return self._cameras[key]

    def release(self) -> None:
        """Release what draws; a second call does nothing."""
        if self._stage is not None:
            self._stage.release()
        self._stage = None

    def _realizer(self, name: str) -> GestureRealizer:
        if name not in self._realizers:
            self._realizers[name] = GestureRealizer.of(self.character(name))
        return self._realizers[name]

    def _new_animator(self, name: str) -> Animator:
        """Return an animator of somebody who stays; gestures that were planned stay known."""
        character = self.character(name)
        known = self._layers.setdefault(name, GestureLayer(character))
        others = [layer for layer in layers_of(character) if layer is not GestureLayer]
        layers: list[LayerFactory] = [*others, lambda _character, _seed: known]
        return Animator(character, layers=layers, controller=InPlaceController)

    def _play(self, previewed: PreviewedGesture, start: float, end: float) -> None:
        """Play from the start of an animator up to a time."""
        start = max(start, end - 2 * previewed.cycle)
        now = start
        self._update(previewed, start)
        while now < end - 1e-9:
            step = LONG_STEP_S if now + LONG_STEP_S < end - EXACT_S else STEP_S
            now = min(now + step, end)
            self._update(previewed, now)

    def _update(self, previewed: PreviewedGesture, time: float) -> None:
        assert self._animator is not None, "a previewed gesture has an animator"
        self._time = time
        self._posed = self._animator.update(previewed.command(time))
