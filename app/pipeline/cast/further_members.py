"""The members of a cast after the first: their names, places and seeds."""

import math
import zlib
from collections.abc import Sequence

from cubeling.app.pipeline.cast.member import CastMember
from cubeling.app.pipeline.registry import WAITING
from cubeling.app.pipeline.scenario import CastDirector, FurnishedScenario, Scenario
from cubeling.app.pipeline.table.attention import Attention
from cubeling.app.pipeline.table.situation import PLAYER_POSITION
from cubeling.characters import Character, RootDelta

FURTHER_PLACES_M = ((0.17, -0.03), (0.05, -0.19), (-0.13, -0.20), (0.25, -0.18))
"""Where they stand at first, (x, z) on the table: beside and behind the cube, so that each is
seen and the scenarios' own character, on the left, has its way."""

MORE_PLACES_M = ((0.31, -0.01), (0.19, -0.27))
"""Where one stands instead if a thing of the scenario is at its place."""

CLEARANCE_M = 0.11
"""How far they stand from things at least [m]: who fetches one has its way."""


def waiting_places(
    kept_free: Sequence[tuple[float, float]] = (),
) -> tuple[tuple[float, float], ...]:
    """Return the places of the further members, (x, z) [m], away from places that are kept free."""
    free = [
        place
        for place in (*FURTHER_PLACES_M, *MORE_PLACES_M)
        if all(math.dist(place, each) > CLEARANCE_M for each in kept_free)
    ]
    rest = (place for place in FURTHER_PLACES_M if place not in free)
    return (*free, *rest)[: len(FURTHER_PLACES_M)]


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
    places = waiting_places(lead.kept_free if isinstance(lead, FurnishedScenario) else ())
    player_x, player_z = PLAYER_POSITION.tolist()
    members = []
    for number, (name, character) in enumerate(zip(names, characters, strict=True)):
        seed = seed_of(number + 1, name)
        x, z = places[number]
        place = RootDelta(x, z, math.atan2(player_x - x, player_z - z))
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
