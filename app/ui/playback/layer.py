"""Keys and mouse of the player: what they ask for, and what lies over the picture for them."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from datetime import datetime
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import Rect
from cubeling.app.ui.canvas import PICTURE_HEIGHT, Card
from cubeling.app.ui.playback import timeline
from cubeling.app.ui.playback.announcements import Announcements
from cubeling.app.ui.playback.cards import draw_ending, draw_keys
from cubeling.app.ui.playback.corner_buttons import button_at, draw_buttons
from cubeling.app.ui.playback.keys import find_binding
from cubeling.app.ui.playback.mark_name import MarkName
from cubeling.app.ui.playback.menu import MENU_KEYS, Menu
from cubeling.app.ui.playback.requests import (
    Choose,
    ListChoices,
    MarkMoment,
    NameMark,
    OpenCube,
    Pause,
    PlayScenario,
    Request,
    SeekTo,
    SessionRequest,
    StartOver,
    WindowRequest,
)
from cubeling.app.ui.playback.scenario_card import ScenarioCard
from cubeling.app.ui.playback.snapshot import keep_snapshot
from cubeling.app.ui.playback.status import NO_STATUS, MenuChoice, SessionStatus
from cubeling.app.ui.playback.typing_field import TypingField

Picture = NDArray[np.uint8]

SCENARIO_PART = "scenario"
"""The column of the menu that the layer fills by itself."""

CLOSING_KEYS = ("Enter", "Space")
"""Keys that close the card of scenarios, besides Esc: the present one goes on."""

ENDING_KEYS = "Space plays it again  ·  1 to 9 another scenario  ·  Esc or Enter closes"


class PlaybackLayer:
    """What the player asks for, and what is shown because of it.

    The window passes on keys and mouse, and shows what `cards` returns.

    Parameters
    ----------
    scenarios
        The names of the scenarios, in the order of the keys 1 to 9.
    folder
        Where snapshots go.
    actions
        What carries out requests that need a window.
    picture
        Returns the picture with its cards, (H, W, 3), to keep it; None before the first.
    clock, now
        Return the time [s], for notices, and the local time, for the names of files.
    """

    def __init__(
        self,
        scenarios: Sequence[str],
        folder: Path,
        actions: Mapping[WindowRequest, Callable[[], None]],
        picture: Callable[[], Picture | None],
        clock: Callable[[], float] = time.monotonic,
        now: Callable[[], datetime] = datetime.now,
    ) -> None:
        self.mirrored = False
        """Whether the picture is to be shown as in a mirror."""
        self._picture_shown = picture
        self._scenarios, self._folder = tuple(scenarios), folder
        self._announcements, self._now = Announcements(clock), now
        self._actions: dict[WindowRequest, Callable[[], None]] = {
            WindowRequest.MIRROR: self._mirror,
            WindowRequest.SNAPSHOT: self._snapshot,
            WindowRequest.KEYS: self._toggle_keys,
            WindowRequest.MENU: self._toggle_menu,
            WindowRequest.SCENARIOS: self._toggle_scenarios,
            WindowRequest.BACK: self._back,
            **actions,
        }
        self._handlers: dict[type, Callable[[Any], None]] = {
            WindowRequest: lambda request: self._actions[request](),
            StartOver: self._start_over,
            PlayScenario: self._play_scenario,
            OpenCube: self._open_cube,
        }
        self._status = NO_STATUS
        self._inputs = Inputs()
        self._requests: list[SessionRequest] = []
        self._keys = False
        self._menu: Menu | None = None
        self._card = ScenarioCard(scenarios)
        self.shows_scenarios = False
        """Whether the card with all scenarios lies over the picture."""
        self._naming: MarkName | None = None
        self._clock = clock
        self._field = TypingField()
        self._pointer: float | None = None
        self._dragging = False
        self._changed = True
        self._width = 0.0

    @property
    def changed(self) -> bool:
        """Whether the picture is to be drawn again although no new one has come."""
        return self._changed or self._announcements.changed

    @property
    def strip_height(self) -> float:
        """Height of what lies under the picture, in units of the canvas."""
        return timeline.STRIP_HEIGHT if self._status.position is not None else 0.0

    def report(self, status: SessionStatus) -> None:
        """Show another state of the session."""
        if status == self._status:
            return
        if status.listens and not self._status.listens:
            self.shows_scenarios = False  # who has come to talk can type at once
        self._status, self._changed = status, True
        if self._menu is not None:
            self._menu.update(self._choices, status.looking)

    def notify(self, words: str) -> None:
        """Show a notice for some seconds."""
        self._announcements.notify(words)
        self._changed = True

    def take_inputs(self) -> Inputs:
        """Return what the player asked of the scenario since the last call."""
        inputs, self._inputs = self._inputs, Inputs()
        return inputs

    def take_requests(self) -> tuple[SessionRequest, ...]:
        """Return what the player asked of the session since the last call."""
        requests, self._requests = self._requests, []
        return tuple(requests)

    def type(self, character: str) -> bool:
        """Take a character that is typed; return whether it went into the field for text."""
        if not (self._listens and self._field.open):
            return False
        self._changed = True
        if self._field.type(character):
            self._inputs = replace(self._inputs, hush=True)  # who begins to speak is listened to
        return True

    @property
    def _listens(self) -> bool:
        """Whether what is typed is text: nothing else over the picture waits for keys."""
        free = self._status.ending is None and self._naming is None and not self._is_covered
        return self._status.listens and free

    @property
    def _is_covered(self) -> bool:
        """Whether a card for keys lies over the picture."""
        return self._keys or self._menu is not None or self.shows_scenarios

    def press(self, key: str, *, shift: bool = False, repeated: bool = False) -> None:
        """Handle a key by its name in the table of keys; `repeated` while it is held."""
        self._changed = True
        if self._naming is not None and self._type(key):
            return
        if self._listens:
            handled, said = self._field.press(key)
            if said:
                self._inputs = replace(self._inputs, typed=said)
            if handled:
                return
        if self._menu is not None and key in MENU_KEYS:
            self._request(self._menu.press(key))
            return
        if self.shows_scenarios and key in CLOSING_KEYS:
            self.shows_scenarios = False
            return
        if key == "Enter" and self._status.ending is not None:
            self._request(WindowRequest.QUIT)
            return
        binding = find_binding(key, shift)
        if binding is not None and (binding.repeats or not repeated):
            self._request(binding.request)

    def point(self, x: float, y: float) -> None:
        """Move the mouse to a place of the picture, in units of the canvas."""
        on_strip = PICTURE_HEIGHT <= y <= PICTURE_HEIGHT + self.strip_height
        pointer = x if on_strip or self._dragging else None
        if pointer == self._pointer:
            return
        self._pointer, self._changed = pointer, True
        if self._dragging:
            self._seek(x)

    def click(self, x: float, y: float) -> None:
        """Press the mouse's button at a place of the picture, in units of the canvas."""
        self._changed = True
        button = button_at(x, y, self._width)
        if button is not None:
            self._request(button)
        elif self.shows_scenarios:
            number = self._card.click(x, y, self._width)
            self.shows_scenarios = False
            if number is not None:
                self._request(PlayScenario(number))
        elif self._menu is not None:
            self._request(self._menu.click(x, y, self._width))
        elif PICTURE_HEIGHT <= y <= PICTURE_HEIGHT + self.strip_height:
            if timeline.is_on_button(x):
                self._request(Pause())
            else:
                self._dragging = True
                self._seek(x)

    def release(self) -> None:
        """Release the mouse's button."""
        self._dragging = False

    def cards(self, size: tuple[int, int], taken: Sequence[Rect] = ()) -> list[Card]:
        """Return what lies over a picture of a size [px], and the strip under it.

        Notices lie over none of the places that are `taken`, in units of the canvas.
        """
        self._changed = False
        scale = size[1] / PICTURE_HEIGHT
        self._width = width = size[0] / scale
        cards = [draw_buttons(width, scale)]
        if self._status.ending is not None and not self._is_covered:
            cards.append(draw_ending(self._status.ending, ENDING_KEYS, width, scale))
        if self._listens:
            field = self._field.draw(width, scale)
            cards.append(field)
            taken = (*taken, field.box(scale))
        cards += self._announcements.draw(self._status, width, scale, taken)
        if self._keys:
            cards.append(draw_keys(width, scale))
        if self._menu is not None:
            cards.append(self._menu.draw(width, scale))
        if self.shows_scenarios:
            cards.append(self._card.draw(self._status.scenario, width, scale))
        position = self._status.position
        if position is None:
            return cards
        if self._pointer is not None and not timeline.is_on_button(self._pointer):
            cards.append(timeline.draw_pointer(self._pointer, position, width, scale))
        return [*cards, timeline.strip_of(position, self._status.paused, width, scale)]

    @property
    def _choices(self) -> tuple[MenuChoice, ...]:
        """What the menu lists: the scenarios, and what the session has found."""
        present = self._status.scenario
        scenarios = (
            MenuChoice(SCENARIO_PART, name, f"{number}  {name}", present=name == present)
            for number, name in enumerate(self._scenarios, 1)
        )
        return (*scenarios, *self._status.choices)

    def _request(self, request: Request | None) -> None:
        """Carry out a request, or keep it for the session."""
        if request is None:
            return
        if isinstance(request, Choose) and request.part == SCENARIO_PART:
            request = PlayScenario(self._scenarios.index(request.value) + 1)
            self._menu = None
        handler = self._handlers.get(type(request))
        if handler is not None:
            handler(request)
        else:
            self._ask_session(request)

    def _ask_session(self, request: Any) -> None:
        if isinstance(request, SeekTo) and self._requests:
            # While the mouse is dragged, only the last place counts.
            self._requests = [each for each in self._requests if not isinstance(each, SeekTo)]
        self._requests.append(request)
        self._menu = None
        if isinstance(request, MarkMoment) and self._status.recorded:
            self._naming = MarkName(self._clock())

    def _type(self, key: str) -> bool:
        """Let a key say what the last mark is; return whether it did."""
        naming = self._naming
        used = naming is not None and naming.press(key, self._clock())
        if naming is None or not used:
            self._naming = None  # the key means what it always does
            return False
        if naming.done:
            self._naming = None
            if naming.text:
                self._requests.append(NameMark(naming.text))
        else:
            self.notify(f"Mark: {naming.text}…")
        return True

    def _seek(self, x: float) -> None:
        position = self._status.position
        if position is not None:
            self._ask_session(SeekTo(timeline.position_at(x, position, self._width)))

    def _start_over(self, _: StartOver) -> None:
        self._inputs = replace(self._inputs, clear=True)
        self._play_again()
        self.notify("Starting over")

    def _play_again(self) -> None:
        """Begin again if the recording is over: what was asked for happens then."""
        if self._status.ending is not None:
            self._ask_session(Pause())

    def _open_cube(self, _: OpenCube) -> None:
        if self._status.ending is not None:
            self.notify("The recording is over: Space plays it again")
            return
        self._inputs = replace(self._inputs, inside=not self._inputs.inside)

    def _play_scenario(self, request: PlayScenario) -> None:
        if request.number > len(self._scenarios):
            self.notify(f"There is no scenario {request.number}")
            return
        self.shows_scenarios = False
        self._inputs = replace(self._inputs, scenario=self._scenarios[request.number - 1])
        self._play_again()

    def _mirror(self) -> None:
        self.mirrored = not self.mirrored
        self.notify("Mirrored" if self.mirrored else "Not mirrored")

    def _toggle_keys(self) -> None:
        self._keys, self._menu, self.shows_scenarios = not self._keys, None, False

    def _toggle_scenarios(self) -> None:
        self._keys, self._menu, self.shows_scenarios = False, None, not self.shows_scenarios

    def _toggle_menu(self) -> None:
        self._keys = self.shows_scenarios = False
        if self._menu is not None:
            self._menu = None
            return
        self._menu = Menu()
        self._menu.update(self._choices, True)
        self._requests.append(ListChoices())

    def _back(self) -> None:
        if self._is_covered:
            self._keys, self._menu, self.shows_scenarios = False, None, False
        else:
            self._actions[WindowRequest.QUIT]()

    def _snapshot(self) -> None:
        picture = self._picture_shown()
        if picture is None:
            return
        self.notify(keep_snapshot(self._folder, self._status.scenario, picture, self._now()))
