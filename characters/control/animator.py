"""From commands to a posed character on the table, frame by frame."""

import math
from collections.abc import Sequence
from dataclasses import replace
from itertools import chain

import numpy as np

from cubeling.characters.body.posture import ExpressivityFilter
from cubeling.characters.control.command import CharacterCommand, LocomotionIntent, PosedCharacter
from cubeling.characters.control.controllers import (
    ControllerFactory,
    default_height,
    first_suitable,
)
from cubeling.characters.control.keep_clear import KeepClear
from cubeling.characters.control.layers import FrameContext, LayerFactory, apply_layers, layers_of
from cubeling.characters.control.tagged_gestures import TaggedGestures
from cubeling.characters.errors import CharacterError
from cubeling.characters.locomotion.obstacles import Obstacle
from cubeling.characters.model.character import Character
from cubeling.characters.motion.motion import RootDelta
from cubeling.characters.skeleton.pose import Array
from cubeling.characters.smoothing import low_pass

MAX_TIME_STEP_S = 0.25
"""Time that one update may advance at most [s], so that the character does not leap after a gap."""

REST_LAG_S = 0.5
"""Time constant with which a body comes to rest [s]."""


class Animator:
    """Animates a character under commands: one controller, then an ordered list of layers.

    Unless another is given, the controller is the first that suits the character:
    the plan of the file beside it, walking and running, or acting in place.

    Parameters
    ----------
    character
        The character.
    scale
        Table metres per metre of the character; left out, it is 15 or 17 cm tall on the table.
    place
        Where it first stands on the table [m] and faces [rad]; left out, at the origin, or, if it
        acts in place, where it is first sent.
    seed
        Seed of blinks, sway and idle motion.
    layers
        What is applied to the controller's poses, in order; left out, those of `layers_of`.
    controller
        Makes the controller; see `choose_controller`.

    Raises
    ------
    CharacterError
        If the plan of the file beside the character cannot be played.
    """

    def __init__(
        self,
        character: Character,
        scale: float | None = None,
        place: RootDelta | None = None,
        seed: int = 0,
        layers: Sequence[LayerFactory] | None = None,
        controller: ControllerFactory = first_suitable,
    ) -> None:
        if scale is None:
            scale = default_height(character) / max(character.height, 1e-9)
        self.character = character
        self.scale = scale
        # A copy would not share the gaits, which take long to find.
        seeded = character if character.seed == seed else replace(character, seed=seed)
        self.controller = controller(seeded, scale, place)
        """What moves it."""
        used = layers_of(character) if layers is None else layers
        self._layers = [layer(character, seed) for layer in used]
        self._keep_clear = KeepClear(character)
        self._expressivity = ExpressivityFilter()
        self._tagged = TaggedGestures(character)
        self._rest = 1.0
        self._timestamp: float | None = None

    @property
    def actions(self) -> tuple[str, ...]:
        """The actions that the character knows, besides standing, walking and running."""
        return self.controller.actions

    @property
    def walks(self) -> bool:
        """Whether the character walks and runs; else it hops."""
        return self.controller.walks

    @property
    def length(self) -> float:
        """Length of the character on the table, from front to back [m]."""
        return self.character.length * self.scale

    def obstacle(self, velocity: Array) -> Obstacle | None:
        """Return the body as others keep out of it, with its velocity, (3,) [m/s].

        None if nothing has been drawn.
        """
        return self._keep_clear.obstacle(velocity)

    def update(self, command: CharacterCommand) -> PosedCharacter:
        """Advance to the command's time and return the character as it is to be drawn.

        The first call starts at rest. Time that runs backwards counts as none.

        Raises
        ------
        CharacterError
            If a number in the command is not finite, or the character does not know the action.
        """
        _check(command)
        elapsed = 0.0 if self._timestamp is None else command.timestamp - self._timestamp
        self._timestamp = command.timestamp
        elapsed = min(max(elapsed, 0.0), MAX_TIME_STEP_S)
        command = self._tagged.add(command)
        tempo = math.sqrt(self._expressivity.value.tempo)
        directed = self._keep_clear.direct(command, self.walks)
        frame = self.controller.update(directed, elapsed, tempo)
        frame = self._keep_clear.keep(frame, command, elapsed)
        activity = max(float(frame.acting), min(2.0 * frame.effort, 1.0))
        self._rest = low_pass(self._rest, 1.0 - activity, elapsed, REST_LAG_S)
        context = FrameContext(
            elapsed,
            command,
            frame,
            self.scale,
            _table_from_character(frame.place, frame.height, self.scale),
            self._expressivity.update(elapsed, command.emotion),
            self._rest,
        )
        pose, _ = apply_layers(self._layers, frame.pose, context)
        self._keep_clear.learn(pose, context.table_from_character)
        return PosedCharacter(
            pose=pose,
            table_from_character=context.table_from_character,
            visible=command.visible,
            state=frame.state,
            speed=frame.speed,
            angular=frame.angular,
            weight=frame.weight,
            timestamp=command.timestamp,
        )


def _check(command: CharacterCommand) -> None:
    """Refuse numbers that are not finite: they would stay in the state for ever."""
    numbers = [command.timestamp, command.speed, command.weight]
    going = command.locomotion or LocomotionIntent()
    boxes = [(each.table_from_box.ravel(), each.velocity) for each in command.obstacles]
    for point in (going.target, going.facing, command.gaze, *chain.from_iterable(boxes)):
        if point is not None:
            numbers += np.asarray(point, float).tolist()
    if not all(map(math.isfinite, numbers)):
        raise CharacterError(
            f"command at {command.timestamp} s has a number that is not finite: speed "
            f"{command.speed}, weight {command.weight}, target {going.target}, facing "
            f"{going.facing}, gaze {command.gaze}, {len(boxes)} obstacles; leave out the unknown"
        )


def _table_from_character(place: RootDelta, height: float, scale: float) -> Array:
    """Return the placement of a character: scaled, turned about +y, and translated."""
    sine, cosine = math.sin(place.yaw) * scale, math.cos(place.yaw) * scale
    return np.array(
        [
            [cosine, 0.0, sine, place.x],
            [0.0, scale, 0.0, height],
            [-sine, 0.0, cosine, place.z],
            [0.0, 0.0, 0.0, 1.0],
        ]
    )
