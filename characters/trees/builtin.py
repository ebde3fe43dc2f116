"""What a character does without a file that says so, as a plan: for people to see."""

from characters.character import Character
from characters.locomotion import RUN_CLIPS, WALK_CLIPS
from characters.trees.conditions import Condition
from characters.trees.plan import PARAMETERS, Change, Machine, Node, Plan, Row
from characters.walker import Walker

_ENDINGS = {"head": -1.0, "legs": 0.0, "tail": 1.0}  # `characters.actor.INTENSITIES`
_WALKED, _RUN = 2.75, 3.25  # Speeds between which walking becomes running


def built_in(character: Character) -> Plan:
    """Return what `Animator` plays a character without a plan by.

    It is a drawing of `characters.walker` and `characters.actor`, which steer, plant feet and hop
    besides; played from a file it would do less.
    """
    states = _walker(character) if Walker.suits(character) else _actor(character)
    start = next(iter(states))
    changes = [
        Change(
            start,
            name,
            _condition("speed > 0.5" if name == "move" else f"action == {name!r}"),
            0.25,
        )
        for name in states
        if name != start
    ]
    changes += [
        Change(
            name, start, _condition("speed < 0.5" if name == "move" else "action == 'idle'"), 0.25
        )
        for name in states
        if name != start
    ]
    return Plan(character.name, None, Machine(states, start, tuple(changes)))


def _walker(character: Character) -> dict[str, Node]:
    trees = [
        Row(_space(name, "angular", knots, character), {"value": at})
        for name, knots, at in (("walking", WALK_CLIPS, _WALKED), ("running", RUN_CLIPS, _RUN))
        if any(clip in character.clips for clip in knots.values())
    ]
    move = Node("space", "move", "locomotion", {"by": "speed"}, {}, tuple(trees))
    idle = "idle" if "idle" in character.clips else "Walk"
    return {"idle": _clip(idle), "move": move}


def _actor(character: Character) -> dict[str, Node]:
    idle = [name for name in character.clips if "idle" in name.lower()] or [*character.clips][:1]
    states = {"idle": _clip(idle[0])} if idle else {}
    for name in character.clips:
        action, _, ending = name.rpartition("_")
        if not action or ending not in _ENDINGS:
            action = name
        if action in states or name in idle:
            continue
        knots = {
            w: f"{action}_{e}" for e, w in _ENDINGS.items() if f"{action}_{e}" in character.clips
        }
        states[action] = _space(action, "weight", knots, character) if knots else _clip(name)
    return states


def _space(name: str, by: str, knots: dict[float, str], character: Character) -> Node:
    rows = [
        Row(_clip(clip), {"value": at}) for at, clip in knots.items() if clip in character.clips
    ]
    return Node("space", name, name, {"by": by}, {}, tuple(rows))


def _clip(name: str) -> Node:
    return Node("clip", name, name, {"clip": name})


def _condition(text: str) -> Condition:
    return Condition.read(text, frozenset({"action"}), frozenset(PARAMETERS))
