"""Which parameters of expressivity show in a gesture."""

from collections.abc import Sequence

from cubeling.characters.behaviour.gestures.style.trunk import BODY_EXTENT
from cubeling.characters.behaviour.symbolic_gesture import BodyKey, HandKey, SymbolicGesture

VISIBLE_DEG = 5.0
"""Turn of trunk or head that can be seen [degrees]."""


def without_effect(gesture: SymbolicGesture) -> tuple[str, ...]:
    """Return the parameters, fields of `GestureExpressivity`, that do not show in a gesture.

    What a hand touches is as far away as ever, however wide the gesture is; and what only bends
    the ways of hands does nothing without hands.

    >>> from cubeling.characters.behaviour.symbolic_gesture import Place
    >>> touch = (HandKey(0.0, Place(contact="hip")), HandKey(1.0, Place(contact="hip")))
    >>> without_effect(SymbolicGesture("TOUCH", right=touch))
    ('spatial',)
    >>> without_effect(SymbolicGesture("NOD", body=(BodyKey(0.0), BodyKey(1.0, nod_deg=12.0))))
    ('openness', 'fluidity', 'bias', 'tension', 'power')
    """
    hands = (*gesture.right, *gesture.left)
    turn = _largest_turn_deg(gesture.body)
    shows = {
        "spatial": any(map(_has_room, hands)) or BODY_EXTENT * turn >= VISIBLE_DEG,
        "openness": bool(hands),
        "fluidity": bool(hands),
        "bias": bool(hands),
        "tension": bool(hands),
        # Full power adds as much of a step of the trunk again.
        "power": bool(hands) or _largest_step_deg(gesture.body) >= VISIBLE_DEG,
    }
    return tuple(name for name, shown in shows.items() if not shown)


def _has_room(key: HandKey) -> bool:
    """Return whether a hand is somewhere in the gesture space, or bows on its way there."""
    return not key.place.contact or (key.path in ("arc", "circle", "wave") and any(key.radius))


def _largest_turn_deg(keys: Sequence[BodyKey]) -> float:
    return max(
        (
            abs(angle)
            for each in keys
            for angle in (*_trunk(each), each.nod_deg, each.tilt_deg, each.shake_deg)
        ),
        default=0.0,
    )


def _largest_step_deg(keys: Sequence[BodyKey]) -> float:
    """Return the largest step of the trunk from key to key, from upright on [degrees]."""
    steps = zip((BodyKey(0.0), *keys), keys, strict=False)
    return max(
        (
            abs(b - a)
            for one, other in steps
            for a, b in zip(_trunk(one), _trunk(other), strict=True)
        ),
        default=0.0,
    )


def _trunk(key: BodyKey) -> tuple[float, float, float]:
    return key.lean_deg, key.side_deg, key.turn_deg
