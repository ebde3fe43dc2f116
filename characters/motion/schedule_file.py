"""Schedules in XML, as the program `animblender` reads them.

Source: Egges, *Real-time Animation of Interactive Virtual Humans*, 2006, appendices B and C (S13).
The two appendices spell some things differently (erratum 12); both spellings are read.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cache
from typing import TypeVar

import numpy as np

from cubeling.characters.errors import CharacterError, name_list
from cubeling.characters.motion.curves import Adsr, Ease, FadeCurve, Product, Weight
from cubeling.characters.motion.modifiers import Filtered, PoseFilter, Stretch, TimeWindow
from cubeling.characters.motion.motion import Motion
from cubeling.characters.motion.schedule import Action, Schedule
from cubeling.characters.skeleton.anatomy import SIDES, Anatomy
from cubeling.characters.skeleton.masks import subtree
from cubeling.characters.skeleton.pose import Array, Skeleton
from cubeling.characters.xml_elements import XmlElement, XmlLimits, read_xml

_T = TypeVar("_T")

_SIDED_HANIM = {
    "sternoclavicular": "Shoulder",
    "acromioclavicular": "Shoulder",
    "shoulder": "UpperArm",
    "elbow": "LowerArm",
    "wrist": "Hand",
    "hip": "UpperLeg",
    "knee": "LowerLeg",
    "ankle": "Foot",
    "midtarsal": "Toes",
}
_HANIM_PARTS = {
    "HumanoidRoot": "hips",
    "vl5": "spine",
    "vl1": "spine",
    "vt10": "chest",
    "vt1": "upperChest",
    "vc4": "neck",
    "skullbase": "head",
    **{f"{s[0]}_{j}": s + part for s in SIDES for j, part in _SIDED_HANIM.items()},
}
"""Body parts by the joint names of the documents (H-Anim)."""

LIMITS = XmlLimits(bytes=1_000_000, elements=20_000, depth=60)
"""Larger schedules are not written by hand."""

MAX_ACTIVE = 500
"""Actions that are activated: each costs time in every frame."""

SCOPES: dict[str, tuple[str, ...]] = {
    "all": (),
    "torso": ("spine",),
    "head": ("neck", "head"),
    "arms": ("leftShoulder", "rightShoulder"),
    "left_arm": ("leftShoulder", "leftUpperArm"),
    "right_arm": ("rightShoulder", "rightUpperArm"),
    "legs": ("leftUpperLeg", "rightUpperLeg"),
}
"""What a scope covers: these body parts and all joints below them; "all" covers every joint."""

Opener = Callable[[str], Motion]
"""Opens the motion of a name that a schedule gives."""

IdleOpener = Callable[[str], Callable[[], Motion]]
"""Opens an idle motion by its name, and returns what begins it: each action has its own."""


@dataclass(frozen=True)
class _Parameters:
    """How an action takes part: weights of joints, and what changes them in time."""

    weights: Array
    """(joints,)."""

    scales: Array
    """(joints,)."""

    curves: tuple[Weight, ...] = ()


class ScheduleReader:
    """Reads schedules for a skeleton.

    Parameters
    ----------
    skeleton, anatomy
        Whose joints the schedules mix.
    open_motion, open_idle
        Open a recorded motion, and what begins an endless idle motion, of the names that a
        schedule gives.
    filters
        Make filters of poses, by the type of the modifier that asks for one.
    """

    def __init__(
        self,
        skeleton: Skeleton,
        anatomy: Anatomy,
        open_motion: Opener,
        open_idle: IdleOpener,
        filters: Mapping[str, Callable[[], PoseFilter]] | None = None,
    ) -> None:
        self._skeleton, self._anatomy = skeleton, anatomy
        # Actions that name one file share it: a recording may take a second to open. An idle
        # motion goes on from where it was last asked for, so two actions cannot share that.
        self._open_motion, self._open_idle = cache(open_motion), cache(open_idle)
        self._scope = cache(self._joints_in)
        self._filters = dict(filters or {})
        self._origin = ""

    def read(self, text: bytes, origin: str) -> Schedule:
        """Return the schedule in a document; `origin` names it in messages.

        Raises
        ------
        CharacterError
            If it is not XML, or says something that is not known; the message has the line.
        """
        self._origin = origin
        root = read_xml(text, LIMITS, lambda line: f"{origin}:{line}")
        if root.tag != "blendingschedule":
            raise self._error(root, f"<{root.tag}> is not a <blendingschedule>")
        self._check_tag(root, ("actionpool", "activate"))
        pool: dict[str, Action] = {}
        for part in root.children:
            if part.tag == "actionpool":
                self._check_tag(part, ("blendingaction",))
                for each in part.children:
                    if self._name(each) in pool:
                        raise self._error(each, f"a second action {self._name(each)!r}; rename one")
                    pool[self._name(each)] = self._action(each)
        activated = [each for each in root.children if each.tag == "activate"]
        if not activated:
            raise self._error(root, "no action is activated; add <activate>")
        if len(activated) > MAX_ACTIVE:
            raise self._error(activated[MAX_ACTIVE], f"more than {MAX_ACTIVE} actions activated")
        actions = [self._activate(each, pool) for each in activated]
        counts: dict[str, int] = {}
        for number, action in enumerate(actions):
            counts[action.name] = count = counts.get(action.name, 0) + 1
            if count > 1:
                actions[number] = replace(action, name=f"{action.name} #{count}")
        return Schedule(tuple(actions), self._skeleton.rest)

    def _action(self, element: XmlElement) -> Action:
        """Return an action of the pool, which starts at 0."""
        self._check_tag(element, ("blendingparams", "blendableobject"))
        motion = self._object(self._one(element, "blendableobject"))
        found = [each for each in element.children if each.tag == "blendingparams"]
        if len(found) > 1:
            raise self._error(found[1], "a second <blendingparams>; use one of type merge")
        plain = _Parameters(np.ones(len(self._skeleton)), np.ones(len(self._skeleton)))
        chosen = self._parameters(found[0], motion.duration) if found else plain
        top = float(chosen.weights.max())
        always = element.attributes.get("alwaysrender", "false").lower()
        if always not in ("true", "false"):
            raise self._error(element, f'alwaysrender="{always}" is neither true nor false')
        return Action(
            motion,
            weight=Product((top, *chosen.curves)) if chosen.curves else top,
            mask=chosen.weights / top if top > 0.0 else chosen.weights,
            scales=None if (chosen.scales == 1.0).all() else chosen.scales,
            always=always == "true",
            name=self._name(element),
        )

    def _activate(self, element: XmlElement, pool: Mapping[str, Action]) -> Action:
        name, start = self._name(element), self._number(element, "offset", 0.0)
        if name not in pool:
            raise self._error(element, f"no action {name!r}; there are {name_list(pool) or 'none'}")
        action = pool[name]
        return replace(action, start=start)

    def _object(self, element: XmlElement) -> Motion:
        """Return the motion that an object describes."""
        kind = element.attributes.get("type", "")
        if kind == "keyframebodyanimation":
            self._check_tag(element, ())
            return self._open(self._open_motion, element)
        if kind in ("idlemotion", "idleemotion"):
            self._check_tag(element, ("balance",))
            return self._open(self._open_idle, self._one(element, "balance"))()
        if kind == "modifier":
            self._check_tag(element, ("modifier", "blendableobject"))
            inner = self._object(self._one(element, "blendableobject"))
            return self._modify(self._one(element, "modifier"), inner)
        kinds = "keyframebodyanimation, idlemotion, modifier"
        raise self._error(element, f'type="{kind}" is not known here; there are {kinds}')

    def _modify(self, element: XmlElement, motion: Motion) -> Motion:
        kind = element.attributes.get("type", "")
        self._check_tag(element, ("duration", "begin", "end"))
        try:
            if kind == "stretch":
                return Stretch(motion, self._number(element, "duration"))
            if kind == "window":
                return TimeWindow(
                    motion, self._number(element, "begin"), self._number(element, "end")
                )
            if kind in self._filters:
                return Filtered(motion, self._filters[kind]())
        except CharacterError as error:
            raise (
                error if self._origin in str(error) else self._error(element, str(error))
            ) from None
        known = ", ".join(("stretch", "window", *self._filters))
        raise self._error(element, f'type="{kind}" is not known here; there are {known}')

    def _parameters(self, element: XmlElement, duration: float) -> _Parameters:
        """Return the parameters of an action that lasts a duration [s]."""
        kind, ones = element.attributes.get("type", "none"), np.ones(len(self._skeleton))
        if kind == "none":
            self._check_tag(element, ())
            return _Parameters(ones, ones)
        if kind == "joints":
            return self._joints(element)
        if kind == "merge":
            self._check_tag(element, ("blendingparams",))
            merged = [self._parameters(each, duration) for each in element.children]
            return _Parameters(
                np.prod([ones, *(one.weights for one in merged)], axis=0),
                np.prod([ones, *(one.scales for one in merged)], axis=0),
                tuple(curve for one in merged for curve in one.curves),
            )
        if kind == "curve":
            self._check_tag(element, ("curveshape",))
            element = self._one(element, "curveshape")
            kind = element.attributes.get("type", "")
        return _Parameters(ones, ones, (self._curve(element, kind, duration),))

    def _curve(self, element: XmlElement, kind: str, duration: float) -> Weight:
        """Return a curve; its lengths are written in percent of the duration."""
        shapes: dict[str, Ease] = {"": "linear", "linear": "linear", "cubic": "cubic"}
        shapes["gonio"] = "gonio"
        for ending in ("fade", "adsr"):
            if kind.endswith(ending) and kind[: -len(ending)] in shapes:
                shape = shapes[kind[: -len(ending)]]
                break
        else:
            known = "none, joints, merge, curve, fade, cubicfade, goniofade, adsr, gonioadsr"
            raise self._error(element, f'type="{kind}" is not known here; there are {known}')
        if not np.isfinite(duration):
            raise self._error(element, "a fade in percent of a motion without an end")

        def part(name: str) -> float:
            return self._percent(element, name, 0.0) * duration

        if ending == "fade":
            self._check_tag(element, ("fadein", "fadeout"))
            return FadeCurve(part("fadein"), part("fadeout"), shape)
        self._check_tag(element, ("attack", "decay", "sustain", "release"))
        level = self._percent(element, "sustain", 100.0)
        return Adsr(part("attack"), part("decay"), level, part("release"), shape)

    def _joints(self, element: XmlElement) -> _Parameters:
        """Return weights and scales of joints; later elements override earlier ones."""
        self._check_tag(element, ("default", "scope", "rotation", "translation"))
        weights, scales = np.ones(len(self._skeleton)), np.ones(len(self._skeleton))
        order = ("default", "scope", "rotation", "translation")
        for each in sorted(element.children, key=lambda child: order.index(child.tag)):
            self._check_tag(each, ())
            joints = self._joints_of(each)
            for name, values in (("weight", weights), ("scaling", scales)):
                if name in each.attributes:
                    values[joints] = self._number(each, name)
        if weights.min() < 0.0:
            raise self._error(element, "a weight below 0")
        return _Parameters(weights, scales)

    def _joints_of(self, element: XmlElement) -> list[int]:
        """Return the joints that an element is about."""
        if element.tag == "default":
            return self._scope("all")
        name = self._name(element)
        if element.tag == "scope":
            if name not in SCOPES:
                raise self._error(element, f"no scope {name!r}; there are {', '.join(SCOPES)}")
            return self._scope(name)
        if name in self._skeleton.names:
            return [self._skeleton.index(name)]
        joint = self._anatomy.joint(_HANIM_PARTS.get(name, name))
        if joint is None:
            raise self._error(element, f"no joint {name!r}")
        return [joint]

    def _joints_in(self, scope: str) -> list[int]:
        """Return the joints that a scope covers."""
        if scope == "all":
            return list(range(len(self._skeleton)))
        tops = [self._anatomy.joint(part) for part in SCOPES[scope]]
        return sorted({j for top in tops if top is not None for j in subtree(self._skeleton, top)})

    def _open(self, opener: Callable[[str], _T], element: XmlElement) -> _T:
        name = element.text.strip()
        if not name:
            raise self._error(element, f"<{element.tag}> names no file")
        try:
            return opener(name)
        except CharacterError as error:
            raise self._error(element, str(error)) from None

    def _one(self, element: XmlElement, tag: str) -> XmlElement:
        found = [each for each in element.children if each.tag == tag]
        if len(found) != 1:
            raise self._error(element, f"<{element.tag}> needs one <{tag}>, not {len(found)}")
        return found[0]

    def _check_tag(self, element: XmlElement, tags: tuple[str, ...]) -> None:
        for child in element.children:
            if child.tag not in tags:
                there = ", ".join(f"<{tag}>" for tag in tags) or "none"
                message = f"<{child.tag}> is not known in <{element.tag}>; there are {there}"
                raise self._error(child, message)

    def _name(self, element: XmlElement) -> str:
        name = element.attributes.get("id", "")
        if not name:
            raise self._error(element, f"<{element.tag}> has no id")
        return name

    def _number(self, element: XmlElement, name: str, default: float | None = None) -> float:
        """Return a number, which is an attribute or the text of an element; "0.5f" is 0.5."""
        texts = [each.text for each in element.children if each.tag == name]
        text = element.attributes.get(name, texts[0] if texts else None)
        if text is None:
            if default is None:
                raise self._error(element, f"<{element.tag}> has no {name}")
            return default
        try:
            number = float(text.strip().removesuffix("f"))
        except ValueError:
            number = np.nan
        if not np.isfinite(number):
            raise self._error(element, f'{name}="{text.strip()[:40]}" is not a number')
        return number

    def _percent(self, element: XmlElement, name: str, default: float) -> float:
        """Return a share that is written in percent."""
        number = self._number(element, name, default)
        if not 0.0 <= number <= 100.0:
            raise self._error(element, f"{name} is {number:g} percent; give 0 to 100")
        return number / 100.0

    def _error(self, element: XmlElement, message: str) -> CharacterError:
        return CharacterError(f"{self._origin}:{element.line}: {message}")
