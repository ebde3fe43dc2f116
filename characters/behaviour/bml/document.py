"""What a BML block says: behaviours, when they are to be, and what to do with running blocks.

Source: *Behavior Markup Language 1.0* (Kopp et al. 2006; the SAIBA standard of 2013). Attributes
of the namespace bmla are those of AsapRealizer (van Welbergen et al. 2014).
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal

BML = "http://www.bml-initiative.org/bml/bml-1.0"
"""Namespace of the standard; documents without a namespace are read as if they named it."""

BMLA = "http://www.asap-project.org/bmla"
"""Namespace of interrupt, activate, preplan, chunkAfter and parametervaluechange."""

CUBELING = "urn:cubeling:behaviour"
"""Namespace of `tempo`, `clip`, and attributes named as the fields of `GestureExpressivity`."""

GESTURE_SYNCS = ("start", "ready", "strokeStart", "stroke", "strokeEnd", "relax", "end")
"""Sync points of gesture, pointing and head."""

FACE_SYNCS = ("start", "attackPeak", "relax", "end")
"""Sync points of face, faceLexeme and faceFacs."""

HOLD_SYNCS = ("start", "ready", "relax", "end")
"""Sync points of gaze and posture."""

SHIFT_SYNCS = ("start", "end")
"""Sync points of what has a beginning and an end only; a speech has those of its marks between."""

SYNCS: Mapping[str, tuple[str, ...]] = {
    **dict.fromkeys(("gesture", "pointing", "head"), GESTURE_SYNCS),
    **dict.fromkeys(("face", "faceLexeme", "faceFacs"), FACE_SYNCS),
    **dict.fromkeys(("gaze", "posture"), HOLD_SYNCS),
    **dict.fromkeys(
        ("speech", "wait", "locomotion", "faceShift", "gazeShift", "headDirectionShift"),
        SHIFT_SYNCS,
    ),
    "postureShift": SHIFT_SYNCS,
}
"""Sync points by kind of behaviour: the kinds that the standard has."""

SYNC_NAMES = frozenset(sync for syncs in SYNCS.values() for sync in syncs)
"""Attributes of a behaviour that say when one of its sync points is to be."""

MAX_BLOCK_S = 3600.0
"""How long after its start a block may end [s], and how far a moment may be from another."""

Composition = Literal["MERGE", "APPEND", "REPLACE"]
"""What a block does with those before it: joins them, waits for their end, or ends them."""


@dataclass(frozen=True)
class SyncReference:
    """A moment: a sync point and an offset, or seconds since the block's start."""

    behaviour: str = ""
    """Whose sync point; "" for the block's start."""

    sync: str = ""
    """Name of the sync point; "" if the offset counts from the block's start."""

    block: str = ""
    """In which block; "" for the one that it stands in."""

    offset: float = 0.0
    """Seconds later than that."""

    def __str__(self) -> str:
        parts = [part for part in (self.block, self.behaviour, self.sync) if part]
        if not parts:
            return f"{self.offset:g}"
        return ":".join(parts) + (f"{self.offset:+g}" if self.offset else "")


@dataclass(frozen=True)
class Constraint:
    """A `constraint`: moments that are one, or come in an order."""

    kind: Literal["synchronize", "before", "after"]
    """Whether `syncs` are all at one moment, or before or after `reference`."""

    syncs: tuple[SyncReference, ...]
    """The moments that are tied; their order means nothing."""

    reference: SyncReference | None = None
    """Which moment they are before or after; None for `synchronize`."""

    id: str = ""
    """Its name, unique in its block; the parser names those that have none."""

    required: bool = False
    """Whether the block fails if it cannot be met."""


@dataclass(frozen=True)
class BmlElement:
    """An element inside a behaviour, as it is written."""

    tag: str
    """Its name, without namespace."""

    namespace: str = BML

    attributes: Mapping[str, str] = field(default_factory=dict)
    """Its attributes; those of a namespace are named "{namespace}name"."""

    children: tuple["BmlElement", ...] = ()
    """The elements inside, in their order."""

    text: str = ""
    """Characters inside, those of its children too."""


@dataclass(frozen=True)
class SyncMark:
    """A sync point in a text: `<sync id="s1"/>`."""

    id: str

    at: int
    """How many characters of `Behaviour.text` are before it."""


@dataclass(frozen=True)
class Behaviour:
    """One thing to do."""

    id: str
    """Its name, unique in its block."""

    kind: str
    """"speech", "gesture", "gazeShift" …: the name of the element, without namespace."""

    namespace: str = BML
    """Namespace of the element."""

    syncs: Mapping[str, SyncReference] = field(default_factory=dict)
    """When its sync points are to be, by name, as far as it is said."""

    attributes: Mapping[str, str] = field(default_factory=dict)
    """All other attributes; those of a namespace are named "{namespace}name"."""

    children: tuple[BmlElement, ...] = ()
    """Elements inside: `stance`, `pose`, `trajectory` …"""

    text: str = ""
    """What a speech says: characters of `text` with white space as single spaces."""

    marks: tuple[SyncMark, ...] = ()
    """Sync points in `text`, in its order."""

    required: bool = False
    """Whether the block fails if it cannot be performed."""

    line: int = 0
    """Line of the document that it begins in; 0 if there is none."""

    yielding: bool = False
    """Whether one of several times of it is given up that cannot be met, instead of all of it."""

    def get(self, name: str, default: str = "", namespace: str = "") -> str:
        """Return an attribute, or the default.

        >>> Behaviour("g1", "gesture", attributes={"lexeme": "BEAT", "{urn:x}power": "1"}).get(
        ...     "power", namespace="urn:x"
        ... )
        '1'
        """
        return self.attributes.get(f"{{{namespace}}}{name}" if namespace else name, default)


@dataclass(frozen=True)
class Block:
    """A `bml` element: behaviours and constraints that are scheduled together."""

    id: str
    """Its name, unique among blocks that are not over; "" to let the realizer name it."""

    behaviours: tuple[Behaviour, ...] = ()

    constraints: tuple[Constraint, ...] = ()
    """When, besides what the behaviours say themselves."""

    composition: Composition = "MERGE"
    """What it does with blocks before it."""

    append_after: tuple[str, ...] = ()
    """It starts when these blocks are over."""

    chunk_after: tuple[str, ...] = ()
    """It starts when these blocks only return to rest: their last gestures lead over to its own."""

    interrupt: tuple[str, ...] = ()
    """Blocks that it ends before it starts."""

    on_start: tuple[str, ...] = ()
    """Blocks that were planned before and are activated when this one starts."""

    preplan: bool = False
    """Whether it is only planned, and waits to be activated."""

    character: str = ""
    """Whose block it is; "" for anybody's."""

    notes: tuple[str, ...] = ()
    """What was changed to read it, if it is in a dialect of BML; one line each."""

    attributes: Mapping[str, str] = field(default_factory=dict)
    """All other attributes; those of a namespace are named "{namespace}name"."""
