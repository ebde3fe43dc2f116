"""Checks of section 6: MOVE turns single joints, and holds them until they are let go."""

from collections.abc import Callable
from dataclasses import replace

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.checks.failsafe import SILENCE_S
from cubeling.robot.conformance.checks.ways import (
    ANGLE_TOLERANCE_RAD,
    FAR_RAD,
    LEVEL,
    MIN_DURATION_S,
    SPARE_TIME,
    begin_way,
    choose_way,
    crossing_time,
    expect_angles,
    expect_even,
    expect_held,
    movable_joints,
    one_angle,
    wide_joints,
    within_limits,
)
from cubeling.robot.conformance.errors import CheckFailed, NotApplicableError
from cubeling.robot.conformance.probe import EFFECT_WITHIN_S, TIMING_SLACK_S, Probe
from cubeling.robot.protocol import messages as m

MOVING = CheckGroup("Joints", 6)

LONG_DURATION_S = 60.0
"""Duration of a slow way [s]; as a signed number of 16 bits it would be negative."""

MAX_WAY_S = 2.0
"""Longest way that is waited for [s]."""

MAX_MOTIONS = 8
"""Most motions that are tried against held joints."""

HELD_S = 0.35
"""Time for each of them [s]."""


@MOVING.must_of(4)
def abilities_valid(probe: Probe) -> str:
    """Without bit 0 of `abilities` every MOVE is refused by 3; the other bits are 0."""
    welcome = probe.open_session()
    if probe.version < 3:
        raise NotApplicableError("it speaks an earlier version")
    if welcome.abilities & ~m.ABILITY_MOVE:
        raise CheckFailed("WELCOME with no abilities but bit 0", f"abilities={welcome.abilities}")
    if welcome.abilities:
        return "it takes MOVE"
    for moved in (0, 1, 0xFFFF):
        probe.command(m.Move(probe.next_number(), 0.0, 0, moved, LEVEL), m.RESULT_CANNOT)
    return "it does not take MOVE"


@MOVING.must
def joint_moved(probe: Probe) -> None:
    """A joint of MOVE is held within 250 ms, and at its angle once `duration` is over."""
    way = begin_way(probe)
    probe.keep_alive(max(way.duration - EFFECT_WITHIN_S, 0.0))
    probe.expect_state(
        lambda state: abs(state.joints[way.joint.index] - way.goal) <= ANGLE_TOLERANCE_RAD,
        2 * EFFECT_WITHIN_S,
        f"joint {way.joint.index} at {way.goal:.3f} rad {way.duration:.1f} s after MOVE",
        "joints",
    )


@MOVING.must
def joint_moved_evenly(probe: Probe) -> None:
    """A joint of MOVE goes evenly: when half of `duration` is over, it is about half-way.

    It does so also when a second MOVE turns back half-way, and in a minute.
    """
    way = choose_way(probe)
    expect_even(probe, way, way.duration / 2)
    state = probe.beat("MOVE")
    back = replace(way, start=state.joints[way.joint.index], goal=way.start)
    expect_even(probe, back, way.duration / 2)
    state = probe.beat("MOVE")
    slow = replace(way, start=state.joints[way.joint.index], duration=LONG_DURATION_S)
    expect_even(probe, slow, MIN_DURATION_S)


@MOVING.must
def held_joint_stays(probe: Probe) -> None:
    """EXPRESS, PLAY, and a MOVE of no joint neither move nor let go of held joints.

    Here all joints are held, each where it happens to be.
    """
    joints = movable_joints(probe)
    if not joints:
        raise NotApplicableError("it has no joints")
    angles = within_limits(joints, probe.beat("HELLO").joints)
    bits = (1 << len(joints)) - 1
    probe.command(m.Move(probe.next_number(), 0.0, 0, bits, angles))
    expect_held(probe, bits, "MOVE of all joints")
    probe.keep_alive(EFFECT_WITHIN_S)  # they moved on while that MOVE was on its way
    probe.express(0.8, 0.6)
    assert probe.welcome is not None
    motions = [*range(probe.welcome.motions)][:: -(-probe.welcome.motions // MAX_MOTIONS) or 1]
    for motion in motions or [m.NOTHING]:
        probe.send(m.Play(probe.next_number(), m.ITEM_MOTION, motion))
        probe.command(m.Move(probe.next_number(), 0.0, 0, 0, LEVEL))
        for state in probe.keep_alive(HELD_S):
            expect_angles(state, bits, angles, "EXPRESS and PLAY")


@MOVING.must
def other_joints_left_alone(probe: Probe) -> None:
    """A MOVE neither takes nor lets go of joints that it does not name; their angles are ignored.

    A MOVE of several joints takes all of them, each to its own angle.
    """
    joints = movable_joints(probe)
    if len(joints) < 2:
        raise NotApplicableError("it has fewer than two joints")
    angles = within_limits(joints, probe.beat("HELLO").joints)
    last = 1 << len(joints) - 1
    for released, moved, held, named in (
        (0, last, last, (*(FAR_RAD,) * (len(joints) - 1), angles[len(joints) - 1])),
        (0, 1, last | 1, (angles[0], *(-FAR_RAD,) * (len(joints) - 1))),
        (last, 0, 1, (FAR_RAD,) * len(joints)),
    ):
        named = (*named, *(FAR_RAD,) * m.JOINTS_MAX)[: m.JOINTS_MAX]
        probe.command(m.Move(probe.next_number(), 0.3, released, moved, named))
        expect_held(probe, held, f"MOVE(released={released}, moved={moved})")
    bits = (1 << len(joints)) - 1
    targets = within_limits(joints, [0.5 * (one.low + one.high) for one in joints])
    longest = max(
        abs(targets[one.index] - angles[one.index]) / max(one.speed, 1e-3) for one in joints
    )
    duration = round(min(SPARE_TIME * longest + MIN_DURATION_S, MAX_WAY_S), 3)
    probe.command(m.Move(probe.next_number(), duration, 0, bits, targets))
    state = probe.keep_alive(duration + EFFECT_WITHIN_S)[-1]
    if SPARE_TIME * longest < MAX_WAY_S:
        expect_angles(state, bits, targets, f"MOVE of all joints in {duration:.1f} s")


@MOVING.must_of(7)
def joint_returns_within_its_speed(probe: Probe) -> None:
    """A joint that is let go returns no faster than its top speed."""
    wide = wide_joints(probe)
    # The way of a slow joint is seen for longest; one that takes seconds would cost too much.
    joint = max(wide, key=lambda one: (crossing_time(one) <= MAX_WAY_S, crossing_time(one)))
    start = probe.beat("HELLO").joints[joint.index]
    goal = joint.low if start > (joint.low + joint.high) / 2 else joint.high
    bit = 1 << joint.index
    probe.command(m.Move(probe.next_number(), 0.0, 0, bit, one_angle(joint.index, goal)))
    probe.keep_alive(crossing_time(joint) + EFFECT_WITHIN_S)
    before = probe.beat("MOVE").joints[joint.index]
    begin = probe.now
    probe.command(m.Move(probe.next_number(), 0.0, bit, 0, LEVEL))
    for state in probe.keep_alive(EFFECT_WITHIN_S):
        time = probe.now - begin
        way = abs(state.joints[joint.index] - before)
        if way > joint.speed * (time + TIMING_SLACK_S) + ANGLE_TOLERANCE_RAD:
            raise CheckFailed(
                f"joint {joint.index} at most {joint.speed} rad/s after it was let go",
                f"{way:.3f} rad in {1000 * time:.0f} ms at most",
            )


@MOVING.must_of(5)
def move_taken_in_earlier_versions(probe: Probe) -> None:
    """A MOVE is taken in sessions of versions 1 and 2 too."""
    joints = movable_joints(probe)
    if not joints:
        raise NotApplicableError("it has no joints")
    angles = within_limits(joints, probe.beat("HELLO").joints)
    for offer in (1, 2):
        probe.hello(offer=offer)
        number = probe.next_number()
        probe.send(m.Move(number, 0.0, 0, 1, angles))
        after = f"MOVE in a session of version {offer}"
        probe.expect(m.Ack, after, number=number, result=m.RESULT_TAKEN)
        probe.hello()
        expect_held(probe, 1, after)
        probe.command(m.Move(probe.next_number(), 0.0, 1, 0, LEVEL))


@MOVING.must
def joint_let_go(probe: Probe) -> None:
    """A joint in `released` is no longer held; one that is in `moved` too is held again."""
    way = begin_way(probe)
    both = m.Move(
        probe.next_number(), way.duration, way.bit, way.bit, one_angle(way.joint.index, way.start)
    )
    probe.command(both)
    for state in probe.keep_alive(EFFECT_WITHIN_S):
        if state.held != way.bit:
            raise CheckFailed(f"held={way.bit} after a MOVE with it in both", f"held={state.held}")
    probe.command(m.Move(probe.next_number(), 0.0, way.bit, 0, LEVEL))
    expect_held(probe, 0, "a MOVE that lets go")


@MOVING.must
def angle_beyond_limits_refused(probe: Probe) -> None:
    """A MOVE beyond a joint's limits is refused by 2 and moves nothing; the limits are allowed."""
    way = choose_way(probe)
    joint, index = way.joint, way.joint.index
    for angle in (joint.low, joint.high):
        command = m.Move(probe.next_number(), way.duration, 0, way.bit, one_angle(index, angle))
        probe.command(command)
    probe.command(m.Move(probe.next_number(), 0.0, way.bit, 0, LEVEL))
    expect_held(probe, 0, "a MOVE that lets go")
    for angle in (joint.low - 1e-3, joint.high + 1e-3, FAR_RAD):
        command = m.Move(probe.next_number(), 0.0, 0, way.bit, one_angle(index, angle))
        probe.command(command, m.RESULT_OUT_OF_RANGE)
    for state in probe.keep_alive(EFFECT_WITHIN_S):
        if state.held:
            raise CheckFailed("held=0 after refused MOVEs", f"held={state.held}")


@MOVING.must
def unknown_joint_refused(probe: Probe) -> None:
    """A MOVE with a bit for a joint that the catalogue does not have is refused by 1."""
    joints = len(movable_joints(probe))
    if joints == m.JOINTS_MAX:
        raise NotApplicableError("it has as many joints as there are bits")
    for bit in {1 << joints, 1 << m.JOINTS_MAX - 1}:
        for released, moved in ((bit, 0), (0, bit)):
            number = probe.next_number()
            # Beyond their limits too, but the smaller result counts.
            far = (FAR_RAD,) * m.JOINTS_MAX
            probe.command(m.Move(number, 0.0, released, moved | 1, far), m.RESULT_REFUSED)
            probe.expect_taken(number, "a refused MOVE")


@MOVING.must
def old_move_without_effect(probe: Probe) -> None:
    """A MOVE whose number is not above the last one's holds nothing and lets go of nothing."""
    way = begin_way(probe)
    number = probe.command(m.Move(probe.next_number(), 0.0, way.bit, 0, LEVEL))
    for old in (number, number - 1):
        probe.send(way.command(old))
        probe.expect(m.Ack, f"MOVE {old}, with {number} taken before", number=old)
    for state in probe.keep_alive(EFFECT_WITHIN_S)[1:]:
        if state.held:
            raise CheckFailed("held=0 after an old MOVE", f"held={state.held}")


@MOVING.must
def stop_lets_go(probe: Probe) -> None:
    """STOP lets go of all joints, and the next MOVE ends the stop, also one of no joint."""
    way = begin_way(probe)
    probe.command(m.Stop(probe.next_number()))
    expect_held(probe, 0, "STOP")
    probe.command(way.command(probe.next_number()))
    probe.expect_state(
        lambda state: not state.flags & m.FLAG_STILL and state.held == way.bit,
        EFFECT_WITHIN_S,
        f"flag 1 clear and held={way.bit} after STOP and MOVE",
        "flags", "held",
    )  # fmt: skip
    probe.command(m.Stop(probe.next_number()))
    probe.command(m.Move(probe.next_number(), 0.0, 0, 0, LEVEL))
    probe.expect_state(
        lambda state: not state.flags & m.FLAG_STILL,
        EFFECT_WITHIN_S,
        "flag 1 clear after STOP and a MOVE of no joint",
        "flags",
    )


@MOVING.must_of(7)
def failsafe_lets_go(probe: Probe) -> None:
    """The failsafe acts while joints are held too, and lets go of all of them."""

    def wait() -> None:
        probe.receive(SILENCE_S)
        probe.send(m.Beat(probe.next_beat()))
        probe.expect(m.Gone, f"MOVE, {1000 * SILENCE_S:.0f} ms of silence, BEAT")

    _expect_let_go(probe, wait, probe.reopen_session, "the failsafe")


@MOVING.must_of(7)
def bye_lets_go(probe: Probe) -> None:
    """BYE lets go of all joints."""
    _expect_let_go(probe, lambda: probe.send(m.Bye()), probe.reopen_session, "BYE")


@MOVING.must_of(5)
def another_host_lets_go(probe: Probe) -> None:
    """HELLO of another host lets go of all joints."""
    _expect_let_go(probe, lambda: None, probe.open_session, "HELLO of another host")


@MOVING.must_of(5)
def same_host_keeps_hold(probe: Probe) -> None:
    """When the same host says HELLO again in time, held joints stay held."""
    way = begin_way(probe)
    probe.reopen_session()
    for state in probe.keep_alive(EFFECT_WITHIN_S):
        if state.held != way.bit:
            raise CheckFailed(f"held={way.bit} in the next session", f"held={state.held}")


def _expect_let_go(
    probe: Probe, leave: Callable[[], object], come_back: Callable[[], object], after: str
) -> None:
    begin_way(probe)
    leave()
    come_back()
    expect_held(probe, 0, after)
