"""The topic tree: who speaks where, and what a name may be.

    cubeling / 1 / SITE / player | robot / NAME / status | action | …

The 1 is the version of the tree and of the messages in it. A later one that old programs would
misunderstand gets another number, and both can share a broker.
"""

from dataclasses import dataclass
from typing import Literal

from robot.errors import RobotError

ROOT = "cubeling/1"
"""Every topic begins with it."""

NAME_BYTES = 32
"""Longest name of a site, a player or a robot [bytes of UTF-8]."""

EVERYONE = "*"
"""In a pattern: every site, or everyone there."""

Role = Literal["player", "robot"]
ROLES: tuple[Role, ...] = ("player", "robot")


@dataclass(frozen=True, order=True)
class Member:
    """A player or a robot, by its place in the tree."""

    site: str
    """Where it is: "north-hall"."""

    role: Role
    """What it is."""

    name: str
    """What it is called there."""

    def topic(self, kind: str) -> str:
        """Return the topic of one kind of its messages.

        >>> Member("hall", "player", "ann").topic("status")
        'cubeling/1/hall/player/ann/status'
        """
        return f"{ROOT}/{self.site}/{self.role}/{self.name}/{kind}"

    @property
    def place(self) -> str:
        """Site and name: "hall/ann"."""
        return f"{self.site}/{self.name}"

    def __str__(self) -> str:
        return f"the {self.role} {self.name!r} of the site {self.site!r}"


@dataclass(frozen=True)
class Pattern:
    """Members of one role: one of them, all of a site, or all."""

    site: str
    """A site, or `EVERYONE`."""

    name: str
    """A name, or `EVERYONE`."""

    @classmethod
    def parse(cls, text: str, site: str) -> "Pattern":
        """Read what a person writes: "ann", "*", "south/ann", "south/*", "*/*".

        Parameters
        ----------
        text
            A name, with its site in front if that is another than `site`.

        Raises
        ------
        RobotError
            If it is none of these.
        """
        place, slash, name = text.rpartition("/")
        found = cls(place if slash else site, name)
        for part in (found.site, found.name):
            if part != EVERYONE:
                check_name(part, "name to follow")
        return found

    def matches(self, member: Member) -> bool:
        """Whether it means this one."""
        return self.site in (EVERYONE, member.site) and self.name in (EVERYONE, member.name)

    def filter(self, role: Role, kind: str) -> str:
        """Return the topic filter for one kind of messages.

        >>> Pattern("hall", "*").filter("player", "status")
        'cubeling/1/hall/player/+/status'
        """
        site, name = ("+" if part == EVERYONE else part for part in (self.site, self.name))
        return f"{ROOT}/{site}/{role}/{name}/{kind}"

    def __str__(self) -> str:
        return f"{self.site}/{self.name}"


def member_of(topic: str) -> tuple[Member, str] | None:
    """Return whose topic it is and of which kind; None if it is none of ours.

    >>> member_of("cubeling/1/hall/robot/rex/state")
    (Member(site='hall', role='robot', name='rex'), 'state')
    """
    parts = topic.split("/")
    if len(parts) != 6 or "/".join(parts[:2]) != ROOT:
        return None
    site, role, name, kind = parts[2:]
    if not (is_name(site) and is_name(name)):
        return None
    for known in ROLES:
        if role == known:
            return Member(site, known, name), kind
    return None


def is_name(text: str) -> bool:
    """Whether this can be a name: letters and digits of any script, and - _ between them.

    Nothing that means something in a topic, a client's id, a command line or a terminal.
    """
    inner = text.replace("-", "x").replace("_", "x")
    return inner.isalnum() and text[0].isalnum() and len(text.encode()) <= NAME_BYTES


def check_name(text: str, what: str) -> str:
    """Return a name, or raise RobotError in one line that says what it must be."""
    if not is_name(text):
        raise RobotError(
            f"{text!r} cannot be a {what}: letters, digits, - and _, at most {NAME_BYTES} bytes, "
            "beginning with a letter or digit"
        )
    return text


def fits(topic_filter: str, topic: str) -> bool:
    """Whether a topic filter with its wildcards + and # means a topic (MQTT 5, section 4.7).

    >>> fits("a/+/c", "a/b/c"), fits("a/#", "a/b/c"), fits("a/+", "a/b/c")
    (True, True, False)
    """
    wanted, given = topic_filter.split("/"), topic.split("/")
    if wanted[-1] == "#":
        wanted, given = wanted[:-1], given[: len(wanted) - 1]
    return len(wanted) == len(given) and all(
        part in ("+", there) for part, there in zip(wanted, given, strict=True)
    )
