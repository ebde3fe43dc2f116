"""What a character does without a file that says so, as a plan: for people to see."""

from collections.abc import Iterable, Mapping

from characters.control.actions import clips_of_acts
from characters.control.walker import NO_ACTS, Walker
from characters.locomotion.gaits import RUN_CLIPS, WALK_CLIPS, WALK_RUN_SPEEDS
from characters.model.character import Character
from characters.motion.trees.conditions import Condition
from characters.motion.trees.plan import PARAMETERS, Node, Plan, Row, StateGraph, Transition


def built_in(character: Character) -> Plan:
    """Return what `Animator` plays a character without a plan by.

    It is a drawing of `characters.control.walker` and `in_place`, which steer, plant feet and hop
    besides; played from a file it would do less.
    """
    states = _walker(character) if Walker.suits(character) else _actor(character)
    start = next(iter(states))
    changes = [
        Transition(
            start,
            name,
            _condition("speed > 0.5" if name == "move" else f"action == {name!r}"),
            0.25,
        )
        for name in states
        if name != start
    ]
    changes += [
        Transition(
            name, start, _condition("speed < 0.5" if name == "move" else "action == 'idle'"), 0.25
        )
        for name in states
        if name != start
    ]
    return Plan(character.name, None, StateGraph(states, start, tuple(changes)))


def _walker(character: Character) -> dict[str, Node]:
    trees = [
        Row(_space(name, "angular", there), {"value": at})
        for name, knots, at in zip(
            ("walking", "running"), (WALK_CLIPS, RUN_CLIPS), WALK_RUN_SPEEDS, strict=True
        )
        if (there := {knot: clip for knot, clip in knots.items() if clip in character.clips})
    ]
    move = Node("space", "move", "locomotion", {"by": "speed"}, {}, tuple(trees))
    idle = "idle" if "idle" in character.clips else "Walk"
    return {"idle": _clip(idle), "move": move, **_acts(character, NO_ACTS)}


def _actor(character: Character) -> dict[str, Node]:
    idle = [name for name in character.clips if "idle" in name.lower()] or [*character.clips][:1]
    return {**({"idle": _clip(idle[0])} if idle else {}), **_acts(character, idle[:1])}


def _acts(character: Character, besides: Iterable[str]) -> dict[str, Node]:
    return {
        action: _space(action, "weight", clips) if len(clips) > 1 else _clip(*clips.values())
        for action, clips in clips_of_acts(character.clips, besides).items()
    }


def _space(name: str, by: str, clips: Mapping[float, str]) -> Node:
    rows = [Row(_clip(clip), {"value": at}) for at, clip in clips.items()]
    return Node("space", name, name, {"by": by}, {}, tuple(rows))


def _clip(name: str) -> Node:
    return Node("clip", name, name, {"clip": name})


def _condition(text: str) -> Condition:
    return Condition.read(text, frozenset({"action"}), frozenset(PARAMETERS))
