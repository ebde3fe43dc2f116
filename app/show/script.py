"""The file of a play: characters, and cues that are carried out in their order.

    <show summary="Two greet each other" language="en">
      <character name="creon" body="human"/>
      <character name="antigone" body="human"/>
      <say who="creon" id="first">Who is there?</say>
      <wait for="first" before="0.5"/>
      <do who="antigone" id="nods" for="2">nod</do>
      <sound id="rain" play="rain.ogg" volume="0.5"/>
      <bml who="antigone" file="bow.bml"/>
      <wait seconds="1"/>
      <stop what="nods" fade="0.5"/>
      <talk script="creon.xml"/>
    </show>

The calls of Egges' Python scripts (2006, section 6.2) are its cues: an action is activated or cut
off, a voice speaks, and a script waits until some time before something has finished.
"""

import math
from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from pathlib import Path

from cubeling.affect import OCC_FACES
from cubeling.app.errors import AppError
from cubeling.app.pipeline.choices import MAX_CAST
from cubeling.app.pipeline.registry import BLOCK_SUFFIXES
from cubeling.app.pipeline.table.stage_sounds import SoundSource
from cubeling.app.show.blocks import block_of, document_of, read_document
from cubeling.characters import CharacterError, colours_of
from cubeling.characters.behaviour import XmlElement, XmlLimits, read_xml
from cubeling.characters.speech import TaggedText
from cubeling.files import FileKind
from cubeling.toml_file import printable

OWN_SOUNDS = ("wind", "gong")
"""Sounds that need no file: `cubeling.app.sound.stage_sounds` synthesises them."""

LIMITS = XmlLimits(bytes=1 << 20, elements=20_000, depth=24)
"""How large a play may be."""

SHOW_FILE = FileKind(
    "show", (".show",), AppError, LIMITS.bytes, "cubeling.app.show.script:read_show"
)
"""The cues of several characters."""

MAX_SECONDS = 3600.0
"""Longest time that a cue may name [s]."""

USUAL_ACTING_S = 3.0
"""How long an action lasts unless its cue says so [s]."""


@dataclass(frozen=True)
class ShowCharacter:
    """One of the cast, as the file names it."""

    name: str
    """Its name in the file."""

    body: str
    """A bundled character, or a file."""

    colours: Mapping[str, str] = field(default_factory=dict)
    """Which of its colours another one takes the place of; see `with_colours`."""


@dataclass(frozen=True)
class ShowCue:
    """Something that is carried out when its turn comes."""

    kind: str
    """One of `CUES`."""

    line: int
    """Line of the file."""

    who: int = 0
    """The number of the character in the cast."""

    id: str = ""
    """By what name other cues call it; "" for none."""

    text: str = ""
    """What is said, the action, the emotion, what is waited for or stopped, the sound, the script,
    or the document of BML or FML."""

    seconds: float = 0.0
    """How long: of an action, a fade, a wait; or how long before the end a wait is over [s]."""

    value: float = 0.0
    """How strongly an emotion is felt, or how loud a sound is, 0…1."""


@dataclass(frozen=True)
class ShowScript:
    """The content of a file: characters, and cues in their order."""

    name: str
    """The file, for messages."""

    folder: Path
    """Where what it names is."""

    summary: str
    """What it is, in one line."""

    language: str
    """Code of the language that is spoken."""

    cast: tuple[ShowCharacter, ...]
    """Who plays: the first one is led by the cube where there is one."""

    cues: tuple[ShowCue, ...]
    """What happens, in this order."""

    @property
    def talk(self) -> str:
        """The script of the dialogue that takes over; "" for none."""
        return next((cue.text for cue in self.cues if cue.kind == "talk"), "")

    @property
    def sounds(self) -> dict[str, SoundSource]:
        """Where its sounds come from, by how it names them."""
        return {
            cue.text: SoundSource(
                self.folder / cue.text if Path(cue.text).suffix else None, self.place(cue.line)
            )
            for cue in self.cues
            if cue.kind == "sound"
        }

    def place(self, line: int) -> str:
        """Return how messages name a line of it."""
        return f"{self.name}:{line}"


def read_show(path: str | Path) -> ShowScript:
    """Read a play; a document of BML or FML is one with a single character and cue.

    Raises
    ------
    AppError
        It cannot be read, or in one line: what is wrong at which line of it.
    """
    if Path(path).suffix in BLOCK_SUFFIXES:
        return _show_of_blocks(Path(path))
    reader = _Reader(printable(str(path)), Path(path).parent)
    try:
        return reader.show(SHOW_FILE.read(path))
    except CharacterError as error:
        raise AppError(str(error)) from None


def _show_of_blocks(path: Path) -> ShowScript:
    try:
        document = read_document(path).decode()
    except (CharacterError, UnicodeDecodeError) as error:
        raise AppError(printable(str(error))) from None
    return ShowScript(
        printable(str(path)),
        path.parent,
        f"A character performs {printable(path.name)}",
        "en",
        (ShowCharacter("human", "human"),),
        (ShowCue("bml", 1, id=path.stem, text=document),),
    )


class _Reader:
    def __init__(self, name: str, folder: Path) -> None:
        self._name, self._folder = name, folder
        self._cast: dict[str, ShowCharacter] = {}
        self._ids: dict[str, str] = {}

    def show(self, text: bytes) -> ShowScript:
        root = read_xml(text, LIMITS, lambda line: f"{self._name}:{line}")
        self._expect(root, "show", ("summary", "language"))
        cues = []
        for each in root.children:
            if each.tag == "character":
                self._character(each)
            elif each.tag in CUES:
                cues.append(self._cue(each))
            else:
                raise self._error(each, f"<{each.tag}> is no cue; there are {', '.join(CUES)}")
            if len(cues) > 1 and cues[-2].kind == "talk":
                raise self._error(each, "nothing comes after <talk>")
        if not cues:
            raise self._error(root, "a show without a cue")
        return ShowScript(
            self._name,
            self._folder,
            " ".join(root.attributes.get("summary", "a show").split()).removesuffix("."),
            root.attributes.get("language", "en"),
            tuple(self._cast.values()),
            tuple(cues),
        )

    def _character(self, element: XmlElement) -> None:
        self._expect(element, "character", ("name", "body", "colours"))
        name, body = self._needs(element, "name"), element.attributes.get("body", "human")
        if name in self._cast or len(self._cast) == MAX_CAST:
            raise self._error(element, f"'{name}' is there, or there are {MAX_CAST} already")
        path = str(self._folder / body) if Path(body).suffix else body
        try:
            colours = colours_of(element.attributes.get("colours", ""))
        except CharacterError as error:
            raise self._error(element, str(error)) from None
        self._cast[name] = ShowCharacter(name, path, colours)

    def _cue(self, element: XmlElement) -> ShowCue:
        tag = element.tag
        if tag != "bml":  # its attributes are those of BML, too
            self._expect(element, tag, CUES[tag])
        if not self._cast:
            raise self._error(element, "a cue before the first <character>")
        text = self._text(element)
        who = self._number_of(element) if "who" in CUES[tag] else 0
        name = element.attributes.get("id", "")
        if name in self._ids:
            raise self._error(element, f"a second id '{name}'")
        if name:
            self._ids[name] = tag
        usual = USUAL_ACTING_S if tag == "do" else 0.0
        keys = {"do": "for", "stop": "fade", "wait": "seconds" if not text else "before"}
        seconds = self._seconds(element, keys.get(tag, ""), usual, MAX_SECONDS)
        values = {"feel": "value", "sound": "volume"}
        value = self._seconds(element, values.get(tag, ""), 1.0, 1.0)
        if tag == "wait" and not text and not seconds:
            raise self._error(element, 'a wait needs seconds="2", or for="ID" before="0.5"')
        return ShowCue(tag, element.line, who, name, text, seconds, value)

    def _text(self, element: XmlElement) -> str:
        """Return what a cue is about."""
        tag = element.tag
        if tag in ("say", "do"):
            parts = [each if isinstance(each, str) else _tag(each) for each in element.parts]
            text = " ".join("".join(parts).split())
            if not TaggedText.read(text).text.strip() or (tag == "do" and element.children):
                raise self._error(element, f"<{tag}> needs a text")
            return text
        if tag == "feel":
            emotion = self._needs(element, "emotion").casefold()
            if emotion not in OCC_FACES:
                known = ", ".join(OCC_FACES)
                raise self._error(element, f"'{emotion:.40}' is none of the emotions {known}")
            return emotion
        if tag == "sound":
            sound = self._needs(element, "play")
            if not Path(sound).suffix and sound not in OWN_SOUNDS:
                known = ", ".join(OWN_SOUNDS)
                raise self._error(element, f"'{sound:.40}' is no file, and none of {known}")
            return sound
        if tag == "bml":
            return self._block(element)
        if tag == "talk":
            return str(self._folder / self._needs(element, "script"))
        named = element.attributes.get("for" if tag == "wait" else "what", "")
        if named and named not in self._ids:
            raise self._error(element, f"no cue before it has the id '{named:.40}'")
        if tag == "stop" and self._ids.get(named) not in STOPPABLE_TAGS:
            known = ", ".join(f"<{each}>" for each in STOPPABLE_TAGS)
            raise self._error(element, f"what is stopped? name the id of one of {known}")
        return named

    def _block(self, element: XmlElement) -> str:
        try:
            if "file" in element.attributes:
                self._expect(element, "bml", CUES["bml"])
                return read_document(self._folder / element.attributes["file"]).decode()
            document = document_of(element)
            block_of(document)
        except (CharacterError, UnicodeDecodeError) as error:
            raise self._error(element, str(error)) from None
        return document

    def _number_of(self, element: XmlElement) -> int:
        name = self._needs(element, "who")
        if name not in self._cast:
            raise self._error(element, f"nobody is called '{name:.40}': {', '.join(self._cast)}")
        return list(self._cast).index(name)

    def _seconds(self, element: XmlElement, key: str, usual: float, most: float) -> float:
        text = element.attributes.get(key)
        if text is None:
            return usual
        try:
            number = float(text)
        except ValueError:
            number = math.nan
        if not 0.0 <= number <= most:
            raise self._error(element, f"{key}='{text:.20}' is no number from 0 to {most:g}")
        return number

    def _needs(self, element: XmlElement, name: str) -> str:
        text = element.attributes.get(name, "").strip()
        if not text:
            raise self._error(element, f"<{element.tag}> needs {name}=…")
        return text

    def _expect(self, element: XmlElement, tag: str, attributes: Collection[str]) -> None:
        if element.tag != tag:
            raise self._error(element, f"<{element.tag}> where <{tag}> is expected")
        for name in element.attributes:
            if name not in attributes:
                raise self._error(
                    element, f"<{tag}> has no '{name}'; it has {', '.join(attributes)}"
                )

    def _error(self, element: XmlElement, why: str) -> CharacterError:
        return CharacterError(printable(f"{self._name}:{element.line}: {why}"))


CUES: dict[str, tuple[str, ...]] = {
    "say": ("who", "id"),
    "do": ("who", "id", "for"),
    "stop": ("what", "fade"),
    "bml": ("who", "id", "file"),
    "sound": ("id", "play", "volume"),
    "feel": ("who", "emotion", "value"),
    "wait": ("for", "before", "seconds"),
    "talk": ("script",),
}
"""The cues by their element, with their attributes."""

STOPPABLE_TAGS = ("say", "do", "bml", "sound")
"""Cues that take their time, and may be cut off."""


def _tag(element: XmlElement) -> str:
    """Return a tag of a text as it was written."""
    values = "".join(f' {name}="{value}"' for name, value in element.attributes.items())
    return f"<{element.tag}{values}/>"
