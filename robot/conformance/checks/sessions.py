"""Checks of section 5: who is spoken to, and what is kept from one session to the next."""

from robot.conformance.check import Chapter
from robot.conformance.checks.strangers import see_gone
from robot.conformance.heard import Heard
from robot.conformance.probe import AT_ONCE, SHOWN_WITHIN, SLACK, Probe, told
from robot.conformance.verdicts import UnmetError
from robot.protocol import messages as m
from robot.protocol import timing
from robot.protocol.messages import CHARGING, STILL

SESSIONS = Chapter("Sessions", 5)

GREETINGS = 40
"""HELLOs in a row."""

GREETING_EVERY = 0.005
"""Time between two of them [s]; the answers take 4 ms each at 115200 baud."""

FELT = 0.15
"""An emotion that has come so far was not taken back."""


@SESSIONS.must
def greeting_answered(robot: Probe) -> None:
    """HELLO opens the session in its header and is answered by WELCOME, within 100 ms."""
    for _ in range(3):
        robot.fresh()
        robot.beat("HELLO and WELCOME")


@SESSIONS.must
def greeting_repeated(robot: Probe) -> None:
    """HELLO with the open session is a repeat: WELCOME comes again, and nothing is forgotten."""
    robot.fresh()
    first = robot.greet()
    number = robot.express(0.0, 0.0)
    count = robot.beat("WELCOME").beat
    second = robot.greet()
    state = robot.expect(m.State, "a repeated HELLO", timing.STATE_EVERY + SLACK)
    if state.beat != count:
        raise UnmetError(f"STATE(beat={count}) after a repeated HELLO", f"beat={state.beat}")
    taken = robot.beat("a repeated HELLO").taken
    if second.taken != number or taken != number:
        raise UnmetError(
            f"taken={number} in WELCOME and STATE after a repeated HELLO",
            f"{second.taken} in WELCOME, {taken} in STATE",
        )
    robot.greet()
    if (first.catalogue, first.joints) != (second.catalogue, second.joints):
        raise UnmetError(f"the same WELCOME, {first}", f"{second}")


@SESSIONS.must
def session_zero_refused(robot: Probe) -> None:
    """Session 0 is never opened, and nothing is done for it when no session is open."""
    robot.fresh()
    came = robot.reaction(robot.frame(m.Hello(2, robot.host), 0), after="HELLO in session 0")
    _only_gone(came, "no WELCOME in session 0")
    robot.say(m.Bye())
    robot.hear(AT_ONCE)
    for message in (m.Hello(2, robot.host), m.Beat(0x0707), m.Express(9, 0.5, 0.5)):
        robot.say(message, session=0)
        _only_gone(robot.hear(AT_ONCE), f"nothing but GONE to {message} in session 0")


@SESSIONS.must
def session_zero_changes_nothing(robot: Probe) -> None:
    """HELLO in session 0, of another host too, does nothing: no emotion, no number is lost."""
    robot.calm()
    before = robot.beat("HELLO").valence
    number = robot.express(0.8, 0.6)
    robot.say(m.Hello(timing.VERSION, robot.host ^ 0x40404040), session=0)
    after = "EXPRESS and HELLO of another host in session 0"
    states = robot.live(SHOWN_WITHIN, lambda state: state.valence > before + FELT)
    if states[-1].valence <= before + FELT:
        raise UnmetError(f"valence on its way to 0.8 after {after}", f"{states[-1].valence}")
    if states[-1].taken != number:
        raise UnmetError(f"STATE(taken={number}) after {after}", f"taken={states[-1].taken}")
    _taken(robot, robot.again(), number, number, after)


@SESSIONS.must
def highest_numbers_accepted(robot: Probe) -> None:
    """Sessions up to 65535 and hosts up to 4294967295 are as good as any."""
    robot.fresh()
    session, host = robot.session, robot.host
    for robot.session, robot.host in ((0xFFFF, 0xFFFFFFFF), (0x8000, 0x80000000), (1, 1)):
        robot.greet()
        robot.beat(f"HELLO in session {robot.session}, host {robot.host}")
    robot.session, robot.host = session, host


@SESSIONS.must
def newest_session_wins(robot: Probe) -> None:
    """HELLO with another session opens that one; the one before is gone."""
    robot.fresh()
    before = robot.session
    robot.again()
    robot.beat("a second session")
    robot.say(m.Beat(7), session=before)
    see_gone(robot, before, "BEAT in the session before")
    robot.beat("that")


@SESSIONS.must
def many_greetings_survived(robot: Probe) -> None:
    """After 40 sessions that began within 200 ms the last one is open."""
    robot.fresh()
    for _ in range(GREETINGS):
        robot.next_session()
        robot.say(m.Hello(timing.VERSION, robot.host))
        robot.hear(GREETING_EVERY)
    robot.hear(AT_ONCE)
    robot.beat(f"{GREETINGS} HELLOs")


@SESSIONS.must
def another_host_begins_anew(robot: Probe) -> None:
    """For another host than before, the number of the last command is forgotten."""
    robot.fresh()
    for _ in range(3):
        robot.express(0.0, 0.0)
    welcome = robot.fresh()
    _taken(robot, welcome, 0, 0, "HELLO of another host")
    robot.express(0.0, 0.0)
    taken = robot.beat("EXPRESS 1 of another host").taken
    if taken != 1:
        raise UnmetError("STATE(taken=1) after EXPRESS 1 of another host", f"taken={taken}")


@SESSIONS.must
def another_host_in_the_same_session(robot: Probe) -> None:
    """Another host may have chosen the same session: it begins anew all the same."""
    robot.fresh()
    robot.express(0.0, 0.0)
    robot.next_host()
    welcome = robot.greet()
    _taken(robot, welcome, 0, 0, "HELLO of another host in the same session")


@SESSIONS.must
def same_host_continues(robot: Probe) -> None:
    """A new session of the same host keeps what was commanded; WELCOME says its number."""
    robot.fresh()
    robot.express(0.0, 0.0)
    number = robot.express(0.3, 0.3)
    welcome = robot.again()
    _taken(robot, welcome, number, number, "another session of the same host")


@SESSIONS.must
def version_agreed(robot: Probe) -> str:
    """WELCOME names the highest version that both speak: never above the one offered."""
    most = robot.fresh(offer=255).version
    for offer in (1, 2, most):
        version = robot.fresh(offer).version
        if version != min(offer, most):
            raise UnmetError(
                f"WELCOME(version={min(offer, most)}) after HELLO (version {offer}), "
                f"as it answers HELLO (version 255) by {most}",
                f"version={version}",
            )
        robot.beat(f"HELLO (version {offer})")
        again = robot.greet(offer=1).version
        if again != 1:
            raise UnmetError("WELCOME(version=1) when HELLO is repeated with it", f"{again}")
    return f"it speaks version {most}"


@SESSIONS.must
def version_1_spoken(robot: Probe) -> None:
    """In a session of version 1 the robot sends nothing that later versions added."""
    robot.fresh(offer=1)
    number = robot.next_number()
    robot.command(m.Express(number, 0.0, 0.0))
    for state in robot.live(0.2):
        later = state.flags & ~(CHARGING | STILL)
        if later:
            raise UnmetError("STATE with flags 0 and 1 alone in version 1", f"flags={state.flags}")


def _taken(robot: Probe, welcome: m.Welcome, in_force: int, last: int, after: str) -> None:
    """See what a robot says that it has taken."""
    state = robot.beat(after)
    if (welcome.taken, state.taken) != (in_force, last):
        raise UnmetError(
            f"WELCOME(taken={in_force}) and STATE(taken={last}) after {after}",
            f"WELCOME(taken={welcome.taken}) and STATE(taken={state.taken})",
        )


def _only_gone(came: list[Heard], expected: str) -> None:
    others = [heard for heard in came if not isinstance(heard.message, m.Gone | m.State)]
    others += [heard for heard in came if isinstance(heard.message, m.State) and not heard.session]
    if others:
        raise UnmetError(expected, told(others))
