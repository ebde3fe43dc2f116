"""What the player is told in `reach`: it follows from what the character does, and from why."""

from dataclasses import dataclass

from cubeling.app.scenarios.reach.catching import EASY, HARD, MOVED_M, Catching, Prospect


@dataclass(frozen=True)
class Facts:
    """What the act and the hint of a frame follow from."""

    doing: str
    """What the character does."""

    seen: bool = True
    """Whether the cube is seen."""

    aloft: bool = False
    """Whether the cube is off the table."""

    reach: str = "easily"
    """How the cube can be touched from where the character is: "easily", "hardly", or "not"."""

    moved: bool = False
    """Whether the cube has moved since it was touched."""

    thing: str = ""
    """The thing that it fetches or has."""


def facts_of(doing: str, prospect: Prospect, catching: Catching, edge: float, thing: str) -> Facts:
    """Return the facts of a frame; `edge` is that of the cube [m]."""
    reach = "hardly" if prospect.effort <= HARD else "not"
    return Facts(
        doing,
        prospect.seen,
        is_aloft(prospect, edge),
        "easily" if prospect.effort <= EASY else reach,
        catching.has_moved(prospect, catching.caught, MOVED_M),
        thing,
    )


def is_aloft(prospect: Prospect, edge: float) -> bool:
    """Return whether a cube is off the table: more than half of it above where it would rest."""
    return bool(prospect.cube[1] > edge)


def hint_of(facts: Facts) -> str:
    """Return what to tell the player."""
    aloft, doing = facts.aloft, facts.doing
    closer = "Hold the cube lower" if aloft else "Push the cube a little to me"
    if facts.reach == "easily":  # what keeps its hand away is not the distance
        closer = "Move the cube a little"
    why = "So high!" if aloft else "So far!"
    if doing == "search" and facts.seen:
        return "There it is!"
    if doing == "stretch":
        return f"{why if facts.reach == 'not' else 'Nearly!'} {closer}"
    if doing == "shrug":
        return f"{why} I cannot reach it" if facts.reach == "not" else f"Not quite! {closer}"
    if doing == "sulk" and facts.reach == "not":
        return "Bring the cube down to me" if aloft else "Bring the cube nearer to me"
    if doing == "sulk":
        return closer
    if doing == "cheer":
        return "Hooray!" if facts.moved else "Hooray! Now move the cube"
    if doing == "hold":
        wish = "Put the cube down" if aloft else "Leave the cube there"
        return f"{wish}: the {facts.thing} is for you"
    return _HINTS[facts.doing].format(thing=facts.thing)


_HINTS = {
    "watch": "Move the cube: can I reach it?",
    "touch": "I have it, nearly!",
    "clasp": "I hold it with you! Move the cube a little",
    "point": "There it is! I come",
    "come": "Wait, I come to the cube",
    "shade": "So high! Bring the cube down to me",
    "search": "Where is the cube? Show it to me",
    "fetch": "Look, I get the {thing} for you",
    "grasp": "Look, I take the {thing}",
    "carry": "I bring you the {thing}",
    "put": "Here is the {thing}",
    "give": "Here you are",
    "rejoice": "All for you! Move the cube, or shake it",
}
