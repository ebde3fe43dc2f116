"""Checks of section 7: STATE comes regularly, and what it reports is true."""

from itertools import pairwise
from statistics import median

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.checks.moods import expect_emotion
from cubeling.robot.conformance.errors import CheckFailed
from cubeling.robot.conformance.exchange import REPLY_WITHIN_S
from cubeling.robot.conformance.probe import (
    EMOTION_TOLERANCE,
    TIMING_SLACK_S,
    Probe,
    emotion_distance,
)
from cubeling.robot.protocol import messages as m, timing

HEARTBEAT = CheckGroup("Heartbeat and state", 7)

ROUND_TRIPS = 30
"""BEATs for the measurement of the round trip."""

MAX_MEDIAN_ROUND_TRIP_S = 0.020
"""Largest median round trip of a good robot [s]."""

LISTENING_TIME_S = 0.35
"""Time in which STATE must come without BEAT [s]; shorter than the failsafe's."""

REPEATED_BEATS = 4
"""BEATs of the same count in one write: more than the STATEs that come meanwhile unasked."""

MAX_JUMP = 0.4
"""Part of the way, or of 1 if it is shorter, that an emotion covers in `WATCHED_S` at most."""

WATCHED_S = 0.06
"""Time in which a jump is looked for [s]: some steps of a robot's body."""

WATCH_EVERY_S = 0.01
"""Time between two looks [s]."""

MAX_STATES_PER_SECOND = 40.0
"""Most STATEs of a good robot [1/s]: one for each BEAT, and as many again."""


@HEARTBEAT.must
def beat_answered(probe: Probe) -> None:
    """BEAT is answered by STATE with its count, within 100 ms, whatever the count is."""
    probe.open_session()
    for count in (1, 0, 65535, 256, 0):
        probe.send(m.Beat(count))
        probe.expect(m.State, f"BEAT({count})", beat=count)


@HEARTBEAT.must
def beats_of_one_count_answered(probe: Probe) -> None:
    """Every BEAT is answered, whether its count goes up or not."""
    probe.open_session()
    for count in (7, 7, 6, 6):
        before = len(probe.log.states)
        probe.send(*[m.Beat(count)] * REPEATED_BEATS)
        probe.receive(REPLY_WITHIN_S)
        states = sum(state.beat == count for _, state in probe.log.states[before:])
        if states < REPEATED_BEATS:
            expected = f"{REPEATED_BEATS} STATEs after as many BEAT({count})"
            raise CheckFailed(expected, f"{states}")


@HEARTBEAT.must
def beat_forgotten_in_a_new_session(probe: Probe) -> None:
    """Before the first BEAT of a session, STATE says 0 for its count."""
    probe.open_session()
    probe.beat("HELLO")
    probe.reopen_session()
    within = timing.STATE_EVERY + TIMING_SLACK_S
    state = probe.expect(m.State, "HELLO of another session", within)
    if state.beat:
        raise CheckFailed("STATE(beat=0) before the first BEAT of a session", f"beat={state.beat}")


@HEARTBEAT.must
def state_sent_without_beat(probe: Probe) -> None:
    """When no BEAT comes, STATE comes every 100 ms."""
    probe.open_session()
    pauses = pauses_between_states(probe)
    if max(pauses) > timing.STATE_EVERY + TIMING_SLACK_S:
        raise CheckFailed(
            f"STATE every {1000 * timing.STATE_EVERY:.0f} ms after WELCOME",
            f"{len(pauses) - 1} in {1000 * LISTENING_TIME_S:.0f} ms, "
            f"the longest pause {1000 * max(pauses):.0f} ms",
        )


def pauses_between_states(probe: Probe) -> list[float]:
    """Listen without BEAT, and return the pauses before, between and after the STATEs [s]."""
    begin = probe.now
    received = probe.receive(LISTENING_TIME_S)
    times = [one.timestamp for one in received if isinstance(one.message, m.State)]
    edges = [begin, *times, begin + LISTENING_TIME_S]
    return [later - former for former, later in pairwise(edges)]


@HEARTBEAT.must
def emotion_shown(probe: Probe) -> str:
    """A commanded emotion is shown within 5 s, and the way there leads towards it."""
    probe.open_neutral_session()
    slowest = 0.0
    # Each limit from neutral: a robot may take its five seconds for that.
    for goal in ((1.0, -1.0), (0.0, 0.0), (-1.0, 1.0)):
        number = probe.express(*goal)
        begin = probe.now
        states = expect_emotion(probe, goal, f"EXPRESS {number}")
        for former, later in pairwise(states):
            before = emotion_distance(former, *goal)
            if emotion_distance(later, *goal) > before + EMOTION_TOLERANCE:
                raise CheckFailed(
                    f"a way towards {goal}",
                    f"({former.valence}, {former.arousal}), "
                    f"then ({later.valence}, {later.arousal})",
                )
        slowest = max(slowest, probe.now - begin)
    return f"after {slowest:.1f} s at most"


@HEARTBEAT.should
def emotion_rate_bounded(probe: Probe) -> None:
    """The emotion shown changes at a bounded rate: it does not jump, not even to neutral."""
    probe.open_session()
    for goal in ((0.9, 0.9), (-0.9, -0.9)):
        before = probe.beat("HELLO")
        allowed = MAX_JUMP * max(emotion_distance(before, *goal), 1.0)
        probe.express(*goal)
        begin = probe.now
        while probe.now < begin + WATCHED_S:
            after = probe.beat("EXPRESS")
            if emotion_distance(after, before.valence, before.arousal) > allowed:
                raise CheckFailed(
                    f"an emotion on its way from ({before.valence}, {before.arousal}) to {goal}",
                    f"({after.valence}, {after.arousal}) {1000 * (probe.now - begin):.0f} ms later",
                )
            probe.receive(WATCH_EVERY_S)
        if goal[0] > 0:
            expect_emotion(probe, goal, "EXPRESS")


@HEARTBEAT.should
def state_rate_bounded(probe: Probe) -> str:
    """Apart from the answers to BEAT, STATE comes no more often than every 50 ms."""
    probe.open_session()
    before = len(probe.log.states)
    probe.keep_alive(1.0)
    probe.receive(0)
    count = len(probe.log.states) - before
    if count > MAX_STATES_PER_SECOND:
        raise CheckFailed(
            f"at most {MAX_STATES_PER_SECOND:.0f} STATEs in 1 s with 20 BEATs", f"{count}"
        )
    return f"{count} STATEs for 20 BEATs"


@HEARTBEAT.should
def round_trip_short(probe: Probe) -> str:
    """The median time from BEAT to its STATE is at most 20 ms."""
    probe.open_session()
    times = []
    for _ in range(ROUND_TRIPS):
        begin = probe.now
        probe.beat("BEAT")
        times.append(probe.now - begin)
    middle = median(times)
    remark = f"{1000 * middle:.1f} ms in the median, {1000 * max(times):.1f} ms at most"
    if middle > MAX_MEDIAN_ROUND_TRIP_S:
        raise CheckFailed(f"a median of at most {1000 * MAX_MEDIAN_ROUND_TRIP_S:.0f} ms", remark)
    return remark
