"""What a picture tells beside the cube's pose: the hand, the light, the softness, the room."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

from cubeling.tracking.appearance.appearance import Appearance
from cubeling.tracking.cube.model import CubeModel
from cubeling.tracking.geometry.arrays import Array
from cubeling.tracking.geometry.frame import Frame
from cubeling.tracking.geometry.intrinsics import Intrinsics
from cubeling.tracking.geometry.state import CubeState

if TYPE_CHECKING:
    from cubeling.tracking.appearance.hand.finder import HandFinder
    from cubeling.tracking.appearance.light import LightMeter
    from cubeling.tracking.appearance.picture_quality import QualityMeter
    from cubeling.tracking.appearance.room.room_meter import RoomMeter

APPEARANCE_PARTS = ("hand", "light", "softness", "room")
"""What can be measured."""


class AppearanceMeter:
    """Measures the appearance, frame by frame.

    Parameters
    ----------
    cube, intrinsics
        The cube in play, and the camera, which stands still.
    parts
        Which of `APPEARANCE_PARTS` are measured.
    """

    _hand: "HandFinder | None" = None
    _light: "LightMeter | None" = None
    _softness: "QualityMeter | None" = None
    _room: "RoomMeter | None" = None

    def __init__(
        self,
        cube: CubeModel,
        intrinsics: Intrinsics,
        parts: Sequence[str] = APPEARANCE_PARTS,
    ) -> None:
        # What is not measured is not loaded.
        if "hand" in parts:
            from cubeling.tracking.appearance.hand.finder import HandFinder

            self._hand = HandFinder(cube, intrinsics)
        if "light" in parts:
            from cubeling.tracking.appearance.light import LightMeter

            self._light = LightMeter(cube, intrinsics)
        if "softness" in parts:
            from cubeling.tracking.appearance.picture_quality import QualityMeter

            self._softness = QualityMeter(cube, intrinsics)
        if "room" in parts:
            from cubeling.tracking.appearance.room.room_meter import RoomMeter

            self._room = RoomMeter(intrinsics)

    def update(
        self, frame: Frame, state: CubeState, camera_from_table: Array | None = None
    ) -> Appearance:
        """Return the appearance of the next frame, in which the cube has a state.

        The pose of the table, (4, 4), tells where up is: light comes from there more often.
        """
        up = None if camera_from_table is None else camera_from_table[:3, 1]
        image, now, room = frame.image, frame.timestamp, self._room
        light = None if self._light is None else self._light.update(image, state, up)
        return Appearance(
            None if self._hand is None else self._hand.update(image, state),
            light,
            None if self._softness is None else self._softness.update(image, state),
            now,
            None if room is None else room.update(image, camera_from_table, light, now),
        )
