"""Checks of section 5: what is not of the open session."""

from robot.conformance.check import Chapter
from robot.conformance.heard import Heard
from robot.conformance.probe import AT_ONCE, SLACK, Probe, told
from robot.conformance.verdicts import UnmetError
from robot.protocol import messages as m
from robot.protocol import timing
from robot.protocol.schema import spec_of

OTHERS = Chapter("What is not of the session", 5)

QUIET = 0.4
"""How long a robot without a session is listened to [s]."""

STRANGERS = 240
"""Frames of foreign sessions in a row."""

STRANGERS_AT_ONCE = 4
"""So many of them go in one write."""

STRANGERS_EVERY = 0.005
"""Time between two such writes [s]: about what a line of 115200 baud needs for one."""

_FOREIGN = (
    m.Ask(m.ITEM_JOINT, 0),
    m.Beat(7),
    m.Express(1, 0.5, 0.5),
    m.Play(1, m.ITEM_MOTION, 0),
    m.Stop(1),
    m.Bye(),
)


@OTHERS.must
def foreign_session_told(robot: Probe) -> None:
    """Whatever is not of the open session is answered by GONE in the session of that message."""
    robot.fresh()
    for message in _FOREIGN:
        foreign = robot.session ^ 0x1111
        robot.hear(2 * timing.GONE_EVERY)
        robot.say(message, session=foreign)
        name = spec_of(type(message)).name
        see_gone(robot, foreign, f"{name} in another session")
        taken = robot.beat(f"{name} in another session").taken
        if taken:
            raise UnmetError(f"STATE(taken=0) after {name} in another session", f"taken={taken}")


@OTHERS.must
def gone_without_session(robot: Probe) -> None:
    """A robot without a session answers every message but HELLO by GONE."""
    robot.fresh()
    robot.say(m.Bye())
    robot.hear(AT_ONCE)
    for message in _FOREIGN:
        robot.hear(2 * timing.GONE_EVERY)
        robot.say(message)
        see_gone(robot, robot.session, f"{spec_of(type(message)).name} after BYE")


@OTHERS.must
def gone_not_too_often(robot: Probe) -> None:
    """GONE is sent at most every 20 ms."""
    robot.fresh()
    frame = robot.frame(m.Beat(7), robot.session ^ 0x1111)
    robot.hear(2 * timing.GONE_EVERY)
    begin = robot.now
    gone: list[Heard] = []
    for _ in range(STRANGERS // STRANGERS_AT_ONCE):
        robot.send(frame * STRANGERS_AT_ONCE)
        gone += _gones(robot.hear(STRANGERS_EVERY))
    gone += _gones(robot.hear(AT_ONCE))
    if not gone:
        raise UnmetError(f"GONE after {STRANGERS} BEATs of another session", "none")
    most = (gone[-1].at - begin + SLACK) / timing.GONE_EVERY + 2
    if len(gone) > most:
        raise UnmetError(
            f"at most {most:.0f} GONEs in {1000 * (gone[-1].at - begin):.0f} ms, "
            f"after {STRANGERS} BEATs of another session",
            f"{len(gone)}",
        )


@OTHERS.must
def silent_without_session(robot: Probe) -> None:
    """A robot without a session sends nothing before it is asked; BYE has no answer."""
    robot.fresh()
    robot.live(0.1)
    came = robot.hear(0)
    robot.say(m.Bye())
    robot.hear(SLACK)  # what was on its way
    came = robot.hear(QUIET)
    if came:
        raise UnmetError(f"silence for {1000 * QUIET:.0f} ms after BYE", told(came))


def see_gone(robot: Probe, session: int, after: str) -> None:
    """See that a session is said to be gone."""
    found, before = robot.wait_for(
        lambda heard: isinstance(heard.message, m.Gone) and heard.session == session, AT_ONCE
    )
    if found is None:
        raise UnmetError(
            f"GONE in session {session} within {1000 * AT_ONCE:.0f} ms after {after}", told(before)
        )


def _gones(heard: list[Heard]) -> list[Heard]:
    return [one for one in heard if isinstance(one.message, m.Gone)]
