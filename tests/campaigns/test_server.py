"""The campaign of attacks serves honest clients, and detects those that are not served."""

import math
from contextlib import closing

import pytest

from cubeling.app.behaving.server import BlockServer
from tests.campaigns.attacks import ATTACKS
from tests.campaigns.served import TOKEN, Seen, Served, serve, served_s
from tests.campaigns.server import FRAME_CPU_S, MEMORY_MB, SERVED_S, SHORT, Outcome, run_attack

pytestmark = pytest.mark.full


def test_an_honest_client_is_served_during_an_attack():
    with serve() as server:
        outcome = run_attack(server, "constraints", ATTACKS["2,400 constraints"], 0.5)
    # The memory is that of the whole process, in which other tests have run.
    assert outcome.wrong in ("", "memory")
    assert outcome.clients
    assert outcome.seen.frames


def test_a_client_that_nobody_serves_is_noticed():
    with closing(BlockServer(0, TOKEN)) as server:
        assert served_s(Served(server.port, None), "honest", 0.2) == math.inf  # type: ignore


@pytest.mark.parametrize(
    ("waited", "frame", "memory", "wrong"),
    [
        (SERVED_S, FRAME_CPU_S, MEMORY_MB, ""),
        (math.inf, 0.0, 0.0, "not served"),
        (0.0, 2 * FRAME_CPU_S, 0.0, "a long frame"),
        (0.0, 0.0, 2 * MEMORY_MB, "memory"),
    ],
)
def test_what_hurts_is_named(waited, frame, memory, wrong):
    assert Outcome(waited, 1, Seen(1, 0.1, frame, memory)).wrong == wrong


def test_the_short_form_has_attacks_of_the_long_one():
    assert set(SHORT) < ATTACKS.keys()
