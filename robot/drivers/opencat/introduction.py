"""What a robot has, as its model and its settings say; the board itself tells only two words."""

from robot.contract.catalogue import MAX_NAME_BYTES, Catalogue
from robot.drivers.opencat.models import MODELS
from robot.drivers.opencat.settings import Behaviour


def catalogue_of(model: str, name: str, version: str, behaviour: Behaviour) -> Catalogue:
    """Return what a robot of this model has, which calls itself `name`, or nothing."""
    return Catalogue(
        name=(name or "OpenCat").encode()[:MAX_NAME_BYTES].decode(errors="ignore"),
        firmware=f"OpenCat {version}".strip(),
        joints=tuple(joint.limits for joint in MODELS[model]),
        motions=behaviour.motions,
        sounds=tuple(behaviour.sounds),
        moods=tuple(behaviour.moods),
    )
