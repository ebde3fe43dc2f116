"""Another cube than the one that is played with: the player is told which it is."""

from collections.abc import Iterator, Sequence

from cubeling.app.pipeline.registry import SCENARIOS
from cubeling.app.pipeline.scenario import Scenario, missing_roles
from cubeling.tracking import CubeModel, CubeRecognizer, CubeState, Frame, bundled_cubes

LOOK_AFTER_S, LOOK_EVERY_S, SHOWN_S = 1.0, 0.5, 1.5
"""After so long without the cube other cubes are looked for, so often; one that was recognised is
named for so long."""


class OtherCube:
    """Recognises the player's other cubes and the bundled ones while the cube in play is not seen.

    Parameters
    ----------
    cube
        The cube in play.
    known_cubes
        The player's cubes. One with the markers of a bundled cube takes its place.
    players_cubes
        Those of the other players, which are in play too.
    """

    def __init__(
        self,
        cube: CubeModel,
        known_cubes: Sequence[CubeModel] = (),
        players_cubes: Sequence[CubeModel] = (),
    ) -> None:
        self._in_play, self._known_cubes = (cube, *players_cubes), tuple(known_cubes)
        self._recognizer: CubeRecognizer | None = None
        self._unseen_since: float | None = None
        self._looked_at = self._named_at = float("-inf")
        self._found: CubeModel | None = None

    def update(self, frame: Frame, state: CubeState) -> CubeModel | None:
        """Return another cube that is in view, None for none."""
        now = frame.timestamp
        if state.visible or self._unseen_since is None:
            self._unseen_since, self._found = now, None
        waited = now - self._unseen_since >= LOOK_AFTER_S
        if waited and now - self._looked_at >= LOOK_EVERY_S:
            self._looked_at = now
            self._look(frame)
        return self._found if now - self._named_at < SHOWN_S else None

    def _look(self, frame: Frame) -> None:
        if self._recognizer is None:
            self._recognizer = CubeRecognizer(tuple(self._candidates()))
        found = self._recognizer.recognize(frame.image)
        if found is not None and all(found is not each for each in self._in_play):
            self._found, self._named_at = found, frame.timestamp

    def _candidates(self) -> Iterator[CubeModel]:
        """Yield the first of the cubes that have the same markers."""
        seen = set()
        for cube in (*self._in_play, *self._known_cubes, *map(CubeModel.load, bundled_cubes())):
            if cube.markers not in seen:
                yield cube
            seen.add(cube.markers)


def cube_for(
    scenario: type[Scenario], in_view: CubeModel | None, known_cubes: Sequence[CubeModel]
) -> CubeModel:
    """Return the cube to play a scenario with.

    It is the one in view, or else the first of the player's that has all the roles that the
    scenario reads, or else the scenario's own.
    """
    choices = known_cubes if in_view is None else (in_view, *known_cubes)
    able = (cube for cube in choices if not missing_roles(scenario, cube))
    return next(able, None) or CubeModel.load(scenario.cube)


def advice(cube: CubeModel, playing: str, own_cube: str, fixed: bool) -> str:
    """Return what to tell the player about another cube.

    Parameters
    ----------
    cube
        The cube in view.
    playing
        Name of the present scenario.
    own_cube
        Name of the cube that it is played with.
    fixed
        Whether no key changes the scenario.

    >>> companion = CubeModel.load("companion")
    >>> advice(companion, "follow", "locomotion", False)
    'This is the companion cube: press 3 to play companion'
    >>> advice(companion, "companion", "museum", False)
    'This is the companion cube: press 3 to play companion with it'
    >>> advice(companion, "follow", "locomotion", True)
    'This is the companion cube: it plays companion'
    >>> advice(companion, "companion", "museum", True)
    'This is the companion cube: show me the museum cube'
    """
    this = f"This is the {_title(cube.name)}"
    scenario = scenario_for(cube, playing)
    if not scenario:
        return this
    if fixed:
        played = scenario == playing
        return f"{this}: {f'show me the {_title(own_cube)}' if played else f'it plays {scenario}'}"
    key = list(SCENARIOS).index(scenario) + 1
    return f"{this}: press {key} to play {scenario}{' with it' if scenario == playing else ''}"


def _title(name: str) -> str:
    return name if name.lower().endswith("cube") else f"{name} cube"


def scenario_for(cube: CubeModel, playing: str = "") -> str:
    """Return the name of the bundled scenario that a cube suits best, "" for none.

    That is the one that it is made for, or else the one that reads most of its roles; of several
    the present one.
    """
    able = [each for each in SCENARIOS.values() if not missing_roles(each, cube)]
    best = max(
        able,
        key=lambda each: (each.cube == cube.name, len(each.roles), each.name == playing),
        default=None,
    )
    return "" if best is None else best.name
