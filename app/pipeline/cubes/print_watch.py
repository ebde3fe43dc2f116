"""A cube that is not printed as its file says: the player is told in what it differs."""

from functools import cached_property
from typing import TYPE_CHECKING

from cubeling.tracking import CubeModel, CubeState, Frame, Intrinsics, side_of

if TYPE_CHECKING:  # loaded when the print is first looked at
    from cubeling.tracking import PrintCheck, PrintFault

LOOK_EVERY_S, LOOK_AFTER_S = 1.0, 1.0
"""The print is looked at so often, first so long after the first picture, which should not wait for
it, and after so long without the cube; a look takes as long as two to five frames."""

ENOUGH_LOOKS = 4
"""After so many looks that find a cube in view right, it is right."""

SHOWN_S = 8.0
"""A fault of a cube that is tracked all the same is named for so long."""


class PrintWatch:
    """Looks at the print of the cube in play: at first, and while the cube is not found.

    Parameters
    ----------
    cube
        The cube in play.
    intrinsics
        Of the camera.
    """

    def __init__(self, cube: CubeModel, intrinsics: Intrinsics) -> None:
        self.printed = cube
        """The cube as it is printed, as far as it is tracked so: AprilTags of OpenCV 4 are."""
        self._intrinsics = intrinsics
        self._unseen_since: float | None = None
        self._looked_at: float | None = None
        self._named_at = float("-inf")
        self._fault: PrintFault | None = None

    @cached_property
    def _check(self) -> "PrintCheck":
        from cubeling.tracking import PrintCheck

        return PrintCheck(self.printed, self._intrinsics)

    def update(self, frame: Frame, state: CubeState) -> "PrintFault | None":
        """Return in what the print differs from the file, None where that is not to be told."""
        now = frame.timestamp
        if state.visible or self._unseen_since is None:
            self._unseen_since = now
        if self._looked_at is None:
            self._looked_at = now
            return None
        several = len(set(map(side_of, state.faces))) > 1
        lost = now - self._unseen_since >= LOOK_AFTER_S
        ready = now - self._looked_at >= LOOK_EVERY_S
        if ready and (lost or (several and self._check.agreed < ENOUGH_LOOKS)):
            self._looked_at = now
            self._check.look(frame)
            self._note(self._check.fault, now)
        told = not state.visible or now - self._named_at < SHOWN_S
        return self._fault if told else None

    def _note(self, fault: "PrintFault | None", now: float) -> None:
        if fault != self._fault:
            self._fault, self._named_at = fault, now
            if fault is not None and fault.kind == "turned":
                from cubeling.tracking import cube_with

                self.printed = cube_with(self.printed, fault)


def fault_advice(fault: "PrintFault", cube: CubeModel) -> str:
    """Return what to tell the player about a print.

    >>> from cubeling.tracking import PrintFault
    >>> companion = CubeModel.load("companion")
    >>> fault_advice(PrintFault("rolled", ("front",), 90), companion)
    'The marker of front is rolled: its roll_deg should be 90'
    >>> fault_advice(PrintFault("size", marker_mm=46.4), companion)
    'The markers are not 45 mm but 46.4 mm, if the edge is right'
    """
    names = " and ".join(fault.faces)
    return {
        "rolled": f"The marker of {names} is rolled: its roll_deg should be {fault.roll_deg}",
        "swapped": f"{names} have each other's markers: exchange their marker_id",
        "turned": "AprilTags turned by 180°, as OpenCV 4 prints them: I read them so",
        "mirrored": "The markers are mirrored: is it the picture, or the print?",
        "inverted": "The markers are printed white on black: print them black on white",
        "size": f"The markers are not {cube.marker_size * 1000:.4g} mm but {fault.marker_mm:g} mm, "
        "if the edge is right",
    }[fault.kind]
