"""The bundled explorer's hands: three fingers and a thumb, a little curled, palms to the thighs."""

from tools.authoring.human.rig import FINGERS, in_hand
from tools.authoring.human.skull import SKIN
from tools.authoring.modelling.sculpt import BodyPart
from tools.authoring.modelling.shapes import RoundCone, Union, cone_chain

FINGER_RADII_M = {
    "Thumb": (0.021, 0.0195, 0.0165),
    "Index": (0.0185, 0.0178, 0.0155),
    "Middle": (0.019, 0.0182, 0.0158),
    "Pinky": (0.0175, 0.0165, 0.0145),
}
"""At the knuckle, the middle joint and the tip of each finger [m]."""


def hand() -> BodyPart:
    """Return the left hand."""
    bones = ("LeftHand",)
    heel, front, back = in_hand(
        ((-0.01, 0.0, 0.0), (0.062, 0.022, -0.001), (0.060, -0.016, -0.001))
    )
    palm = Union(
        (
            RoundCone(heel, front, 0.034, 0.033, bones=bones, color=SKIN),
            RoundCone(heel, back, 0.034, 0.031, bones=bones, color=SKIN),
        ),
        0.02,
    )
    fingers = [
        cone_chain(
            in_hand(points),
            FINGER_RADII_M[name],
            (f"LeftHand{name}1", f"LeftHand{name}2"),
            SKIN,
            0.006,
        )
        for name, points in FINGERS.items()
    ]
    return BodyPart(Union((palm, *fingers), 0.010), 0.0145, soft_skin=0.010)
