"""Checks of section 7: the robot is heard regularly, and what it says of itself is true."""

from functools import partial
from itertools import pairwise
from statistics import median

from robot.conformance.check import Chapter
from robot.conformance.probe import SHOWN_WITHIN, SLACK, Probe
from robot.conformance.verdicts import UnmetError
from robot.protocol import messages as m
from robot.protocol import timing

HEARTBEAT = Chapter("Heartbeat and state", 7)

SHOWN = 0.02
"""How close the emotion shown comes to the one asked for."""

ROUND_TRIPS = 30
"""BEATs by which the round trip is measured."""

ROUND_TRIP = 0.020
"""A good robot's median round trip [s]."""

SILENCE = 0.35
"""How long a robot is listened to that should send STATE by itself [s]; the failsafe is later."""

STATES_A_SECOND = 40.0
"""STATEs that a good robot sends at most: one for each BEAT, and as many again."""


@HEARTBEAT.must
def beat_answered(robot: Probe) -> None:
    """BEAT is answered by STATE with its count, within 100 ms, whatever the count is."""
    robot.fresh()
    for count in (1, 0, 65535, 256, 0):
        robot.say(m.Beat(count))
        robot.expect(m.State, f"BEAT({count})", beat=count)


@HEARTBEAT.must
def beat_forgotten_in_a_new_session(robot: Probe) -> None:
    """Before the first BEAT of a session, STATE says 0 for its count."""
    robot.fresh()
    robot.beat("HELLO")
    robot.again()
    state = robot.expect(m.State, "HELLO of another session", timing.STATE_EVERY + SLACK)
    if state.beat:
        raise UnmetError("STATE(beat=0) before the first BEAT of a session", f"beat={state.beat}")


@HEARTBEAT.must
def state_by_itself(robot: Probe) -> None:
    """When no BEAT comes, STATE comes every 100 ms."""
    robot.fresh()
    begin = robot.now
    heard = [one.at for one in robot.hear(SILENCE) if isinstance(one.message, m.State)]
    longest = max(later - former for former, later in pairwise([begin, *heard, begin + SILENCE]))
    if longest > timing.STATE_EVERY + SLACK:
        raise UnmetError(
            f"STATE every {1000 * timing.STATE_EVERY:.0f} ms after WELCOME",
            f"{len(heard)} in {1000 * SILENCE:.0f} ms, the longest pause {1000 * longest:.0f} ms",
        )


@HEARTBEAT.must
def emotion_shown(robot: Probe) -> str:
    """An emotion that is asked for is shown within 5 s, and the way there leads towards it."""
    robot.fresh()
    slowest = 0.0
    for valence, arousal in ((0.8, 0.6), (-0.4, -0.2), (0.0, 0.0)):
        number = robot.express(valence, arousal)
        begin = robot.now
        way = robot.live(SHOWN_WITHIN, partial(_shows, goal=(valence, arousal)))
        last = way[-1]
        if _far(last, (valence, arousal)) >= SHOWN:
            raise UnmetError(
                f"({valence}, {arousal}) shown within {SHOWN_WITHIN:.0f} s after EXPRESS {number}",
                f"({last.valence}, {last.arousal})",
            )
        for former, later in pairwise(way):
            if _far(later, (valence, arousal)) > _far(former, (valence, arousal)) + SHOWN:
                raise UnmetError(
                    f"a way towards ({valence}, {arousal})",
                    f"({former.valence}, {former.arousal}), "
                    f"then ({later.valence}, {later.arousal})",
                )
        slowest = max(slowest, robot.now - begin)
    return f"after {slowest:.1f} s at most"


@HEARTBEAT.should
def emotion_takes_time(robot: Probe) -> None:
    """An emotion is shown at a bounded rate: a robot that jumps tells what it was told."""
    robot.fresh()
    before = robot.beat("HELLO")
    goal = (-0.9, -0.9) if before.valence > 0 else (0.9, 0.9)
    robot.express(*goal)
    after = robot.beat("EXPRESS")
    if _far(after, goal) < SHOWN:
        raise UnmetError(
            f"an emotion on its way from ({before.valence}, {before.arousal}) to {goal}",
            "one that is there at once",
        )


@HEARTBEAT.should
def not_too_talkative(robot: Probe) -> str:
    """Apart from the answers to BEAT, STATE comes no more often than every 50 ms."""
    robot.fresh()
    before = len(robot.log.states)
    robot.live(1.0)
    robot.hear(0)
    count = len(robot.log.states) - before
    if count > STATES_A_SECOND:
        raise UnmetError(f"at most {STATES_A_SECOND:.0f} STATEs in 1 s with 20 BEATs", f"{count}")
    return f"{count} STATEs for 20 BEATs"


@HEARTBEAT.should
def round_trip_short(robot: Probe) -> str:
    """From BEAT to its STATE it takes 20 ms at most, in the median."""
    robot.fresh()
    times = []
    for _ in range(ROUND_TRIPS):
        begin = robot.now
        robot.beat("BEAT")
        times.append(robot.now - begin)
    middle = median(times)
    remark = f"{1000 * middle:.1f} ms in the median, {1000 * max(times):.1f} ms at most"
    if middle > ROUND_TRIP:
        raise UnmetError(f"a median of at most {1000 * ROUND_TRIP:.0f} ms", remark)
    return remark


def _far(state: m.State, goal: tuple[float, float]) -> float:
    return max(abs(state.valence - goal[0]), abs(state.arousal - goal[1]))


def _shows(state: m.State, goal: tuple[float, float]) -> bool:
    return _far(state, goal) < SHOWN
