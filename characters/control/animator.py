"""From commands to a posed character on the table, frame by frame."""

import math
from typing import Protocol

import numpy as np

from characters.control.command import CharacterCommand, LocomotionIntent, PosedCharacter
from characters.control.in_place import Actor
from characters.control.liveliness import Life
from characters.control.tree import TreePlayer
from characters.control.walker import Walker
from characters.errors import CharacterError
from characters.face.affect_display import RECIPES
from characters.locomotion.gaits import TOP_SPEED
from characters.model.character import Character
from characters.motion.motion import RootDelta
from characters.skeleton.pose import Array, Pose

LONGEST_STEP = 0.25
"""Time that one update may advance at most [s]: after a gap the character does not leap."""

WALKER_HEIGHT = 0.17
"""Height on the table of a character that walks [m]."""

ACTOR_HEIGHT = 0.15
"""Height on the table of a character that acts on the spot [m]."""


class Performer(Protocol):
    """A way to play a character: walking about, or acting on the spot."""

    state: str
    """What it is doing."""

    speed: float
    """AvatAR's Speed in use."""

    angular: float
    """How sharply it turns [rad], positive to its right."""

    weight: float
    """The intensity in use, −1…1."""

    place: RootDelta
    """Where it stands on the table [m] and where it looks [rad]."""

    height: float
    """How high it is over the table [m]."""

    @property
    def actions(self) -> tuple[str, ...]:
        """What it can be asked to do beside standing, walking and running."""
        ...

    def update(self, command: CharacterCommand, elapsed: float) -> Pose:
        """Advance by a time [s] under a command and return the pose, with the root in place."""
        ...


class Animator:
    """Plays a character under commands.

    A character is played as the file beside it says (`TreePlayer`). Without one, a character with
    a clip "Walk" that moves its root walks and runs (`Walker`); any other acts on the spot and
    hops (`Actor`).

    Parameters
    ----------
    character
        Who plays.
    scale
        Table metres for each metre of the character; by default a walker stands 0.17 m tall and
        another character 0.15 m.
    place
        Where it first stands on the table [m] and looks [rad].
    seed
        Of blinks and small movements: two of a kind with different seeds do not move together.
    alive
        Whether it looks, blinks, breathes, stirs and shows what it feels; without, its clips are
        shown as they are.
    """

    def __init__(
        self,
        character: Character,
        scale: float | None = None,
        place: RootDelta | None = None,
        seed: int = 0,
        alive: bool = True,
    ) -> None:
        walks = Walker.suits(character)
        planned = TreePlayer.suits(character)
        if scale is None:
            scale = (WALKER_HEIGHT if walks else ACTOR_HEIGHT) / max(character.height, 1e-9)
        self.character = character
        self.scale = scale
        self._now: float | None = None
        kind: type[Walker | Actor | TreePlayer] = Walker if walks else Actor
        self._performer: Performer = (TreePlayer if planned else kind)(character, scale, place)
        self._life: Life | None = None
        if alive:
            self._life = Life(
                character.skeleton,
                character.anatomy,
                character.morphs,
                seed,
                meshes=character.meshes,
            )

    @property
    def actions(self) -> tuple[str, ...]:
        """What the character can be asked to do beside standing, walking and running."""
        return self._performer.actions

    def update(self, command: CharacterCommand) -> PosedCharacter:
        """Advance to the command's time and return the character as it is to be drawn.

        The first call starts at rest. Time that runs backwards counts as none.

        Raises
        ------
        CharacterError
            If a number in the command is not finite, or the character does not know the action.
        """
        _check(command)
        elapsed = 0.0 if self._now is None else command.timestamp - self._now
        self._now = command.timestamp
        elapsed = min(max(elapsed, 0.0), LONGEST_STEP)
        performer = self._performer
        if self._life is not None and isinstance(performer, Actor):
            performer.tempo = self._life.tempo
        pose = performer.update(command, elapsed)
        placed = _placed(performer.place, performer.height, self.scale)
        if self._life is not None:
            pose = self._life.update(
                pose,
                elapsed,
                target=None if command.gaze is None else _seen_from(placed, command.gaze),
                effort=performer.speed / TOP_SPEED,
                busy=float(performer.state not in ("idle", "walk", "run")),
                emotion=command.emotion,
                played=performer.state in RECIPES,
            )
        return PosedCharacter(
            pose=pose,
            table_from_character=placed,
            visible=command.visible,
            state=performer.state,
            speed=performer.speed,
            angular=performer.angular,
            weight=performer.weight,
            timestamp=command.timestamp,
        )


def _check(command: CharacterCommand) -> None:
    """Refuse numbers that would stay with the character for ever."""
    numbers = [command.timestamp, command.speed, command.weight]
    going = command.locomotion or LocomotionIntent()
    for point in (going.target, going.facing, command.gaze):
        if point is not None:
            numbers += [float(value) for value in point]
    if not all(map(math.isfinite, numbers)):
        raise CharacterError(
            f"command at {command.timestamp} s has a number that is not finite: speed "
            f"{command.speed}, weight {command.weight}, target {going.target}, facing "
            f"{going.facing}, gaze {command.gaze}; leave out what is not known"
        )


def _placed(place: RootDelta, height: float, scale: float) -> Array:
    """Return `table_from_character`: scaled, turned about +y, and put down."""
    sine, cosine = math.sin(place.yaw) * scale, math.cos(place.yaw) * scale
    return np.array(
        [
            [cosine, 0.0, sine, place.x],
            [0.0, scale, 0.0, height],
            [-sine, 0.0, cosine, place.z],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )


def _seen_from(placed: Array, point: Array) -> Array:
    """Return a point of the table frame, (3,), in the frame of a character placed there."""
    turn_and_scale = placed[:3, :3]
    squared = float(placed[1, 1]) ** 2
    seen: Array = (np.asarray(point, float) - placed[:3, 3]) @ turn_and_scale / squared
    return seen
