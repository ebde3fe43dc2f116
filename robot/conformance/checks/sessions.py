"""Checks of section 5: how sessions begin, and what is kept from one to the next."""

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.checks.moods import last_mood
from cubeling.robot.conformance.errors import CheckFailed, NotApplicableError
from cubeling.robot.conformance.exchange import REPLY_WITHIN_S
from cubeling.robot.conformance.probe import (
    EFFECT_WITHIN_S,
    EMOTION_CHANGE,
    EMOTION_WITHIN_S,
    TIMING_SLACK_S,
    Probe,
)
from cubeling.robot.conformance.received import ReceivedFrame, describe_frames
from cubeling.robot.protocol import messages as m, timing

SESSIONS = CheckGroup("Sessions", 5)

HELLO_COUNT = 40
"""HELLOs in a row."""

HELLO_EVERY_S = 0.005
"""Time between two of them [s]; the answers take 4 ms each at 115200 baud."""

MIN_VALENCE_RISE = 0.15
"""Rise of the valence after which the emotion was not taken back."""


@SESSIONS.must
def hello_answered(probe: Probe) -> None:
    """HELLO opens the session in its header and is answered by WELCOME, within 100 ms."""
    for _ in range(3):
        probe.open_session()
        probe.beat("HELLO and WELCOME")


@SESSIONS.must
def hello_repeated(probe: Probe) -> None:
    """HELLO with the open session is a repeat: WELCOME comes again, and nothing is forgotten."""
    probe.open_session()
    first = probe.hello()
    number = probe.express(0.0, 0.0)
    count = probe.beat("WELCOME").beat
    second = probe.hello()
    state = probe.expect(m.State, "a repeated HELLO", timing.STATE_EVERY + TIMING_SLACK_S)
    if state.beat != count:
        raise CheckFailed(f"STATE(beat={count}) after a repeated HELLO", f"beat={state.beat}")
    _expect_taken(probe, second, number, number, "a repeated HELLO")
    probe.hello()
    if (first.catalogue, first.joints) != (second.catalogue, second.joints):
        raise CheckFailed(f"the same WELCOME, {first}", f"{second}")


@SESSIONS.must
def session_zero_refused(probe: Probe) -> None:
    """Session 0 is never opened, and messages in it have no effect when no session is open."""
    probe.open_session()
    hello = m.Hello(2, probe.host)
    probe.expect_no_reply(probe.frame(hello, 0), "HELLO in session 0")
    probe.send(m.Bye())
    probe.receive(REPLY_WITHIN_S)
    for message in (m.Beat(0x0707), m.Express(9, 0.5, 0.5)):
        probe.send(message, session=0)
        received = probe.receive(REPLY_WITHIN_S)
        _expect_only_gone(received, f"nothing but GONE to {message} in session 0")
    probe.send(hello, session=0)
    received = probe.receive(REPLY_WITHIN_S)
    if received:
        raise CheckFailed("no answer to HELLO in session 0", describe_frames(received))


@SESSIONS.must
def session_zero_changes_nothing(probe: Probe) -> None:
    """HELLO in session 0, also of another host, changes no emotion, number or version."""
    probe.open_neutral_session()
    state = probe.beat("HELLO")
    before, flags = state.valence, state.flags
    number = probe.express(0.8, 0.6)
    invalid = probe.log.violation_counts.get("frame", 0)
    probe.send(m.Hello(1, probe.host ^ 0x40404040), session=0)
    state = probe.beat("HELLO (version 1) in session 0")
    if state.flags != flags or probe.log.violation_counts.get("frame", 0) > invalid:
        expected = f"STATE(flags={flags}) of version {probe.version} after HELLO in session 0"
        raise CheckFailed(expected, f"flags={state.flags}, or one of version 1")
    after = "EXPRESS and HELLO of another host in session 0"
    states = probe.expect_state(
        lambda state: state.valence > before + MIN_VALENCE_RISE,
        EMOTION_WITHIN_S,
        f"valence on its way to 0.8 after {after}",
        "valence",
    )
    if states[-1].taken != number:
        raise CheckFailed(f"STATE(taken={number}) after {after}", f"taken={states[-1].taken}")
    _expect_taken(probe, probe.reopen_session(), number, number, after)


@SESSIONS.must
def highest_numbers_accepted(probe: Probe) -> None:
    """Sessions up to 65535 and hosts up to 4294967295 are accepted."""
    probe.open_session()
    session, host = probe.session, probe.host
    for probe.session, probe.host in (
        (0xFFFF, 0xFFFFFFFF), (0x8000, 0x80000000), (2, 0x01000001), (3, 0x00010001), (1, 1)
    ):  # fmt: skip
        words = f"HELLO in session {probe.session}, host {probe.host}"
        _expect_taken(probe, probe.hello(), 0, 0, words)
        probe.express(0.0, 0.0)
        probe.next_number()
    probe.session, probe.host = session, host


@SESSIONS.must
def newest_session_wins(probe: Probe) -> None:
    """HELLO with another session opens that one; the one before is gone."""
    probe.open_session()
    before = probe.session
    probe.reopen_session()
    probe.beat("a second session")
    probe.send(m.Beat(7), session=before)
    probe.expect(m.Gone, "BEAT in the session before", session=before)
    probe.beat("that")


@SESSIONS.must
def many_hellos_survived(probe: Probe) -> None:
    """After 40 sessions that began within 200 ms the last one is open."""
    probe.open_session()
    for _ in range(HELLO_COUNT):
        probe.next_session()
        probe.send(m.Hello(timing.VERSION, probe.host))
        probe.receive(HELLO_EVERY_S)
    probe.receive(REPLY_WITHIN_S)
    probe.beat(f"{HELLO_COUNT} HELLOs")


@SESSIONS.must
def another_host_starts_over(probe: Probe) -> None:
    """When another host says HELLO, the number of the last command is forgotten."""
    probe.open_session()
    for _ in range(3):
        probe.express(0.0, 0.0)
    welcome = probe.open_session()
    _expect_taken(probe, welcome, 0, 0, "HELLO of another host")
    probe.express(0.0, 0.0)
    probe.expect_taken(1, "EXPRESS 1 of another host")


@SESSIONS.must
def another_host_in_the_same_session(probe: Probe) -> None:
    """Another host may have chosen the same session number: it starts over all the same."""
    probe.open_session()
    probe.express(0.0, 0.0)
    probe.next_host()
    _expect_taken(probe, probe.hello(), 0, 0, "HELLO of another host in the same session")


@SESSIONS.must
def same_host_continues(probe: Probe) -> None:
    """A new session of the same host keeps the last command; WELCOME says its number."""
    probe.open_session()
    probe.express(0.0, 0.0)
    number = probe.express(0.3, 0.3)
    welcome = probe.reopen_session()
    _expect_taken(probe, welcome, number, number, "another session of the same host")


@SESSIONS.must
def hello_of_its_host_keeps_everything(probe: Probe) -> None:
    """HELLO of the same host, also a repeated one, keeps emotion, mood, held joints and stop."""
    for repeated in (True, False):
        welcome = probe.open_session()
        mood = last_mood(probe)
        if probe.takes_move and welcome.joints:
            angles = probe.beat("HELLO").joints
            probe.send(m.Move(probe.next_number(), 1.0, 0, 1, angles))
        probe.express(0.8, 0.6, mood)
        before = probe.keep_alive(EFFECT_WITHIN_S)[-1]
        after = "a repeated HELLO" if repeated else "the next HELLO of its host"
        _hello_again(probe, repeated)
        state = probe.keep_alive(EFFECT_WITHIN_S)[-1]
        for field in ("held",) if mood == m.NOTHING else ("held", "mood"):
            if getattr(state, field) != getattr(before, field):
                expected = f"STATE({field}={getattr(before, field)}) after {after}"
                raise CheckFailed(expected, f"{field}={getattr(state, field)}")
        if state.valence < before.valence - EMOTION_CHANGE:
            raise CheckFailed(f"a rising valence after {after}", f"{state.valence}")
        probe.command(m.Stop(probe.next_number()))
        _hello_again(probe, repeated)
        flags = probe.keep_alive(EFFECT_WITHIN_S)[-1].flags
        if not flags & m.FLAG_STILL:
            raise CheckFailed(f"flag 1 after STOP and {after}", f"flags={flags}")


@SESSIONS.must_of(6)
def stop_and_refusal_in_force(probe: Probe) -> None:
    """WELCOME names the last command taken, also if that was STOP or was refused."""
    motions = probe.open_session().motions
    number = probe.command(m.Stop(probe.next_number()))
    _expect_taken(probe, probe.reopen_session(), number, number, "STOP")
    refused = m.Play(probe.next_number(), m.ITEM_MOTION, motions)
    number = probe.command(refused, m.RESULT_REFUSED)
    _expect_taken(probe, probe.reopen_session(), number, number, "a refused PLAY")


@SESSIONS.must
def version_agreed(probe: Probe) -> str:
    """WELCOME names the highest version that both speak: never above the one offered."""
    highest = probe.open_session(offer=255).version
    for offer in (1, 2, 3, highest):
        version = probe.open_session(offer).version
        if version != min(offer, highest):
            raise CheckFailed(
                f"WELCOME(version={min(offer, highest)}) after HELLO (version {offer}), "
                f"as it answers HELLO (version 255) by {highest}",
                f"version={version}",
            )
        probe.beat(f"HELLO (version {offer})")
        version = probe.hello(offer=1).version
        if version != 1:
            raise CheckFailed("WELCOME(version=1) when HELLO is repeated with it", f"{version}")
    return f"it speaks version {highest}"


@SESSIONS.must
def earlier_versions_spoken(probe: Probe) -> None:
    """In a session of an earlier version the robot sends nothing that later versions added."""
    for offer in range(1, max(probe.open_session().version, 2)):
        before = probe.log.violation_counts.get("frame", 0)
        welcome = probe.open_session(offer)
        probe.express(0.0, 0.0)
        refused = m.Play(probe.next_number(), m.ITEM_MOTION, welcome.motions)
        probe.command(refused, m.RESULT_REFUSED)
        states = probe.keep_alive(2 * timing.LOG_EVERY)
        if probe.log.violation_counts.get("frame", 0) > before:
            example = probe.log.violations["frame"][-1]
            raise CheckFailed(f"only what version {offer} has", str(example))
        if offer == 1:
            _expect_version_1(states)


@SESSIONS.must
def version_of_the_last_hello(probe: Probe) -> None:
    """HELLO in the open session changes the version, down and up; STATE follows."""
    highest = probe.open_session().version
    if highest < 2:
        raise NotApplicableError("it speaks version 1")
    before = probe.beat("HELLO")
    for offer in (1, highest):
        version = probe.hello(offer=offer).version
        if version != offer:
            expected = f"WELCOME(version={offer}) when HELLO (version {offer}) is repeated"
            raise CheckFailed(expected, f"version={version}")
        state = probe.beat(f"a repeated HELLO (version {offer})")
        if offer == 1:
            _expect_version_1([state])
    if (state.flags ^ before.flags) & m.FLAG_RECKONED:
        raise CheckFailed(f"flags={before.flags} in version {highest} again", f"{state.flags}")


def _hello_again(probe: Probe, repeated: bool) -> None:
    """Send HELLO of the same host, in the open session or in another."""
    if repeated:
        probe.hello()
    else:
        probe.reopen_session()


def _expect_version_1(states: list[m.State]) -> None:
    for state in states:
        if state.flags & ~(m.FLAG_CHARGING | m.FLAG_STILL):
            raise CheckFailed("STATE with flags 0 and 1 alone in version 1", f"flags={state.flags}")


def _expect_taken(probe: Probe, welcome: m.Welcome, in_force: int, last: int, after: str) -> None:
    """Check the last command in WELCOME and in STATE."""
    state = probe.beat(after)
    if (welcome.taken, state.taken) != (in_force, last):
        raise CheckFailed(
            f"WELCOME(taken={in_force}) and STATE(taken={last}) after {after}",
            f"WELCOME(taken={welcome.taken}) and STATE(taken={state.taken})",
        )


def _expect_only_gone(received: list[ReceivedFrame], expected: str) -> None:
    others = [one for one in received if not isinstance(one.message, m.Gone | m.State)]
    others += [one for one in received if isinstance(one.message, m.State) and not one.session]
    if others:
        raise CheckFailed(expected, describe_frames(others))
