"""The behaviour of a character without a plan, written as a plan, for people to read."""

from collections.abc import Iterable, Mapping

from cubeling.characters.control.controllers.actions import clips_of_actions
from cubeling.characters.control.controllers.walk import NOT_ACTIONS, WalkController
from cubeling.characters.errors import CharacterError
from cubeling.characters.locomotion.gaits import IDLE_SPEED, RUN_CLIPS, WALK_CLIPS, WALK_RUN_SPEEDS
from cubeling.characters.model.character import Character
from cubeling.characters.model.standing import idle_clip
from cubeling.characters.motion.trees.conditions import Condition
from cubeling.characters.motion.trees.plan import (
    PARAMETERS,
    Node,
    Plan,
    Row,
    StateGraph,
    StateTransition,
)


def built_in_trees(character: Character) -> Plan:
    """Return the plan that corresponds to the built-in controller of a character.

    The controllers also steer, plant feet and hop; played from a file, this plan does less.

    Raises
    ------
    CharacterError
        If the character has no clips.
    """
    states = _walking(character) if WalkController.suits(character) else _in_place(character)
    start, *others = states
    enter = {name: f"action == {name!r}" for name in others} | {"move": f"speed > {IDLE_SPEED}"}
    leave = dict.fromkeys(others, "action == 'idle'") | {"move": f"speed < {IDLE_SPEED}"}
    changes = [StateTransition(start, name, _condition(enter[name]), 0.25) for name in others]
    changes += [StateTransition(name, start, _condition(leave[name]), 0.25) for name in others]
    return Plan(character.name, None, StateGraph(states, start, tuple(changes)))


def _walking(character: Character) -> dict[str, Node]:
    trees = [
        Row(_space(name, "angular", there), {"value": at})
        for name, knots, at in zip(
            ("walking", "running"), (WALK_CLIPS, RUN_CLIPS), WALK_RUN_SPEEDS, strict=True
        )
        if (there := {knot: clip for knot, clip in knots.items() if clip in character.clips})
    ]
    move = Node("space", "move", "locomotion", {"by": "speed"}, {}, tuple(trees))
    idle = "idle" if "idle" in character.clips else "Walk"
    return {"idle": _clip(idle), "move": move, **_actions(character, NOT_ACTIONS)}


def _in_place(character: Character) -> dict[str, Node]:
    idle = idle_clip(character.clips)
    if idle is None:
        raise CharacterError(f"{character.name}: has no clips, so there is no plan to show")
    return {"idle": _clip(idle), **_actions(character, [idle])}


def _actions(character: Character, besides: Iterable[str]) -> dict[str, Node]:
    return {
        action: _space(action, "weight", clips) if len(clips) > 1 else _clip(*clips.values())
        for action, clips in clips_of_actions(character.clips, besides).items()
    }


def _space(name: str, by: str, clips: Mapping[float, str]) -> Node:
    rows = [Row(_clip(clip), {"value": at}) for at, clip in clips.items()]
    return Node("space", name, name, {"by": by}, {}, tuple(rows))


def _clip(name: str) -> Node:
    return Node("clip", name, name, {"clip": name})


def _condition(text: str) -> Condition:
    return Condition.read(text, frozenset({"action"}), frozenset(PARAMETERS))
