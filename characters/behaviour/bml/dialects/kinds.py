"""What the behaviours of dialects are in BML 1.0: kinds, names, amounts, expressivity, texts."""

import math
import re
from collections.abc import Callable, Iterable, Iterator, Mapping

from cubeling.characters.behaviour.bml.document import CUBELING
from cubeling.characters.behaviour.gesticon import Gesticon, Meaning, words_of
from cubeling.characters.xml_elements import XmlElement

Notes = list[tuple[int, str]]
"""What was changed, by line."""

EXPRESSIVITY: Mapping[str, tuple[str, float, float]] = {
    "spc": ("spatial", 1.0, 0.0),
    "tmp": ("tempo", 1.0, 0.0),
    "fld": ("fluidity", 1.0, 0.0),
    "pwr": ("power", 1.0, 0.0),
    "opn": ("openness", 0.5, 0.5),
    "ten": ("tension", 1.0, 0.0),
}
"""Greta's parameters, −1…1: ours by name, with factor and offset (Hartmann et al. 2006)."""

LANGUAGES = {
    "english": "en",
    "french": "fr",
    "german": "de",
    "italian": "it",
    "spanish": "es",
    "catalan": "ca",
    "swedish": "sv",
    "polish": "pl",
    "dutch": "nl",
    "portuguese": "pt",
}
"""Codes of the languages that dialects write in words."""

INFLUENCES = {
    "EYES": "EYES",
    "HEAD": "HEAD",
    "NECK": "NECK",
    "CHEST": "SHOULDER",
    "BACK": "WAIST",
}
"""BML's influence by SmartBody's joint ranges, the widest last."""

LOOKS = {"left": "LEFT", "right": "RIGHT", "up": "UP", "down": "DOWN"}
"""Directions of a look by the words of its name."""

LOOK_ASIDE_DEG = "25"
"""How far a look goes aside that does not say it [degrees]."""

VIEWER_TARGETS = ("front", "forward", "center", "straight", "interlocutor", "addressee")
"""Targets of looks that are where the viewer is."""

ACCENTS = {"weak": 0.3, "reduced": 0.3, "none": 0.2, "medium": 0.5, "strong": 0.8}
"""How far brows are raised by the level of a pitch accent."""

NO_NAMES = frozenset(
    ("facs", "rotation", "orient", "orientation", "position", "lexicalized", "at")
    + ("eyebrows", "eyelids", "lids", "mouth")
)
"""Types of the draft of 2007 that say of what kind a behaviour is, and not which."""

XML_LANG = "{http://www.w3.org/XML/1998/namespace}lang"

MARK_TAGS = ("tm", "mark", "sync", "bookmark")
"""Elements that mark a moment of a text."""

_NUMBER = re.compile(r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?")
_HANDS = {"l": "LEFT", "lf": "LEFT", "left": "LEFT", "r": "RIGHT", "rt": "RIGHT", "right": "RIGHT"}


def convert(element: XmlElement, notes: Notes) -> list[XmlElement]:
    """Return the behaviours of the standard that an element of a dialect stands for."""
    given = _description_numbers(element)
    for name, (own, factor, offset) in EXPRESSIVITY.items():
        if name in given:
            low = 0.0 if own in ("power", "openness") else -1.0
            value = min(max(given[name] * factor + offset, low), 1.0)
            element.attributes.setdefault(f"{{{CUBELING}}}{own}", f"{value:g}")
    if "intensity" in given and 0.0 <= given["intensity"] <= 1.0:
        element.attributes.setdefault("amount", f"{given['intensity']:g}")
    change = CONVERSIONS.get(element.tag)
    return [element] if change is None else change(element, notes)


def _description_numbers(element: XmlElement) -> dict[str, float]:
    """Return the numbers of a description, by name in lower case."""
    found = dict[str, float]()
    for key, value in element.attributes.items():
        if key.lower().startswith("expressivity") and _NUMBER.fullmatch(value.strip()):
            found[key.lower().removeprefix("expressivity")] = float(value)
    for description in element.children:
        if description.tag == "description":
            for each in description.children:
                text = each.text.strip()
                if _NUMBER.fullmatch(text) and math.isfinite(float(text)):
                    found[each.tag.lower().removesuffix(".value")] = float(text)
    return found


def _names(element: XmlElement) -> Iterator[str]:
    """Yield what an element may be called: its lexeme, with its type, its reference, its name."""
    lexeme, kind = element.attributes.get("lexeme", ""), element.attributes.get("type", "")
    kind = "" if kind.strip().lower() in NO_NAMES else kind
    if lexeme and kind:
        yield f"{lexeme} {kind}"
    yield lexeme
    for child in element.children:
        if child.tag == "lexeme":
            yield child.attributes.get("lexeme", "")
        if child.tag == "description":
            yield from (each.text.strip() for each in child.children if each.tag == "reference")
    yield from (kind, *(element.attributes.get(key, "") for key in ("name", "posture", "shape")))


def _gesture(element: XmlElement, notes: Notes) -> list[XmlElement]:
    """Name a gesture as the gesticon does, and keep how it was called for a clip of that name."""
    gesticon, names = Gesticon.bundled(), [name for name in _names(element) if name]
    element.tag = "gesture"
    if not names:
        return [element]
    meaning = next(filter(None, map(gesticon.meaning, names)), None)
    near = meaning or _nearest(names, ("gesture",)) or _nearest(names, ("head", "face"))
    if meaning is None:
        element.attributes[f"{{{CUBELING}}}clip"] = names[0]
    element.attributes["lexeme"] = names[0] if near is None else near.name
    if near is not None and meaning is None:
        notes.append((element.line, f"gesture {names[0][:80]} is taken as {near.name}"))
    hands = {_HANDS[word] for word in words_of(names[0]) if word in _HANDS}
    if len(hands) == 1 and "mode" not in element.attributes:
        element.attributes["mode"] = f"{hands.pop()}_HAND"
    return [element]


def _nearest(names: Iterable[str], kinds: tuple[str, ...]) -> Meaning | None:
    """Return what the words of the first name that has any lead to, "neutral" if nothing else."""
    for name in names:
        found = list(Gesticon.bundled().within(name, kinds))
        if found:
            return next((each for each in found if each.name != "neutral"), found[0])
    return None


def _shoulders(element: XmlElement, notes: Notes) -> list[XmlElement]:
    element.tag, element.attributes["lexeme"] = "gesture", "SHRUG"
    return [element]


def _head(element: XmlElement, notes: Notes) -> list[XmlElement]:
    """Return a movement of the head for each that the name of one has: down, aside, left."""
    given = element.attributes
    if given.get("target") and not given.get("lexeme"):
        element.tag = "gaze"
        given.setdefault("influence", "HEAD")
        return [element]
    if "repeats" in given and _NUMBER.fullmatch(given["repeats"].strip()):
        given.setdefault("repetition", f"{max(math.ceil(float(given['repeats'])), 1)}")
    spatial = float(given.get(f"{{{CUBELING}}}spatial", "0"))
    amount = given.get("amount", "").strip()
    if spatial or not _NUMBER.fullmatch(amount):
        size = float(amount) if _NUMBER.fullmatch(amount) else 0.5
        given["amount"] = f"{min(size * (1.0 + 0.5 * spatial), 1.0):g}"
    names = [name for name in (*_names(element), given.get("direction", "")) if name]
    found = next(filter(None, (_movements(name) for name in names)), [])
    if not found:
        if any(word in ("look", "gaze") for name in names for word in words_of(name)):
            return _gaze(element, notes)
        given.setdefault("lexeme", names[0] if names else "")
        return [element]
    if names[0].strip().upper().replace("-", "_") != "_".join(found):
        notes.append((element.line, f"head {names[0][:80]} is taken as {' and '.join(found)}"))
    given["lexeme"] = found[0]
    rest = [dict(given, lexeme=name) for name in found[1:]]
    for number, each in enumerate(rest, 2):
        if each.pop("id", ""):
            each["id"] = f"{given['id']}-part{number}"
    return [element, *(XmlElement("head", "", each, element.line) for each in rest)]


def _movements(name: str) -> list[str]:
    return [each.name for each in Gesticon.bundled().within(name, ("head",))][:3]


def _face(element: XmlElement, notes: Notes) -> list[XmlElement]:
    """Name an expression as the gesticon does; action units stay what they are."""
    given = element.attributes
    units = re.findall(r"\d+", given.get("au", ""))
    if units or any(child.attributes.get("au") for child in element.children):
        given.pop("type", None)
        given.pop("au", None)
        amount = {key: value for key, value in given.items() if key in ("amount", "side")}
        element.parts += [
            XmlElement("faceFacs", "", {"au": unit, **amount}, element.line) for unit in units[:20]
        ]
        return [element]
    names = [name for name in _names(element) if name]
    names += [f"{part} {given[part]}" for part in ("eyebrows", "mouth", "eyelids") if part in given]
    near = _nearest(names, ("face",))
    element.parts = [each for each in element.children if each.tag != "description"]
    if given.get("type", "").strip().lower() in NO_NAMES or near is not None:
        given.pop("type", None)
    if near is not None and names[0].strip().lower() != near.name.lower():
        notes.append((element.line, f"face {names[0][:80]} is taken as {near.name}"))
        element.parts = [each for each in element.children if each.tag != "lexeme"]
        given["lexeme"] = near.name
        given.pop("name", None)
    elif names:
        given.setdefault("lexeme", names[0].rpartition("=")[2])
    return [element]


def _gaze(element: XmlElement, notes: Notes) -> list[XmlElement]:
    """Look at somebody, or aside, with what SmartBody calls a joint range."""
    given = element.attributes
    element.tag = "gaze" if element.tag in ("head", "eyes") else element.tag
    ranges = words_of(given.get("joint-range", "").lower())
    influence = [own for name, own in INFLUENCES.items() if name.lower() in ranges]
    if influence:
        given.setdefault("influence", influence[-1])
    aside = [given.get("direction", ""), *_names(element)]
    side = [LOOKS[word] for name in aside for word in words_of(name) if word in LOOKS]
    if side and "offsetAngle" not in given:
        angle = given.get("angle", "").strip()
        far = _NUMBER.fullmatch(angle) and float(angle) != 0.0
        given["offsetDirection"] = _both(side)
        given["offsetAngle"] = angle if far else LOOK_ASIDE_DEG
    for turned in element.children:  # SmartBody's bias of a joint, to the left and down
        left, down = (_number(turned.attributes.get(key, "")) for key in ("heading", "pitch"))
        if left or down:
            side = (["LEFT" if left > 0 else "RIGHT"] if left else []) + (
                ["DOWN" if down > 0 else "UP"] if down else []
            )
            given["offsetDirection"] = _both(side)
            given["offsetAngle"] = f"{max(abs(left), abs(down)):g}"
    target = given.get("target", "").strip()
    given["target"] = "viewer" if target.lower() in VIEWER_TARGETS else target
    if not target:
        given["target"] = "viewer"
        if not side:
            notes.append((element.line, "a look at nothing is one at the viewer"))
    return [element]


def _number(text: str) -> float:
    return float(text) if _NUMBER.fullmatch(text.strip()) else 0.0


def _both(sides: list[str]) -> str:
    """Return one of BML's directions: up and left are UPLEFT."""
    upright = next((side for side in sides if side in ("UP", "DOWN")), "")
    across = next((side for side in sides if side in ("LEFT", "RIGHT")), "")
    return upright + across


def _posture(element: XmlElement, notes: Notes) -> list[XmlElement]:
    names = [name for name in _names(element) if name]
    names += [f"lean {name}" for name in (element.attributes.get("direction", ""),) if name]
    near = _nearest(names, ("posture",))
    element.tag = element.tag if element.tag == "postureShift" else "posture"
    stances = [child for child in element.children if child.tag in ("stance", "pose")]
    if near is not None and not stances:
        if names[0].strip().upper() != near.name:
            notes.append((element.line, f"posture {names[0][:80]} is taken as {near.name}"))
        element.attributes["lexeme"] = near.name
    return [element]


def _point_elements(element: XmlElement, notes: Notes) -> list[XmlElement]:
    element.tag = "pointing"
    return [element]


def _locomotion(element: XmlElement, notes: Notes) -> list[XmlElement]:
    """Read a target of two numbers as one on the floor."""
    numbers = re.split(r"[\s,;]+", element.attributes.get("target", "").strip())
    if len(numbers) == 2 and all(map(_NUMBER.fullmatch, numbers)):
        element.attributes["target"] = f"{numbers[0]},0,{numbers[1]}"
    return [element]


def _speech(element: XmlElement, notes: Notes) -> list[XmlElement]:
    """Read the text of a speech, wherever it stands, with its marks; accents become brows."""
    given, text = element.attributes, XmlElement("text", "", {}, element.line)
    accents: list[XmlElement] = []
    _take_text(element.parts, text.parts, accents, {"start", "end"}, notes)
    said = "".join(part for part in text.parts if isinstance(part, str))
    if not said.strip() and given.get("text", "").strip():
        text.parts.append(given["text"])
    if not said.strip() and not given.get("text", "").strip():
        notes.append((element.line, "a speech without a text is silent"))
    if given.get("ref"):
        notes.append((element.line, "a voice speaks it; its recording is not read"))
    element.parts = [text]
    language = given.get("language", "").strip().lower()
    if language:
        given.setdefault(XML_LANG, LANGUAGES.get(language, language))
    return [element, *_brows(accents, given)]


def _brows(accents: Iterable[XmlElement], speech: Mapping[str, str]) -> Iterator[XmlElement]:
    """Yield what pitch accents do to the brows, if the speech has a name to refer to."""
    for accent in accents:
        start = accent.attributes.get("start", "").strip()
        if not start or not speech.get("id"):
            continue
        if ":" not in start and not _NUMBER.fullmatch(start):
            start = f"{speech['id']}:{start}"
        amount = ACCENTS.get(accent.attributes.get("level", "").strip().lower(), 0.5)
        shown = {"lexeme": "RAISE_BROWS", "amount": f"{amount:g}", "attackPeak": start}
        if accent.attributes.get("id"):
            shown["id"] = f"{speech['id']}-{accent.attributes['id']}"
        yield XmlElement("faceLexeme", "", shown, accent.line)


def _take_text(
    parts: Iterable[str | XmlElement],
    text: list[str | XmlElement],
    accents: list[XmlElement],
    taken: set[str],
    notes: Notes,
) -> None:
    """Add texts and marks to `text`, and pitch accents to `accents`."""
    for part in parts:
        if isinstance(part, str):
            text.append(part)
        elif part.tag in MARK_TAGS:
            given = part.attributes
            name = next((given[key] for key in ("id", "name", "mark") if given.get(key)), "")
            name = name.strip().rpartition(":")[2]
            if name in taken:
                notes.append((part.line, f'a second mark "{name[:80]}" in a text is left out'))
            elif name:
                taken.add(name)
                text.append(XmlElement("sync", "", {"id": name}, part.line))
            _take_text(part.parts, text, accents, taken, notes)
        elif part.tag == "pitchaccent":
            accents.append(part)
        elif part.tag not in ("boundary", "reference", "file", "audio"):
            _take_text(part.parts, text, accents, taken, notes)


CONVERSIONS: Mapping[str, Callable[[XmlElement, Notes], list[XmlElement]]] = {
    "speech": _speech,
    "gesture": _gesture,
    "animation": _gesture,
    "shoulder": _shoulders,
    "shoulders": _shoulders,
    "head": _head,
    "face": _face,
    "faceLexeme": _face,
    "gaze": _gaze,
    "gazeShift": _gaze,
    "eyes": _gaze,
    "torso": _posture,
    "spine": _posture,
    "body": _posture,
    "posture": _posture,
    "postureShift": _posture,
    "point": _point_elements,
    "reach": _point_elements,
    "locomotion": _locomotion,
}
"""What is done with the elements of dialects, by tag."""
