"""The desk: takes acts from a page, hands them to the session, and notes delay and errors."""

import json
import math
import threading
import time
from collections import deque
from collections.abc import Callable, Sequence
from typing import Any, Literal

import cv2
import msgspec
import numpy as np
from numpy.typing import NDArray

from cubeling.app.admission import Token
from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import Step
from cubeling.app.pipeline.table.acts import MAX_PLACE_M, MAX_SAID_CHARS, Act, ActNote
from cubeling.app.pipeline.table.situation import table_from_cube
from cubeling.app.running.instrument import Instrument
from cubeling.app.running.wizard.plan import WizardPlan, emotion_of
from cubeling.app.session.acts import act_words
from cubeling.app.ui.web.page import Documents, document
from cubeling.app.ui.web.server import WebServer
from cubeling.characters import Character, CharacterError
from cubeling.characters.speech import TaggedText

SHOWN_ACTS = 30
"""Acts that the page lists, the last ones."""

QUIET_S = 5.0
"""After so long without a frame, nothing is played [s]."""

PICTURE_WIDTH_PX = 480
"""Of the picture of the session on the desk."""

TO_CUBE = "cube"
"""The name of "go" that leads to the cube, wherever it is now."""

BESIDE_CUBE_M = 0.1
"""How far from the middle of the cube a character stands that was sent to it [m]."""
DESK_PATH = "/desk"
"""Where the server has the page."""

MAX_WAITING = 64
"""Acts that wait for the next frame; of more, the last are left out."""


class DeskRequest(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """What the page asks for."""

    do: Literal["say", "action", "gesture", "emotion", "go", "play", "cue", "undo"]
    name: str = ""
    """Text, name or word; "" with "emotion" releases it."""

    weight: float = 1.0
    """Intensity of an action, −1…1."""

    place: tuple[float, float] | None = None
    """Where to go, (x, z) [m]; None releases it, or leads to the cube with the name `TO_CUBE`."""

    number: int = 0
    """The act that was an error."""


def desk_page() -> Documents:
    """Return the page, in each language."""
    return document("desk.html", ["base.css", "desk.css"], ["base.js", "desk.js"], ["desk"])


class WizardDesk(Instrument):
    """A page by which an experimenter drives character and robot; an `Instrument`.

    It has a token of its own: who plays in a browser of the same server cannot reach it.

    Parameters
    ----------
    server
        Serves the page; whoever opened it closes it.
    plan
        The buttons.
    clock
        The time [s] of `Instrument.follow`.
    """

    speaks = True

    def __init__(
        self,
        server: WebServer,
        plan: WizardPlan | None = None,
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._plan, self._clock = plan or WizardPlan(), clock
        self._lock = threading.Lock()
        self._groups: list[dict[str, Any]] = []
        self._doing: dict[str, Any] = {}
        self._picture: NDArray[np.uint8] | None = None
        self._followed = -math.inf
        self._clear()
        token = Token.generate()
        server.open(DESK_PATH, self, token, desk_page())
        self.addresses = server.addresses(DESK_PATH, token)
        """Where the wizard's browser finds the page: here, and in the network if that is let in."""

    def _clear(self) -> None:
        self._count = 0
        self._waiting: list[Act] = []
        self._cue, self._cue_at = "", 0.0
        self._acts: deque[dict[str, Any]] = deque(maxlen=SHOWN_ACTS)

    def begin(self, cast: Sequence[Character]) -> None:
        """Take the buttons of the first character; numbers begin again with each session."""
        groups = self._plan.buttons(cast[0])
        with self._lock:
            self._groups = groups
            self._clear()

    def follow(self, step: Step, cast: Sequence[Character], taken: float) -> Inputs:
        """Show the page what happens, and return what the wizard has done since."""
        robot = self._plan.robot_buttons(self.robot)
        doing = _doing(step)
        with self._lock:
            self._doing = {**doing, "robot": robot}
            self._followed, self._picture = self._clock(), step.picture
            acts, self._waiting = tuple(self._waiting), []
        return Inputs(acts=acts)

    def happen(self, event: str, taken: float) -> None:
        """Take an event as a cue if the plan names it."""
        name = next((each for each in (event, event.split(" ")[0]) if each in self._plan.cues), "")
        if name:
            with self._lock:
                self._mark(name, taken)

    def get(self, place: str) -> tuple[str, bytes] | None:
        """Return the state of the page, or the picture of the session."""
        if place == "state":
            return self._state()
        picture = self._picture
        if place != "picture" or picture is None:
            return None
        height = round(picture.shape[0] * PICTURE_WIDTH_PX / picture.shape[1])
        small = cv2.resize(picture, (PICTURE_WIDTH_PX, height), interpolation=cv2.INTER_AREA)
        return "image/jpeg", cv2.imencode(".jpg", small)[1].tobytes()

    def post(self, data: bytes) -> tuple[str, bytes]:
        """Take an act, and return the state; what cannot be done is told on the page."""
        try:
            problem = self.ask(msgspec.json.decode(data, type=DeskRequest))
        except msgspec.MsgspecError as error:
            problem = f"this is no request of the desk: {error}"
        return self._state(problem)

    def ask(self, request: DeskRequest) -> str:
        """Let something be done with the next frame; return why it cannot be, "" if it can."""
        now = self._clock()
        with self._lock:
            if now - self._followed > QUIET_S:
                return "nothing is played now"
            if len(self._waiting) >= MAX_WAITING:
                return "too much at once"
            if request.do == "cue":
                self._mark(request.name[:MAX_SAID_CHARS], now)
            elif request.do == "undo":
                return self._undo(request.number)
            else:
                return self._act(request, now)
        return ""

    def _act(self, request: DeskRequest, now: float) -> str:
        if request.do == "say":
            try:
                TaggedText.read(request.name)
            except CharacterError as error:
                return str(error)
            if not 0 < len(request.name.strip()) <= MAX_SAID_CHARS:
                return f"what is said has 1 to {MAX_SAID_CHARS} characters"
        place = request.place
        if request.do == "go":
            if request.name == TO_CUBE and (place := self._beside_cube()) is None:
                return "the cube is not seen"
            if max(map(abs, place or (0.0,))) > MAX_PLACE_M:
                return "this place is off the table"
        self._count += 1
        delay = round(now - self._cue_at, 4) if self._cue else None
        act = Act(
            request.do,
            request.name,
            request.weight,
            emotion_of(request.name) if request.do == "emotion" else None,
            place,
            ActNote(self._count, self._cue, delay),
        )
        self._waiting.append(act)
        told = {"number": self._count, "kind": act.kind, "name": act_words(act)}
        self._acts.append({**told, "cue": self._cue, "delay_s": delay, "undone": False})
        return ""

    def _beside_cube(self) -> tuple[float, float] | None:
        """Return a place beside the cube, on the character's side; None while it is not seen."""
        if self._doing.get("cube") is None:
            return None
        cube, away = np.array(self._doing["cube"]), np.array(self._doing["character"])
        away -= cube
        apart = float(np.hypot(*away))
        side = away / apart if apart > 0.0 else np.array([0.0, 1.0])
        x, z = cube + BESIDE_CUBE_M * side
        return round(float(x), 3), round(float(z), 3)

    def _mark(self, name: str, now: float) -> None:
        self._count += 1
        self._cue, self._cue_at = name, now
        self._waiting.append(Act("cue", name, note=ActNote(self._count)))
        told = {"number": self._count, "kind": "cue", "name": name}
        self._acts.append({**told, "cue": "", "delay_s": None, "undone": False})

    def _undo(self, number: int) -> str:
        act = next((each for each in self._acts if each["number"] == number), None)
        if act is None or act["undone"]:
            return "this act is not there to be undone"
        act["undone"] = True
        if act["kind"] == "cue" and act["name"] == self._cue:
            self._cue = ""
        self._waiting.append(Act("undo", note=ActNote(number)))
        return ""

    def _state(self, problem: str = "") -> tuple[str, bytes]:
        now = self._clock()
        with self._lock:
            state = {
                "playing": now - self._followed <= QUIET_S,
                "groups": self._groups,
                "cues": list(self._plan.cues or ("cue",)),
                "places": [[p.name, p.x_cm / 100, p.z_cm / 100] for p in self._plan.place],
                "cue": [self._cue, round(now - self._cue_at, 1)] if self._cue else None,
                "acts": list(self._acts),
                "problem": problem,
                **self._doing,
            }
        return "application/json", json.dumps(state).encode()


def _doing(step: Step) -> dict[str, Any]:
    """Return what the page says about a step."""
    place = step.posed.table_from_character[:3, 3]
    cube = table_from_cube(step.state, step.controls)
    says = "" if step.line is None else step.line.utterance.text
    return {
        "scenario": step.scenario,
        "activity": step.command.activity,
        "emotion": step.emotion.emotion.label,
        "says": says,
        "character": [round(float(place[0]), 3), round(float(place[2]), 3)],
        "cube": None
        if cube is None
        else [round(float(cube[0, 3]), 3), round(float(cube[2, 3]), 3)],
        "robot": (),
    }
