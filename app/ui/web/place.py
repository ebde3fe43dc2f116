"""Which page's camera is that of the session: one is at a time, and others may take its place."""

from collections.abc import Callable

from cubeling.app.ui.web.client import PageClient
from cubeling.app.ui.web.messages import CAMERA_ROLES

CAMERA_QUIET_S = 2.0
"""A page whose camera sends nothing for so long gives its place up to another one [s]: one that is
loaded again, or connected again, keeps it."""


class CameraPlace:
    """The place of the camera. Pages are told whenever it changes hands.

    Parameters
    ----------
    clock
        The time [s].
    """

    def __init__(self, clock: Callable[[], float]) -> None:
        self._clock = clock
        self._owner = ""  # the name of its page
        self._seen = 0.0
        self._pages: list[PageClient] = []

    def join(self, client: PageClient) -> None:
        """Let a page know of the place, which it keeps if it was connected before."""
        self._pages.append(client)
        if client.page == self._owner:
            self._seen = self._clock()
            if client.role not in CAMERA_ROLES:
                self._give("")
        self._tell(client)

    def leave(self, client: PageClient) -> None:
        """Tell a page nothing any more; its place is free if it does not come back soon."""
        self._pages.remove(client)

    def ask(self, client: PageClient, *, take: bool) -> bool:
        """Return whether a page has the place now: it is free, or the page wants to `take` it."""
        if client.role not in CAMERA_ROLES:
            return False
        if client.page != self._owner and (take or not self._owner):
            self._give(client.page)
        return client.page == self._owner

    def saw(self, client: PageClient) -> bool:
        """Return whether a picture of a page is one of the session."""
        if client.page == self._owner:
            self._seen = self._clock()
        return client.page == self._owner

    def check(self) -> None:
        """Free the place of a page that sends nothing."""
        if self._owner and self._clock() - self._seen > CAMERA_QUIET_S:
            self._give("")

    def _give(self, page: str) -> None:
        self._owner, self._seen = page, self._clock()
        for each in self._pages:
            self._tell(each)

    def _tell(self, client: PageClient) -> None:
        mine = "yours" if client.page == self._owner else "other"
        client.tell(do="place", camera=mine if self._owner else "free")
