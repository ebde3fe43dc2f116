"""The calls of the Python scripts of Egges' thesis (2006, section 6.2), which write a play.

    from cubeling.app.show.services import PlayServices

    play = PlayServices({"creon": "human", "antigone": "human"}, "Antigone and Creon")
    play.voiceService.activateAction("creon", "You knew what I had forbidden.")
    play.animationService.waitUntilActionHasFinished_body("creon", "voice", -0.5)
    play.save("my.show")

Each call writes the cue that means the same, so such a play is shown, recorded, interrupted and
replayed as every other. The names are those of the thesis.
"""

from collections.abc import Mapping
from pathlib import Path
from xml.etree import ElementTree

from cubeling.app.errors import AppError
from cubeling.app.pipeline.registry import BLOCK_SUFFIXES
from cubeling.app.show.script import MAX_SECONDS, USUAL_ACTING_S, read_show
from cubeling.files import whole_file

VOICE = "voice"
"""What a character says, as an action that can be awaited or cut off."""

IDLE = "idle"
"""The action that needs no cue: who does nothing else moves as who stands."""


class PlayServices:
    """Writes the cues of a play.

    Parameters
    ----------
    cast
        The bodies, bundled characters or files, by the names of the characters.
    summary
        What it is, in one line.
    language
        Code of the language that is spoken.
    """

    def __init__(
        self, cast: Mapping[str, str], summary: str = "a show", language: str = "en"
    ) -> None:
        self._root = ElementTree.Element("show", summary=summary, language=language)
        for name, body in cast.items():
            self._add("character", name=name, body=body)
        self._ids: dict[tuple[str, str], str] = {}
        self.animationService = AnimationService(self)  # as in the thesis
        """What bodies do."""
        self.voiceService = VoiceService(self)  # as in the thesis
        """What is said."""
        self.soundService = SoundService(self)  # as in the thesis
        """What is heard besides."""

    def save(self, path: str | Path) -> None:
        """Write the play to a .show file, for `cubeling show`.

        Raises
        ------
        AppError
            It cannot be written, or not be shown: the message names the line.
        """
        ElementTree.indent(self._root)
        with whole_file(Path(path), AppError) as partial:
            ElementTree.ElementTree(self._root).write(partial, "utf-8")
        read_show(path)

    def begin(self, who: str, what: str, tag: str, text: str = "", /, **attributes: str) -> None:
        """Write a cue that takes its time; `who` and `what` name it afterwards."""
        name = f"{len(self._root)}"
        self._ids[who, what] = name
        self._add(tag, text, id=name, **attributes)

    def end(self, who: str, what: str, tag: str, /, **attributes: str) -> None:
        """Write a cue about the one that began last by these names; AppError if none did."""
        if (who, what) not in self._ids:
            raise AppError(f"'{what}' of '{who}' has not begun: it can be neither awaited nor cut")
        of = "for" if tag == "wait" else "what"
        self._add(tag, "", **{of: self._ids[who, what]}, **attributes)

    def wait(self, seconds: float) -> None:
        """Write a wait [s]."""
        self._add("wait", seconds=f"{seconds:g}")

    def _add(self, tag: str, text: str = "", /, **attributes: str) -> None:
        try:  # a text may have tags
            element = ElementTree.fromstring(f"<{tag}>{text}</{tag}>")
        except ElementTree.ParseError as error:
            raise AppError(f"'{text:.40}' cannot be read: {error}") from None
        element.attrib.update(attributes)
        self._root.append(element)


class AnimationService:
    """What bodies do; the player of body and face runs from the start."""

    def __init__(self, play: PlayServices) -> None:
        self._play = play

    def activateAction_body(  # noqa: N802  # as in the thesis
        self, character: str, action: str, seconds: float = USUAL_ACTING_S
    ) -> None:
        """Begin an action of a character for some seconds, or the file of a block of BML."""
        if action == IDLE:
            return
        if action.endswith(BLOCK_SUFFIXES):
            self._play.begin(character, action, "bml", who=character, file=action)
            return
        duration = {"for": f"{seconds:g}"}
        self._play.begin(character, action, "do", action, who=character, **duration)

    def cutOffAction_body(  # noqa: N802  # as in the thesis
        self, character: str, action: str, seconds: float = 0.0
    ) -> None:
        """Let an action of a character fade out in some seconds; `VOICE` is what it says."""
        if action != IDLE:
            self._play.end(character, action, "stop", fade=f"{seconds:g}")

    def waitUntilActionHasFinished_body(  # noqa: N802  # as in the thesis
        self, character: str, action: str, offset: float = 0.0
    ) -> None:
        """Wait until an action has ended; with a negative offset, so many seconds before."""
        self._play.end(character, action, "wait", before=f"{min(max(-offset, 0.0), MAX_SECONDS):g}")
        if offset > 0.0:
            self._play.wait(offset)


class VoiceService:
    """What characters say, each with a voice of its own."""

    def __init__(self, play: PlayServices) -> None:
        self._play = play

    def activateAction(self, character: str, text: str) -> None:  # noqa: N802  # as in the thesis
        """Let a character say a text with tags."""
        self._play.begin(character, VOICE, "say", text, who=character)


class SoundService:
    """What is heard besides."""

    def __init__(self, play: PlayServices) -> None:
        self._play = play

    def sndmpPlayMedia(self, sound: str, volume: float = 1.0) -> None:  # noqa: N802  # as there
        """Begin a sound: a file beside the play, or one of ours."""
        self._play.begin("", sound, "sound", play=sound, volume=f"{volume:g}")

    def sndmpStopMedia(self, sound: str, seconds: float = 0.0) -> None:  # noqa: N802  # as there
        """Let a sound fade out in some seconds."""
        self._play.end("", sound, "stop", fade=f"{seconds:g}")
