"""Elbows of arms that reach: they do not snap, and keep what they have of their own."""

import numpy as np
import pytest

from cubeling.characters.ik.reaching import HandTarget, ReachStyle
from cubeling.characters.ik.reaching.arms import bend, effector_of, to_vector
from cubeling.characters.ik.reaching.swivel import natural_elbow
from cubeling.characters.skeleton.scalar_quaternions import IDENTITY
from tests.characters.ik.reaching.bodies import BUNDLED, bundled

SHOULDER, AHEAD = (0.0, 0.0, 0.0), np.array([0.1, -0.2, 0.95]) / np.linalg.norm([0.1, -0.2, 0.95])


@pytest.mark.parametrize("name", BUNDLED)
def test_an_elbow_does_not_snap_where_an_arm_is_stretched(name: str) -> None:
    """It turns by less than 11 rad for each arm length that a place moves, also out of reach."""
    arm = bundled(name).upper.arms["left"]
    full, wrist, step = arm.upper + arm.fore, effector_of(arm, arm.wrist), 2e-3
    angles = []
    for extension in np.arange(0.9, 1.3, step):
        place = to_vector(extension * full * AHEAD)
        elbow = natural_elbow(arm, SHOULDER, place, IDENTITY)
        bent = bend(arm, wrist, SHOULDER, place, IDENTITY, elbow)
        upper, fore = np.array(bent.elbow) / arm.upper, np.subtract(bent.wrist, bent.elbow)
        angles.append(np.arccos(np.clip(upper @ fore / np.linalg.norm(fore), -1.0, 1.0)))
        short = np.linalg.norm(np.array(bent.wrist) - np.array(place)) / full
        assert short < max(0.01, extension - 1.0 + 0.01)
    assert np.abs(np.diff(angles)).max() / step < 11.0
    assert np.degrees(angles[-1]) < 8.0


def test_an_elbow_keeps_what_it_has_of_its_own_near_where_the_hand_is() -> None:
    body = bundled("human")
    where = body.shoulder("left") + 0.6 * body.reach_of("left") * AHEAD
    target, style = HandTarget(where), ReachStyle(openness=1.0)
    raised, natural = (
        body.upper.reach(body.rest, left=target, style=each) for each in (style, ReachStyle())
    )
    elbow, palm = body.elbow("left", raised), body.palm("left", raised)
    moved = []
    for way in (0.0, 0.3, 0.6):
        place = palm - [0.0, way * body.reach_of("left"), 0.0]
        from_raised, from_rest = (
            body.elbow("left", body.upper.reach(pose, left=HandTarget(place)))
            for pose in (raised, natural)
        )
        moved.append(body.person_mm(from_raised - from_rest))
        if not way:
            kept = body.person_mm(from_raised - elbow)
    lost = body.person_mm(body.elbow("left", natural) - elbow)
    assert kept < 0.25 * lost
    assert moved == sorted(moved, reverse=True)
    assert moved[0] > 2.0 * moved[-1]
