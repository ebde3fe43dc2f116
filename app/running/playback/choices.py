"""What the player can choose while a session runs: it is looked for and opened on threads."""

import threading
from dataclasses import replace
from typing import Any

from cubeling.app.errors import AppError
from cubeling.app.running.opened_session import OpenedSession
from cubeling.app.running.playback.background import BackgroundCall
from cubeling.app.running.playback.parts import PARTS, discard
from cubeling.app.running.playback.transport import Transport
from cubeling.app.ui.playback.requests import Choose
from cubeling.app.ui.playback.status import MenuChoice
from cubeling.bad_input import BadInputError


class Choices:
    """Looks for what can be chosen, and exchanges a part of the session for a choice.

    Neither waits for a device. A notice says what cannot be opened, and the present one stays.
    """

    def __init__(self, session: OpenedSession, transport: Transport) -> None:
        self._session, self._transport = session, transport
        self._lock = threading.Lock()
        self._found: tuple[MenuChoice, ...] = ()
        self._search: BackgroundCall[None] | None = None
        self._opening: tuple[Choose, BackgroundCall[Any]] | None = None

    @property
    def found(self) -> tuple[MenuChoice, ...]:
        """What is known so far."""
        with self._lock:
            return self._found

    @property
    def looking(self) -> bool:
        """Whether more may be found."""
        return self._search is not None and not self._search.over

    def look(self) -> None:
        """Look for choices again."""
        if not self.looking:
            with self._lock:
                self._found = ()
            self._search = BackgroundCall(self._collect)

    def choose(self, request: Choose) -> None:
        """Begin to open a choice, unless its part has to stay."""
        screen, part = self._session.screen, PARTS[request.part]
        refusal = part.refusal(self._session)
        if refusal:
            screen.notify(f"{refusal}: the {request.part} stays")
        elif self._opening is not None:
            screen.notify(f"{self._opening[0].value} is still being opened")
        elif not self._is_present(request):
            screen.notify(f"Opening {request.value} …")
            call = BackgroundCall(lambda: part.open(self._session, request.value), discard)
            self._opening = request, call

    def update(self) -> None:
        """Exchange the part for what was chosen, once it is open."""
        if self._opening is None or not self._opening[1].over:
            return
        (request, call), self._opening = self._opening, None
        part = PARTS[request.part]
        try:
            opened = call.result()
        except BadInputError as error:
            self._session.screen.notify(str(error))
            return
        try:
            refusal = part.refusal(self._session)  # a recording may have begun meanwhile
            if refusal:
                raise AppError(f"{refusal}: the {request.part} stays")
            part.exchange(self._session, self._transport, request.value, opened)
        except BadInputError as error:
            discard(opened)
            self._session.screen.notify(str(error))
            return
        self._transport.save_state(exchanged=True)
        self._session.screen.notify(f"The {request.part} is now {request.value}")
        with self._lock:
            self._found = tuple(
                replace(each, present=each.value == request.value)
                if each.part == request.part
                else each
                for each in self._found
            )

    def close(self) -> None:
        """Leave alone what is still being opened: it is closed as soon as it is open."""
        if self._opening is not None:
            self._opening[1].close()
            self._opening = None

    def _is_present(self, request: Choose) -> bool:
        return any(
            each.present
            for each in self.found
            if (each.part, each.value) == (request.part, request.value)
        )

    def _collect(self) -> None:
        for part in PARTS.values():
            for choice in part.choices(self._session):
                with self._lock:
                    self._found = (*self._found, choice)
