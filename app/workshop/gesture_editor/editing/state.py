"""The state of the editor: the document, its history, and what the user is at."""

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Literal

from cubeling.app.workshop.gesture_editor.editing.document import EMPTY, GestureDocument

MAX_UNDO = 200
"""Steps that are kept."""

CardName = Literal["", "open", "import", "save as", "replace", "unsaved", "keys"]
"""What may lie over the window."""


@dataclass(frozen=True)
class Save:
    """Save the document under its name."""

    overwrite: bool = False
    """Whether a gesture of that name, other than the one that was opened, is replaced."""


@dataclass(frozen=True)
class Open:
    """Open a gesture of the library."""

    name: str


@dataclass(frozen=True)
class Import:
    """Read a gesture from a recording."""

    recording: str
    """A .bvh, .amc or .glb#CLIP."""

    start: float
    """Where it starts [s]."""

    end: float
    """Where it ends [s]."""


@dataclass(frozen=True)
class New:
    """Begin an empty gesture."""


@dataclass(frozen=True)
class Quit:
    """Close the editor, once nothing would be lost."""


Request = Save | Open | Import | New | Quit
"""What only the outside can do."""


@dataclass(frozen=True)
class EditorState:
    """The editor at one moment."""

    document: GestureDocument = EMPTY
    """The edited gesture with its name and file."""

    saved: GestureDocument = EMPTY
    """What was opened or saved last."""

    past: tuple[GestureDocument, ...] = ()
    """Documents that undo goes back to, the last one first."""

    future: tuple[GestureDocument, ...] = ()
    """Documents that redo goes on to, the next one last."""

    character: str = "human"
    """Who performs the preview."""

    characters: tuple[str, ...] = ("human",)
    """Who can be chosen."""

    playing: bool = True
    """Whether the preview moves."""

    time: float = 0.0
    """Where the preview is, from the start of the gesture [s]."""

    sectors_shown: bool = False
    """Whether the gesture space is drawn over the character."""

    held: int = 0
    """Which widget is dragged or typed into, by Dear ImGui's number; 0 for none."""

    grip: GestureDocument | None = None
    """The document when that began: all that is done meanwhile is one step of undo."""

    texts: tuple[tuple[str, str], ...] = ()
    """What stands in the text fields of cards, by their names."""

    card: CardName = ""
    """What lies over the window."""

    wanted: Request | None = None
    """What goes on once the question about unsaved changes is answered."""

    message: str = ""
    """What has just happened, in one line."""

    alarming: bool = False
    """Whether the message tells of something that went wrong."""

    names: tuple[str, ...] = ()
    """The gestures of the library."""

    requests: tuple[Request, ...] = ()
    """What the outside has yet to do."""

    @property
    def changed(self) -> bool:
        """Whether there is something that was not saved."""
        return self.document.gesture != self.saved.gesture

    def text(self, name: str) -> str:
        """Return what stands in a text field."""
        return dict(self.texts).get(name, "")


Action = Callable[[EditorState], EditorState]
"""What a button or a key does."""


def with_text(state: EditorState, name: str, text: str) -> EditorState:
    """Return the state with other words in a text field."""
    return replace(state, texts=tuple({**dict(state.texts), name: text}.items()))


def with_document(state: EditorState, document: GestureDocument) -> EditorState:
    """Return the state with another document."""
    return replace(state, document=document)


def commit(before: EditorState, after: EditorState) -> EditorState:
    """Note a step of undo if the gesture changed other than by undo and redo."""
    same_history = after.past is before.past and after.future is before.future
    if not same_history or after.document.gesture == before.document.gesture:
        return after
    return replace(after, past=(before.document, *before.past)[:MAX_UNDO], future=())


def end_frame(before: EditorState, after: EditorState, held: int) -> EditorState:
    """Return the state after a frame, with its steps of undo.

    Parameters
    ----------
    before, after
        The editor before and after what was done in the frame.
    held
        Which widget is dragged or typed into now; 0 for none.
    """
    if held and held == before.held:
        return after
    began = before if before.grip is None else replace(before, document=before.grip)
    if not held:
        return replace(commit(began, after), held=0, grip=None)
    # What was typed ends as a step of its own when the mouse takes something else.
    ended = commit(began, before)
    if after.past is before.past:
        after = replace(after, past=ended.past, future=ended.future)
    return replace(after, held=held, grip=before.document)


def undo(state: EditorState) -> EditorState:
    """Go back one step."""
    if not state.past:
        return state
    last, *older = state.past
    future = (*state.future, state.document)
    return replace(state, document=last, past=tuple(older), future=future)


def redo(state: EditorState) -> EditorState:
    """Take back the last undo."""
    if not state.future:
        return state
    *later, following = state.future
    past = (state.document, *state.past)
    return replace(state, document=following, past=past, future=tuple(later))


def with_request(state: EditorState, request: Request) -> EditorState:
    """Ask the outside for something."""
    return replace(state, requests=(*state.requests, request), card="")


def unless_unsaved(state: EditorState, request: Request) -> EditorState:
    """Ask the outside for something, or the user first if changes would be lost."""
    if state.changed:
        return replace(state, card="unsaved", wanted=request)
    return with_request(state, request)


def fresh(state: EditorState, document: GestureDocument, message: str) -> EditorState:
    """Return the state with a document that was just opened: it is saved, and has no history."""
    return replace(
        state, document=document, saved=document, past=(), future=(), time=0.0, playing=True,
        message=message, alarming=False, card="", texts=(),
    )  # fmt: skip


def with_message(state: EditorState, message: str, *, alarming: bool = False) -> EditorState:
    """Return the state with a line that says what happened."""
    return replace(state, message=message, alarming=alarming)
