"""One run of the editor, whatever shows it: its state, its preview and its files."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path

import moderngl

from cubeling.app.errors import AppError
from cubeling.app.workshop.gesture_editor.editing.document import (
    EMPTY,
    ROWS,
    GestureDocument,
    Row,
    keys_of,
    moves,
)
from cubeling.app.workshop.gesture_editor.editing.edits import gesture_name
from cubeling.app.workshop.gesture_editor.editing.importing import import_gesture
from cubeling.app.workshop.gesture_editor.editing.state import (
    Action,
    EditorState,
    Import,
    New,
    Open,
    Quit,
    Request,
    Save,
    end_frame,
    fresh,
    unless_unsaved,
    with_message,
)
from cubeling.app.workshop.gesture_editor.editing.store import GestureStore
from cubeling.app.workshop.gesture_editor.preview import Picture, Preview, PreviewedGesture
from cubeling.app.workshop.gesture_editor.shown_space import ShownSpace
from cubeling.characters import Character, CharacterError
from cubeling.characters.behaviour import SymbolicGesture

KEEP_INTERVAL_S = 2.0
"""Time between two copies of changes that are not saved [s]."""


class EditorSession:
    """Takes actions and time, and shows the character; it knows no window and no clock.

    Who opens it closes it; a second `close` does nothing.

    Parameters
    ----------
    context
        Where the preview draws; it is not released.
    folder
        The user's gestures.
    character
        Who performs: a bundled name, or a file.
    name
        The gesture to open; "" for a new one.

    Raises
    ------
    CharacterError
        There is no such gesture or character, or a file in the folder is no gesture.
    """

    def __init__(
        self, context: moderngl.Context, folder: Path, character: str = "human", name: str = ""
    ) -> None:
        self._store = GestureStore(folder)
        self._preview = Preview(context)
        self._preview.character(character)
        known = Character.bundled_names()
        characters = known if character in known else (*known, character)
        self.state = EditorState(
            character=character, characters=tuple(characters), names=self._store.names
        )
        """What it shows."""
        self.closed = False
        """Whether the user has ended it."""
        self._played = 0.0
        self._previewed: PreviewedGesture | None = None
        self._still: tuple[object, Picture] | None = None
        self._kept: SymbolicGesture | None = None
        self._since_kept = 0.0
        self._begin(name)

    def do(self, action: Action) -> None:
        """Do something, and what it asks for."""
        self.settle(action(self.state))

    def settle(self, state: EditorState, held: int = 0) -> None:
        """Take the state after a frame, and do what it asks for; `held` is that of `end_frame`."""
        self.state = end_frame(self.state, state, held)
        self._perform(self.state.requests)

    def ask_to_quit(self) -> None:
        """Close, or ask what is to become of changes that are not saved."""
        self.do(lambda state: unless_unsaved(state, Quit()))

    def advance(self, elapsed: float) -> None:
        """Let time pass [s]: the preview plays, and changes are kept."""
        state = self.state
        previewed = PreviewedGesture.of(state.document, state.character)
        if previewed != self._previewed or not state.playing:
            self._previewed, self._played = previewed, state.time
        if state.playing and not state.card:
            self._played += elapsed
            time = self._played % previewed.cycle if moves(previewed.gesture) else 0.0
            self.state = replace(state, time=time)
        self._since_kept += elapsed
        if self._since_kept >= KEEP_INTERVAL_S:
            self._since_kept = 0.0
            self.keep()

    def keep(self) -> None:
        """Keep changes that are not saved, so that nothing that happens can lose them."""
        gesture = self.state.document.gesture
        if gesture == self._kept or gesture == self.state.saved.gesture:
            return
        self._kept = gesture
        try:
            self._store.keep(gesture)
        except CharacterError as error:
            self.state = with_message(self.state, f"not safe yet: {error}", alarming=True)

    def picture(self, size: tuple[int, int]) -> Picture:
        """Return the character, (height, width, 3) BGR; the same array while nothing changes."""
        shown = self._shown_gesture, self._played, size
        if self._still is None or self._still[0] != shown:
            self._still = shown, self._preview.draw(self._shown_gesture, self._played, size)
        return self._still[1]

    @property
    def space(self) -> ShownSpace | None:
        """The gesture space of the selected hand in the last picture; None for trunk and head."""
        document = self.state.document
        if self._still is None or document.hand_row is None:
            return None
        left = document.row == "left" or (document.gesture.one_handed and document.hand == "left")
        size = self._still[1].shape[1], self._still[1].shape[0]
        return self._preview.shown_space(self._shown_gesture, size, left)

    @property
    def _shown_gesture(self) -> PreviewedGesture:
        return self._previewed or PreviewedGesture.of(self.state.document, self.state.character)

    def close(self) -> None:
        """Release what draws; changes that are not saved and not discarded are kept."""
        if not self.closed:
            self.keep()
            self.closed = True
        self._preview.release()

    def _begin(self, name: str) -> None:
        kept = self._store.recover()
        if kept is not None:
            self.state = replace(
                fresh(self.state, document_of(kept), "unsaved changes of last time are back"),
                saved=EMPTY,
            )
            if name and gesture_name(name) != kept.name:
                self.state = unless_unsaved(self.state, Open(name))
        elif name and self._store.has(name):
            self._perform([Open(name)])
        elif name:
            gesture = replace(EMPTY.gesture, name=gesture_name(name))
            message = f"{gesture.name} is new: click a sector of the map"
            self.state = fresh(self.state, GestureDocument(gesture), message)

    def _perform(self, requests: Sequence[Request]) -> None:
        """Do what was asked for, up to the first thing that fails."""
        self.state = replace(self.state, requests=())
        effects: dict[type, Callable[..., None]] = {
            Save: self._save,
            Open: self._open,
            Import: self._import,
            New: self._new,
            Quit: self._quit,
        }
        for request in requests:
            try:
                effects[type(request)](request)
            except (AppError, CharacterError, OSError) as error:
                message = " ".join(str(error).split())
                self.state = with_message(self.state, message, alarming=True)
                return

    def _save(self, request: Save) -> None:
        state, gesture = self.state, self.state.document.gesture
        renamed = gesture.name != state.saved.gesture.name
        if renamed and not request.overwrite and self._store.has(gesture.name):
            self.state = replace(state, card="replace")
            return
        place = self._store.save(gesture)
        self._kept = None
        self.state = replace(
            with_message(state, f"{gesture.name} is saved: {place}"),
            saved=state.document,
            names=self._store.names,
        )

    def _open(self, request: Open) -> None:
        gesture = self._store.load(request.name)
        self._forget()
        self.state = fresh(self.state, document_of(gesture), f"{gesture.name}: {gesture.summary}")

    def _import(self, request: Import) -> None:
        gesture = import_gesture(request.recording, request.start, request.end)
        self._forget()
        message = "imported: save it under a name of your own"
        self.state = replace(fresh(self.state, document_of(gesture), message), saved=EMPTY)

    def _new(self, request: New) -> None:
        self._forget()
        self.state = fresh(self.state, EMPTY, "click a sector of the map: the hand goes there")

    def _quit(self, request: Quit) -> None:
        self._forget()
        self.closed = True

    def _forget(self) -> None:
        self._kept = None
        self._store.forget()


def document_of(gesture: SymbolicGesture) -> GestureDocument:
    """Return the document of a gesture with its last key selected: that of the first row."""
    row: Row = next((each for each in ROWS if keys_of(gesture, each)), "right")
    return GestureDocument(gesture).select(row, len(keys_of(gesture, row)) - 1)
