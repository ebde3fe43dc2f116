"""The table of who is there, and messages as lines."""

from typing import Any

from rich.table import Table
from rich.text import Text

from robot.network import Member, Roster, Seen
from robot.network.messages import Action, Feeling, RobotState, Status, Taken

COLOURS = {"online": "green", "lost": "red", "closed": "dim"}

MOST = 40
"""Most rows of the table."""


def table(roster: Roster, now: float) -> Table:
    """Return who is there at time `now` [s], a row each."""
    shown = Table("site", "who", "", "link", "feels", "does", box=None, pad_edge=False)
    for member in sorted(roster.members)[:MOST]:
        seen = roster.members[member]
        presence = seen.presence(now)
        row = _player(seen) if member.role == "player" else _robot(seen)
        status = Text(presence, COLOURS[presence])
        shown.add_row(member.site, f"{member.role} {member.name}", status, *row)
    if not roster.members:
        shown.add_row("", Text("nobody is here yet", "dim"), "", "", "", "")
    return shown


def _player(seen: Seen) -> tuple[str, str, str]:
    feeling, action = seen.said.get("emotion"), seen.said.get("action")
    feels = "" if feeling is None else f"{feeling.label or ''} {feeling.valence:+.2f}".strip()
    return "", feels, "" if action is None else f"{action.name} (number {action.number})"


def _robot(seen: Seen) -> tuple[str, str, str]:
    state: RobotState | None = seen.said.get("state")
    if state is None:
        return "", "", ""
    link = state.link if state.battery is None else f"{state.link}, {state.battery:.0%}"
    feels = ""
    if state.observed is not None:
        feels = f"{state.label or ''} {state.observed[0]:+.2f}"
    elif state.commanded is not None:  # it cannot say what it shows
        feels = f"asked {state.commanded[0]:+.2f}"
    with_whom = f"with {state.player}" if state.player else ""
    does = ", ".join(word for word in (state.motion or "", with_whom) if word)
    return link, feels.strip(), does


def line(member: Member, kind: str, message: Any) -> str:
    """Return a message in one line.

    >>> line(Member("hall", "player", "ann"), "action", Action(1, 3, 3, "kiss", 0.5))
    'hall player ann: action 3, kiss, weight 0.50'
    """
    return f"{member.site} {member.role} {member.name}: {_said(kind, message)}"


def _said(kind: str, message: Any) -> str:
    match message:
        case Status():
            return message.status
        case Action():
            return f"action {message.number}, {message.name}, weight {message.weight:.2f}"
        case Feeling():
            label = f" {message.label}" if message.label else ""
            return f"feels{label} {message.valence:+.2f} {message.arousal:+.2f}"
        case Taken():
            marks = [f"{place} {number}" for place, (_, number) in message.players.items()]
            return f"has taken {', '.join(marks) or 'nothing yet'}"
        case RobotState():
            shown = "nothing" if message.observed is None else f"{message.observed[0]:+.2f}"
            return f"{message.link}, shows {message.label or ''} {shown}".replace("  ", " ")
        case _:
            return kind
