"""Checks of section 6: STOP ends everything, and the next command ends the stop."""

from collections.abc import Sequence

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.errors import CheckFailed, NotApplicableError
from cubeling.robot.conformance.probe import (
    EFFECT_WITHIN_S,
    EMOTION_CHANGE,
    EMOTION_WITHIN_S,
    Probe,
    is_neutral,
)
from cubeling.robot.protocol import messages as m

STOPPING = CheckGroup("Stop", 6)

REST_TOLERANCE_RAD = 0.03
"""Largest apparent movement of a joint at rest, by the noise of its sensor [rad]."""

MIN_REST_S = 2.0
"""How long a stopped robot must rest [s]: long enough to notice a slow sway."""

REST_STEP_S = 0.2
"""Time between two tests whether it rests [s]."""


@STOPPING.must
def stop_stops(probe: Probe) -> None:
    """After STOP, STATE says within 250 ms that it is stopped and plays no motion and no sound."""
    welcome = probe.open_session()
    probe.express(0.5, 0.5)
    for item, count in ((m.ITEM_MOTION, welcome.motions), (m.ITEM_SOUND, welcome.sounds)):
        if count:
            probe.command(m.Play(probe.next_number(), item, count - 1))
    probe.keep_alive(0.1)
    probe.command(m.Stop(probe.next_number()))
    probe.expect_state(
        lambda state: bool(state.flags & m.FLAG_STILL) and state.motion == state.sound == m.NOTHING,
        EFFECT_WITHIN_S,
        "STATE with flag 1, motion=255, sound=255 after STOP",
        "flags", "motion", "sound",
    )  # fmt: skip


@STOPPING.must
def stop_holds_the_pose(probe: Probe) -> None:
    """After STOP the emotion shown goes to neutral, and the joints come to rest, within 5 s."""
    probe.open_session()
    probe.express(0.8, 0.6)
    probe.keep_alive(0.5)
    probe.command(m.Stop(probe.next_number()))
    probe.stop_pose = _wait_for_rest(probe)


@STOPPING.must
def stop_takes_the_same_pose(probe: Probe) -> None:
    """The joints take the same pose after every STOP, whatever the emotion was before."""
    known_stop_pose(probe)
    probe.open_session()
    probe.express(-0.8, -0.4)
    probe.keep_alive(0.5)
    probe.command(m.Stop(probe.next_number()))
    expect_stop_pose(probe, "a second STOP", within=EMOTION_WITHIN_S)


@STOPPING.must
def express_after_stop(probe: Probe) -> None:
    """An EXPRESS after STOP ends the stop: the flag is clear, and the emotion changes."""
    probe.open_session()
    probe.command(m.Stop(probe.next_number()))
    before = probe.keep_alive(0.1)[-1].valence
    target = -0.8 if before > 0 else 0.8
    probe.express(target, 0.0)
    last = probe.keep_alive(1.0, lambda state: abs(state.valence - before) > EMOTION_CHANGE)[-1]
    if last.flags & m.FLAG_STILL or (last.valence - before) * target <= 0:
        raise CheckFailed(
            f"flag 1 clear, and valence going from {before} to {target}, after STOP and EXPRESS",
            f"flags={last.flags}, valence={last.valence}",
        )


@STOPPING.must
def play_after_stop(probe: Probe) -> None:
    """A PLAY after STOP ends the stop, of a motion as of a sound."""
    welcome = probe.open_session()
    counts = {m.ITEM_MOTION: welcome.motions, m.ITEM_SOUND: welcome.sounds}
    if not any(counts.values()):
        raise NotApplicableError("it has no motions and no sounds")
    for item, count in counts.items():
        if not count:
            continue
        probe.command(m.Stop(probe.next_number()))
        probe.keep_alive(0.1)
        probe.command(m.Play(probe.next_number(), item, count - 1))
        probe.expect_state(
            lambda state: not state.flags & m.FLAG_STILL,
            EFFECT_WITHIN_S,
            f"flag 1 clear after STOP and PLAY of item {item}",
            "flags",
        )


def largest_movement(states: Sequence[m.State]) -> float:
    """Return the range of the angle of the joint that moved most [rad]."""
    return max(max(angles) - min(angles) for angles in _angles_by_joint(states))


def known_stop_pose(probe: Probe) -> tuple[float, ...]:
    """Return the joints after STOP [rad]; the first call may stop the robot to measure them."""
    if probe.stop_pose is None:
        stop_holds_the_pose(probe)
    assert probe.stop_pose is not None
    return probe.stop_pose


def expect_stop_pose(probe: Probe, after: str, within: float) -> None:
    """Expect the joints where they are after STOP, within a time [s]."""
    pose = known_stop_pose(probe)

    def wrong_joints(state: m.State) -> list[int]:
        distances = [abs(now - then) for then, now in zip(pose, state.joints, strict=True)]
        return [index for index, way in enumerate(distances) if way > 2 * REST_TOLERANCE_RAD]

    last = probe.keep_alive(within, lambda state: not wrong_joints(state))[-1]
    for index in wrong_joints(last):
        raise CheckFailed(
            f"joint {index} at {pose[index]:.3f} rad after {after}, as after the first STOP",
            f"{last.joints[index]:.3f} rad",
        )


def _wait_for_rest(probe: Probe) -> tuple[float, ...]:
    """Wait until a stopped robot rests, and return its joints [rad].

    Raises CheckFailed if it does not come to rest within 5 s.
    """
    steps: list[list[m.State]] = []
    end = probe.now + EMOTION_WITHIN_S + MIN_REST_S
    while True:
        steps.append(probe.keep_alive(REST_STEP_S))
        last = steps[-1][-1]
        states = [state for step in steps[-round(MIN_REST_S / REST_STEP_S) :] for state in step]
        movement = largest_movement(states)
        long_enough = len(steps) * REST_STEP_S >= MIN_REST_S
        if long_enough and movement <= REST_TOLERANCE_RAD and is_neutral(last):
            return tuple(sum(angles) / len(states) for angles in _angles_by_joint(states))
        if probe.now > end:
            raise CheckFailed(
                f"joints at rest and emotion (0, 0) within {EMOTION_WITHIN_S:.0f} s after STOP",
                f"a joint that moves by {movement:.3f} rad in {MIN_REST_S:.0f} s, "
                f"emotion ({last.valence}, {last.arousal})",
            )


def _angles_by_joint(states: Sequence[m.State]) -> list[tuple[float, ...]]:
    return list(zip(*(state.joints for state in states), strict=True))
