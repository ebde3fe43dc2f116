"""The members of a cast after the first: their names, places and seeds."""

import math
import zlib
from collections.abc import Sequence

from cubeling.app.pipeline.cast.member import CastMember
from cubeling.app.pipeline.registry import WAITING
from cubeling.app.pipeline.scenario import CastDirector, Scenario
from cubeling.app.pipeline.table.attention import Attention
from cubeling.characters import Character, RootDelta

FURTHER_PLACES_M = ((0.17, -0.03), (0.05, -0.19), (-0.13, -0.20), (0.25, -0.18))
"""Where they stand at first, (x, z) on the table: beside and behind the cube, so that each is
seen and the scenarios' own character, on the left, has its way."""

PLAYER_Z_M = 0.6
"""How far away the point is that they face at first, towards the player [m]."""


def seed_of(place: int, name: str) -> int:
    """Return the seed of a member of a cast, by its place, 0 for the first, and its name."""
    return zlib.crc32(name.encode()) if place else 0


def further_members(
    names: Sequence[str],
    characters: Sequence[Character],
    lead: Scenario,
    led: Sequence[Scenario],
    look: str,
    edges: Sequence[float],
) -> list[CastMember]:
    """Return the members of a cast after the first.

    Parameters
    ----------
    names, characters
        Theirs, at most four.
    lead
        What the first player plays; it may decide for others too, see `CastDirector`.
    led
        What the further players play, each with one of the characters; the rest watches the first.
    look
        What they look at: one of `LOOK_CHOICES`.
    edges
        Those of the cubes of all players [m].
    """
    waiting = WAITING["waiting"]
    members = []
    for number, (name, character) in enumerate(zip(names, characters, strict=True)):
        seed = seed_of(number + 1, name)
        x, z = FURTHER_PLACES_M[number]
        place = RootDelta(x, z, math.atan2(-x, PLAYER_Z_M - z))
        player = number + 1 if number < len(led) else 0
        directed = lead.scenario_of(number + 1, place) if isinstance(lead, CastDirector) else None
        scenario = directed or (led[number] if player else waiting(place, number + 1))
        attention = Attention(look, edges[player], seed)
        members.append(
            CastMember(
                name,
                character,
                scenario,
                attention,
                player=player,
                led=player > 0,
                place=place,
                seed=seed,
            )
        )
    return members
