"""Edits: each takes a document and returns another one."""

from dataclasses import replace
from itertools import pairwise
from typing import Any, Literal

from cubeling.app.workshop.gesture_editor.editing.document import GestureDocument, Key, Row
from cubeling.characters.behaviour import (
    SECTORS_X,
    SECTORS_Y,
    BodyKey,
    HandKey,
    SymbolicGesture,
    across,
)

Phase = Literal["preparation", "stroke", "hold", "retraction"]
PHASES: tuple[Phase, ...] = ("preparation", "stroke", "hold", "retraction")
"""The phases of a gesture in the order of time: fields of `SymbolicGesture`."""

SHORTEST_S: dict[Phase, float] = {
    "preparation": 0.1, "stroke": 0.1, "hold": 0.0, "retraction": 0.1,
}  # fmt: skip
"""How short each phase may be made [s]."""

LONGEST_S = 10.0
"""How long a phase may be made [s]."""

MIN_KEY_GAP = 0.02
"""Least distance of two keys, over the duration of the stroke."""

MAX_REPEATS = 12
"""Most performances of a stroke."""


def change_gesture(document: GestureDocument, **fields: Any) -> GestureDocument:
    """Change fields of the gesture."""
    return replace(document, gesture=replace(document.gesture, **fields))


def change_expressivity(document: GestureDocument, name: str, value: float) -> GestureDocument:
    """Change one of the six parameters."""
    expressivity = replace(document.gesture.expressivity, **{name: value})
    return change_gesture(document, expressivity=expressivity)


def change_key(document: GestureDocument, **fields: Any) -> GestureDocument:
    """Change fields of the selected key."""
    if not 0 <= document.index < len(document.keys):
        return document
    keys = list(document.keys)
    keys[document.index] = replace(keys[document.index], **fields)
    return change_gesture(document, **{document.row: tuple(keys)})


def change_place(document: GestureDocument, **fields: Any) -> GestureDocument:
    """Change where the selected hand is; without a selected key, add one there.

    A hand that is put into a sector leaves what it touched, and goes to the middle of the sector.
    """
    if document.hand_row is None:
        return document
    if document.hand_key is None:
        document = add_key(document, 0.0)
    key = document.hand_key
    assert key is not None, "a key was added"
    if "contact" not in fields:
        x, y, z = (
            0.0 if axis in fields else old
            for axis, old in zip("xyz", key.place.offset, strict=True)
        )
        fields = {**fields, "contact": "", "offset": (x, y, z)}
    return change_key(document, place=replace(key.place, **fields))


def change_direction(
    document: GestureDocument, field: Literal["palm", "fingers"], words: str
) -> GestureDocument:
    """Change where the palm faces or the fingers point.

    The other of the two stays, unless both would be along one line: no hand can do that.
    """
    key = document.hand_key
    if key is None:
        return document
    other: Literal["palm", "fingers"] = "fingers" if field == "palm" else "palm"
    kept = getattr(key, other)
    if not across(words, kept, left=True):
        kept = next(each for each in ("forward", "up") if across(words, each, left=True))
    return change_key(document, **{field: words, other: kept})


def add_key(document: GestureDocument, at: float) -> GestureDocument:
    """Add a key to the selected row, as near as there is room, and select it.

    The first key of a row goes to the start; a new one is like the key before it.
    """
    keys = document.keys
    if not keys:
        if document.row == "left":
            document = change_gesture(document, one_handed=False)
        first: Key = BodyKey(0.0) if document.row == "body" else HandKey(0.0)
        return change_gesture(document, **{document.row: (first,)}).select(document.row, 0)
    place = _free_time([key.at for key in keys], at)
    if place is None:
        return document
    before = [key for key in keys if key.at < place]
    new = replace((before or keys)[-1 if before else 0], at=place)
    ordered = tuple(sorted((*keys, new), key=lambda key: key.at))
    return change_gesture(document, **{document.row: ordered}).select(document.row, len(before))


def remove_key(document: GestureDocument) -> GestureDocument:
    """Remove the selected key, and select the one before it."""
    keys = document.keys
    left = keys[: document.index] + keys[document.index + 1 :]
    return change_gesture(document, **{document.row: left}).select(document.row, document.index - 1)


def move_key(document: GestureDocument, at: float) -> GestureDocument:
    """Move the selected key to another time of the stroke, 0…1, between its neighbours."""
    keys, index = document.keys, document.index
    if not 0 <= index < len(keys):
        return document
    low = keys[index - 1].at + MIN_KEY_GAP if index > 0 else 0.0
    high = keys[index + 1].at - MIN_KEY_GAP if index + 1 < len(keys) else 1.0
    return change_key(document, at=round(min(max(at, low), high), 4))


def change_phase(document: GestureDocument, phase: Phase, seconds: float) -> GestureDocument:
    """Change how long a phase lasts [s], within its limits."""
    length = round(min(max(seconds, SHORTEST_S[phase]), LONGEST_S), 4)
    return change_gesture(document, **{phase: length})


def move_sector(document: GestureDocument, outward: int, down: int) -> GestureDocument:
    """Move the selected hand by whole sectors of the gesture space."""
    key = document.hand_key
    if key is None:
        return document
    x = min(max(SECTORS_X.index(key.place.x) - outward, 0), len(SECTORS_X) - 1)
    y = min(max(SECTORS_Y.index(key.place.y) + down, 0), len(SECTORS_Y) - 1)
    return change_place(document, x=SECTORS_X[x], y=SECTORS_Y[y])


def mirror(document: GestureDocument) -> GestureDocument:
    """Exchange left and right: hands, and sideways angles of trunk and head.

    A one-handed gesture stays with `right`, which stands for either hand.
    """
    gesture = document.gesture
    body = tuple(
        replace(
            key,
            side_deg=-key.side_deg,
            turn_deg=-key.turn_deg,
            tilt_deg=-key.tilt_deg,
            shake_deg=-key.shake_deg,
        )
        for key in gesture.body
    )
    if gesture.one_handed:
        hand: Literal["left", "right"] = "right" if document.hand == "left" else "left"
        return replace(change_gesture(document, body=body), hand=hand)
    mirrored = change_gesture(document, right=gesture.left, left=gesture.right, body=body)
    other: dict[Row, Row] = {"right": "left", "left": "right", "body": "body"}
    return mirrored.select(other[document.row], document.index)


def with_hands(document: GestureDocument, choice: str) -> GestureDocument:
    """Let a gesture be performed by "right", "left", "both" or "either" of the hands.

    Hands that had no part get the keys of the one that had.
    """
    gesture = document.gesture
    keys = (gesture.left or gesture.right) if choice == "left" else gesture.right or gesture.left
    if choice == "either":
        document = change_gesture(document, one_handed=True, right=keys, left=())
    elif choice == "both":
        right, left = gesture.right or keys, gesture.left or keys
        document = change_gesture(document, one_handed=False, right=right, left=left)
    else:
        other = "left" if choice == "right" else "right"
        document = change_gesture(document, **{"one_handed": False, choice: keys, other: ()})
    row: Row = "left" if choice == "left" else "right"
    return replace(document, hand="right").select(row, document.index)


def hands_of(gesture: SymbolicGesture) -> str:
    """Return the hands that perform a gesture: the argument of `with_hands`."""
    if gesture.one_handed:
        return "either"
    if gesture.left and gesture.right:
        return "both"
    return "left" if gesture.left else "right"


def gesture_name(words: str) -> str:
    """Return the name of a gesture, as lexemes of BML are written.

    >>> gesture_name(" high five! ")
    'HIGH_FIVE'
    """
    kept = "".join(letter if letter.isalnum() else " " for letter in words)
    return "_".join(kept.upper().split())


def neighbour(document: GestureDocument, step: int) -> GestureDocument:
    """Select the next or the previous key of the row."""
    return document.select(document.row, document.index + step)


def _free_time(times: list[float], at: float) -> float | None:
    """Return the time nearest to `at` that is free, or the middle of the widest gap."""
    at = min(max(at, 0.0), 1.0)
    if all(abs(at - each) >= MIN_KEY_GAP for each in times):
        return round(at, 4)
    gaps = [(high - low, (high + low) / 2) for low, high in pairwise(times)]
    gaps += [(2 * (1.0 - times[-1]), 1.0), (2 * times[0], 0.0)]
    width, middle = max(gaps)
    return round(middle, 4) if width >= 2 * MIN_KEY_GAP else None
