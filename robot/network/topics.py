"""The topic tree, and the names in it.

    cubeling / 1 / SITE / player | robot / NAME / status | action | …

The 1 is the version of the tree and of its messages. An incompatible later version gets another
number, so both can share a broker.
"""

from dataclasses import dataclass
from typing import Literal

from cubeling.robot.errors import RobotError

ROOT = "cubeling/1"
"""Prefix of every topic."""

MAX_NAME_BYTES = 32
"""Longest name of a site, a player or a robot [bytes of UTF-8]."""

ANY_NAME = "*"
"""In a pattern: every site, or every member of a site."""

FURTHER = ":"
"""Between the names of a player and of a further character of its cast: "ann:vleo"."""

DEFAULT_SITE = "home"
"""The site of those who name none."""

Role = Literal["player", "robot"]
ROLES: tuple[Role, ...] = ("player", "robot")


@dataclass(frozen=True, order=True)
class Member:
    """A player or a robot."""

    site: str
    """Where it stands, such as "north-hall": players follow robots of one site."""

    role: Role

    name: str
    """Its name, unique for its site and role."""

    def topic(self, kind: str) -> str:
        """Return the topic of a kind of its messages.

        >>> Member("hall", "player", "ann").topic("status")
        'cubeling/1/hall/player/ann/status'
        """
        return f"{ROOT}/{self.site}/{self.role}/{self.name}/{kind}"

    @property
    def place(self) -> str:
        """Site and name: "hall/ann"."""
        return f"{self.site}/{self.name}"

    @property
    def is_further(self) -> bool:
        """Whether it is a further character of a player, as "ann:vleo"."""
        return FURTHER in self.name

    def __str__(self) -> str:
        return f"the {self.role} {self.name!r} of the site {self.site!r}"


@dataclass(frozen=True)
class Pattern:
    """One member, all members of a site, or all."""

    site: str
    """A site, or `ANY`."""

    name: str
    """A name, or `ANY`."""

    @classmethod
    def parse(cls, text: str, site: str) -> "Pattern":
        """Parse "ann", "*", "south/ann", "south/*" or "*/*".

        Parameters
        ----------
        text
            A name or "*", with a site or "*" before it if that is not `site`.
        site
            The site of a text without one.

        Raises
        ------
        RobotError
            If the text has another form, or a name in it is not valid.
        """
        place, slash, name = text.rpartition("/")
        found = cls(place if slash else site, name)
        for part in (found.site, found.name):
            if part != ANY_NAME:
                check_name(part, "name to follow")
        return found

    def matches(self, member: Member) -> bool:
        """Whether it includes a member; "*" is for the first character of each player only.

        >>> ann, vleo = (Member("hall", "player", name) for name in ("ann", "ann:vleo"))
        >>> [Pattern("hall", name).matches(vleo) for name in ("*", "ann", "ann:vleo")]
        [False, False, True]
        >>> Pattern("hall", "*").matches(ann)
        True
        """
        any_name = self.name == ANY_NAME and not member.is_further
        return self.site in (ANY_NAME, member.site) and (any_name or self.name == member.name)

    def filter(self, role: Role, kind: str) -> str:
        """Return the topic filter for a kind of messages.

        >>> Pattern("hall", "*").filter("player", "status")
        'cubeling/1/hall/player/+/status'
        """
        site, name = ("+" if part == ANY_NAME else part for part in (self.site, self.name))
        return f"{ROOT}/{site}/{role}/{name}/{kind}"

    def __str__(self) -> str:
        return f"{self.site}/{self.name}"


def member_of(topic: str) -> tuple[Member, str] | None:
    """Return member and kind of a topic; None if it is not of this tree.

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
    """Whether this is a valid name: letters and digits of any script, and - _ after the first.

    That of a further character is two of them.

    >>> [is_name(text) for text in ("ann", "ann:vleo_2", "ann:", ":vleo", "a:b:c")]
    [True, True, False, False, False]
    """
    parts = text.split(FURTHER, 1)
    plain = (each.replace("-", "x").replace("_", "x").isalnum() for each in parts)
    begins = all(each[:1].isalnum() for each in parts)
    return all(plain) and begins and len(text.encode()) <= MAX_NAME_BYTES


def check_name(text: str, what: str) -> str:
    """Return a name.

    Parameters
    ----------
    text
        The name: letters and digits of any script, `-` and `_` after the first character.
    what
        What it names, for the message: "site".

    Raises
    ------
    RobotError
        If it is not valid, or longer than `MAX_NAME_BYTES`.
    """
    if not is_name(text):
        raise RobotError(
            f"{text!r} cannot be a {what}; use letters, digits, - and _, "
            f"at most {MAX_NAME_BYTES} bytes, beginning with a letter or digit"
        )
    return text


def topic_matches(topic_filter: str, topic: str) -> bool:
    """Whether a topic matches a filter with wildcards + and # (MQTT 5, section 4.7).

    >>> topic_matches("a/+/c", "a/b/c"), topic_matches("a/#", "a/b"), topic_matches("a/+", "a/b/c")
    (True, True, False)
    """
    pattern, parts = topic_filter.split("/"), topic.split("/")
    if pattern[-1] == "#":
        pattern, parts = pattern[:-1], parts[: len(pattern) - 1]
    return len(pattern) == len(parts) and all(
        one in ("+", part) for one, part in zip(pattern, parts, strict=True)
    )
