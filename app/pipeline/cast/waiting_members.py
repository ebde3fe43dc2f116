"""Those of a cast that no cube leads: their names, places and seeds."""

import math
import re
import zlib
from collections.abc import Sequence

from cubeling.app.pipeline.cast.member import CastMember
from cubeling.app.pipeline.registry import WAITING
from cubeling.app.pipeline.table.attention import Attention
from cubeling.characters import Character, RootDelta

PLACES = ((0.17, -0.03), (0.05, -0.19), (-0.13, -0.20), (0.25, -0.18))
"""Where they stand at first, (x, z) on the table [m]: beside and behind the cube, so that each is
seen and the scenarios' own character, on the left, has its way."""

PLAYER_Z_M = 0.6
"""How far away the point is that they face at first, towards the player [m]."""


def cast_names(characters: Sequence[Character]) -> tuple[str, ...]:
    """Return the names of a cast: each its character's, with a number where two are the same.

    A name is a part of a channel's, so it has only letters, digits, "-" and "_".
    """
    names: list[str] = []
    for character in characters:
        plain = re.sub(r"[^\w-]+", "-", character.name) or "character"
        same = sum(1 for each in names if each.rpartition("_")[0] == plain or each == plain)
        names.append(f"{plain}_{same + 1}" if same else plain)
    return tuple(names)


def waiting_members(
    names: Sequence[str],
    characters: Sequence[Character],
    look: str,
    edge: float,
) -> tuple[CastMember, ...]:
    """Return the members of a cast after the first.

    Parameters
    ----------
    names, characters
        Theirs, at most four.
    look
        What they look at: one of `LOOK_CHOICES`.
    edge
        That of the cube [m].
    """
    waiting = WAITING["waiting"]
    members = []
    for number, (name, character) in enumerate(zip(names, characters, strict=True)):
        seed = zlib.crc32(name.encode())
        x, z = PLACES[number]
        place = RootDelta(x, z, math.atan2(-x, PLAYER_Z_M - z))
        scenario = waiting(place, number + 1)
        attention = Attention(look, edge, seed)
        members.append(CastMember(name, character, scenario, attention, seed=seed))
    return tuple(members)
