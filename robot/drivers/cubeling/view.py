"""What a robot's last STATE means in words and units, by its own catalogue."""

from dataclasses import replace
from types import MappingProxyType

from affect import Emotion
from robot.contract.catalogue import Catalogue
from robot.contract.telemetry import Telemetry
from robot.protocol import messages as m


def view_of(link: Telemetry, state: m.State | None, catalogue: Catalogue | None) -> Telemetry:
    """Fill in what the robot said of itself; nothing where it has said nothing yet."""
    if state is None or catalogue is None:
        return link
    names = (joint.name for joint in catalogue.joints)
    return replace(
        link,
        observed=Emotion(state.valence, state.arousal, _name(catalogue.moods, state.mood)),
        battery=state.battery,
        charging=bool(state.flags & m.CHARGING),
        stopped=bool(state.flags & m.STILL),
        limp=bool(state.flags & m.LIMP),
        reckoned=bool(state.flags & m.RECKONED),
        joints=MappingProxyType(dict(zip(names, state.joints, strict=False))),
        motion=_name(catalogue.motions, state.motion),
        sound=_name(catalogue.sounds, state.sound),
    )


def _name(names: tuple[str, ...], index: int) -> str | None:
    return names[index] if index < len(names) else None
