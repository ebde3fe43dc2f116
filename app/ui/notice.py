"""Notices for the player: the camera delivers no new frames, or its lens is not as it claims."""

import math
from dataclasses import dataclass

from cubeling.tracking import Health, Intrinsics, LensEstimate


@dataclass(frozen=True)
class Notice:
    """A message over the last picture."""

    title: str
    """The problem, in a few words."""

    advice: str
    """What to do about it."""


def notice(health: Health) -> Notice | None:
    """Return a notice about the health of a live source; None if it works.

    >>> notice(Health("camera 0", "lost", 5.0)).title
    'Camera lost: plug it in again'
    """
    if health.state in ("running", "closed"):
        return None
    if health.images_unusable:
        return Notice(
            "The camera's pictures cannot be used", "They are broken, or have another size."
        )
    if health.name.startswith("http"):
        return Notice("No picture from the phone", "Is its camera app open, and in this network?")
    if health.name == "phone":
        return Notice(
            "The phone sends no picture", "Open its page again, and let it use the camera."
        )
    if health.frozen:
        return Notice("The picture is frozen", "Uncover the camera, or plug it in again.")
    return Notice("Camera lost: plug it in again", "The session then continues.")


def focal_length(intrinsics: Intrinsics) -> str:
    """Return the focal length with its standard deviation, and the angle from side to side.

    >>> focal_length(Intrinsics.guess((1280, 720)))
    '1109 px ± 35 %, 60° wide'
    """
    focal, deviation = float(intrinsics.matrix[0, 0]), intrinsics.focal_deviation
    stated = "" if deviation is None else f" ± {100 * deviation:.2g} %"
    wide = 2 * math.degrees(math.atan(intrinsics.size[0] / 2 / focal))
    return f"{focal:.0f} px{stated}, {wide:.0f}° wide"


def lens_notice(lens: LensEstimate, intrinsics: Intrinsics) -> str | None:
    """Return what to say of a lens, in Rich's markup; None where nothing is surely wrong with it.

    The pixels are how far a line along the top of the picture is bent from its middle to its ends.

    >>> camera = Intrinsics.guess((1280, 720))
    >>> (lens_notice(LensEstimate(0.1, 0.01), camera) or "")[:52]
    "This camera's lens bends straight lines by 12 pixels"
    >>> lens_notice(LensEstimate(0.1, 0.04), camera)
    """
    if not lens.off:
        return None
    focal = float(intrinsics.matrix[0, 0])
    right, top = (side / 2 / focal for side in intrinsics.size)
    bend = focal * abs(lens.k1) * top * right**2
    more = " more than its calibration says" if intrinsics.distortion.any() else ""
    return (
        f"This camera's lens bends straight lines by {bend:.0f} pixels{more} "
        "at the edge of the picture: [cyan]cubeling calibrate[/] would place the character better."
    )
