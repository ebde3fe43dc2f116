"""The table of the members of the network, and messages as lines."""

from typing import Any

from rich.table import Table
from rich.text import Text

from cubeling.app.ui.literal_text import literal_text
from cubeling.robot.network import (
    AckMessage,
    ActionMessage,
    EmotionMessage,
    Member,
    Roster,
    RosterEntry,
    StateMessage,
    StatusMessage,
)

PRESENCE_STYLES = {"online": "green", "lost": "red", "closed": "dim"}

MAX_ROWS = 40
"""Most rows of the table."""


def table(roster: Roster, now: float) -> Table:
    """Return a table of the members at time `now` [s]."""
    shown = Table("site", "member", "", "link", "emotion", "action", box=None, pad_edge=False)
    for member in sorted(roster.members)[:MAX_ROWS]:
        entry = roster.members[member]
        presence = entry.presence(now)
        row = _player(entry) if member.role == "player" else _robot(entry)
        status = Text(presence, PRESENCE_STYLES[presence])
        shown.add_row(member.site, f"{member.role} {member.name}", status, *map(literal_text, row))
    if not roster.members:
        shown.add_row("", Text("no members yet", "dim"), "", "", "", "")
    return shown


def _player(entry: RosterEntry) -> tuple[str, str, str]:
    emotion, action = entry.messages.get("emotion"), entry.messages.get("action")
    shown = "" if emotion is None else f"{emotion.label or ''} {emotion.valence:+z.2f}".strip()
    return "", shown, "" if action is None else f"{action.name} (number {action.number})"


def _robot(entry: RosterEntry) -> tuple[str, str, str]:
    state: StateMessage | None = entry.messages.get("state")
    if state is None:
        return "", "", ""
    link = state.link if state.battery is None else f"{state.link}, {state.battery:.0%}"
    emotion = ""
    if state.observed is not None:
        emotion = f"{state.label or ''} {state.observed[0]:+z.2f}"
    elif state.commanded is not None:  # it does not report what it shows
        emotion = f"commanded {state.commanded[0]:+z.2f}"
    player = f"with {state.player}" if state.player else ""
    action = ", ".join(word for word in (state.motion or "", player) if word)
    return link, emotion.strip(), action


def line(member: Member, kind: str, message: Any) -> str:
    """Return a message in one line.

    >>> line(Member("hall", "player", "ann"), "action", ActionMessage(1, 3, 3, "kiss", 0.5))
    'hall player ann: action 3, kiss, weight 0.50'
    """
    return f"{member.site} {member.role} {member.name}: {_content(kind, message)}"


def _content(kind: str, message: Any) -> str:
    match message:
        case StatusMessage():
            return message.status
        case ActionMessage():
            return f"action {message.number}, {message.name}, weight {message.weight:.2f}"
        case EmotionMessage():
            label = f" {message.label}" if message.label else ""
            return f"emotion{label} {message.valence:+z.2f} {message.arousal:+z.2f}"
        case AckMessage():
            taken = [f"{place} {number}" for place, (_, number) in message.players.items()]
            return f"taken: {', '.join(taken) or 'nothing yet'}"
        case StateMessage():
            shown = "nothing" if message.observed is None else f"{message.observed[0]:+z.2f}"
            return f"{message.link}, shows {message.label or ''} {shown}".replace("  ", " ")
        case _:
            return kind
