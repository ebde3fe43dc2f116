"""A player in front of a screen: asks for things when so many pictures were shown."""

from collections import deque

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.running.opened_session import OpenedSession
from cubeling.app.running.summary.summary import Summary
from cubeling.app.session.encoding import encode
from cubeling.app.ui.screen import NullScreen


class Player(NullScreen):
    """Asks for what the script says: (after how many pictures, or "idle", a request).

    "idle" is when nothing happens any more. `Inputs` are asked of the scenario.
    Instead of a request there may be a function, which is called with the player. At the end of the
    script, a player leaves when nothing happens.
    """

    attended = True
    session: OpenedSession
    """The session that is shown, for functions of the script."""

    summary: Summary
    """What came of it."""

    def __init__(self, *script):
        self._script = deque(script)
        self.steps, self.previews = [], []
        self.statuses = []
        self.notices = []
        self.closed = False
        self._idle = 0
        self._asked = Inputs()

    def show(self, step, robot):
        self.steps.append(step)
        self._idle = 0
        asked, self._asked = self._asked, Inputs()
        return asked

    def preview(self, step, robot):
        self.previews.append(step.frame.index)

    def wait(self, notice):
        self._idle += not self.statuses[-1].seeking
        if self._idle > 2 and not self._script:
            self.closed = True

    def take_requests(self):
        due = []
        while self._script and self._is_due(self._script[0][0]):
            request = self._script.popleft()[1]
            made = request(self) if callable(request) else request
            if isinstance(made, Inputs):
                self._asked = made
            elif made is not None:
                due.append(made)
            self._idle = 0
        return due

    def _is_due(self, when):
        return self._idle > 2 if when == "idle" else len(self.steps) >= when

    def report(self, status):
        self.statuses.append(status)

    def notify(self, words):
        self.notices.append(words)

    @property
    def indices(self):
        return [step.frame.index for step in self.steps]

    def messages(self):
        """Return the messages of the last time that each frame was shown."""
        return {
            step.frame.index: [encode(message) for message in step.messages().values()]
            for step in self.steps
        }
