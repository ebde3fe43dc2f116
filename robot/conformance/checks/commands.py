"""Checks of section 6: commands are acknowledged, and take effect exactly once."""

from collections.abc import Iterator
from dataclasses import replace

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.checks.failsafe import SILENCE_S
from cubeling.robot.conformance.checks.ways import FAR_RAD
from cubeling.robot.conformance.errors import CheckFailed, NotApplicableError
from cubeling.robot.conformance.exchange import REPLY_WITHIN_S
from cubeling.robot.conformance.probe import EFFECT_WITHIN_S, EMOTION_CHANGE, Probe
from cubeling.robot.protocol import messages as m, timing

COMMANDS = CheckGroup("Commands", 6)


@COMMANDS.must
def command_acknowledged(probe: Probe) -> None:
    """EXPRESS, PLAY and STOP are each answered by ACK with their number, within 100 ms."""
    probe.open_session()
    probe.express(0.0, 0.0)
    probe.next_number()
    probe.send(m.Play(2, m.ITEM_MOTION, 254))
    probe.expect(m.Ack, "PLAY 2", number=2)
    probe.next_number()
    probe.command(m.Stop(3))


@COMMANDS.must
def taken_reported(probe: Probe) -> None:
    """STATE names the last command taken: 0 before the first, then the highest number."""
    probe.open_session()
    probe.expect_taken(0, "HELLO of a new host")
    for _ in range(3):
        number = probe.express(0.0, 0.0)
        probe.expect_taken(number, f"EXPRESS {number}")
    probe.command(m.Stop(100))
    probe.expect_taken(100, "STOP 100")


@COMMANDS.must
def repeat_acknowledged(probe: Probe) -> None:
    """A repeated or older command is answered by ACK too, with the result of the last one taken."""
    motions = probe.open_session().motions
    refused = m.Play(6, m.ITEM_MOTION, motions)
    for last, result in (
        (m.Express(5, 0.0, 0.0), m.RESULT_TAKEN), (refused, m.RESULT_REFUSED)
    ):  # fmt: skip
        probe.command(last, result)
        for number in (last.number, last.number, 4, 1):
            after = f"EXPRESS {number}, with {last.number} taken before"
            probe.send(m.Express(number, 0.0, 0.0))
            probe.expect(m.Ack, after, number=number, result=result)
            probe.expect_taken(last.number, after)


@COMMANDS.must
def repeat_without_effect(probe: Probe) -> None:
    """A command whose number is not above the last one's has no effect."""
    probe.open_neutral_session()
    before = probe.beat("HELLO").valence
    probe.command(m.Express(5, 0.8, 0.6))
    for number in (5, 4):
        probe.send(m.Express(number, -0.8, -0.6))
        probe.send(m.Stop(number))
    after = probe.keep_alive(EFFECT_WITHIN_S)[-1]
    if after.flags & m.FLAG_STILL:
        raise CheckFailed("no effect of STOP 4 after EXPRESS 5", f"STATE(flags={after.flags})")
    if after.valence <= before:
        raise CheckFailed(
            "a rising valence after EXPRESS 5 (valence 0.8) and a repeat with valence -0.8",
            f"from {before} to {after.valence} within {1000 * EFFECT_WITHIN_S:.0f} ms",
        )


@COMMANDS.must
def numbers_compared_unsigned(probe: Probe) -> None:
    """Numbers of commands go up to 4294967295, and gaps between them are allowed."""
    probe.open_session()
    for number in (1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF):
        probe.command(m.Express(number, 0.0, 0.0))
        probe.expect_taken(number, f"EXPRESS {number}")
    probe.send(m.Express(7, 0.0, 0.0))
    probe.expect(m.Ack, "EXPRESS 7 after EXPRESS 4294967295", number=7)
    probe.expect_taken(0xFFFFFFFF, "EXPRESS 7 after EXPRESS 4294967295")


@COMMANDS.must
def latest_wins(probe: Probe) -> None:
    """Of two commands in one write both are acknowledged, and the later one is in force."""
    probe.open_neutral_session()
    before = probe.beat("HELLO").valence
    probe.send(m.Express(1, 0.8, 0.0), m.Express(2, -0.8, 0.0))
    for number in (1, 2):
        probe.expect(m.Ack, "EXPRESS 1 and 2 in one write", number=number, result=m.RESULT_TAKEN)
    states = probe.keep_alive(1.0, lambda state: abs(state.valence - before) > EMOTION_CHANGE)
    if states[-1].valence >= before:
        raise CheckFailed(
            "valence going to -0.8, commanded by EXPRESS 2, not to 0.8, commanded by EXPRESS 1",
            f"from {before} to {states[-1].valence}",
        )


@COMMANDS.must_of(5)
def answered_in_order(probe: Probe) -> None:
    """Messages in one write are answered in their order."""
    probe.open_session()
    first, second = probe.next_number(), probe.next_number()
    before, after = probe.next_beat(), probe.next_beat()
    probe.send(
        m.Express(first, 0.0, 0.0),
        m.Beat(before),
        m.Ask(m.ITEM_MOTION, 255),
        m.Express(second, 0.0, 0.0),
        m.Hello(timing.VERSION, probe.host),
        m.Beat(after),
    )
    answers: list[object] = []
    for one in probe.receive(REPLY_WITHIN_S):
        match one.message:
            case m.Ack(number=number):
                answers.append(("ACK", number))
            case m.State(beat=beat) if beat and ("STATE", beat) not in answers:
                answers.append(("STATE", beat))
            case m.Welcome():
                answers.append(("WELCOME", probe.session))
    wanted = [
        ("ACK", first), ("STATE", before), ("ACK", second), ("WELCOME", probe.session),
        ("STATE", after),
    ]  # fmt: skip
    if answers != wanted:
        words = " ".join(f"{name}({value})" for name, value in wanted)
        raise CheckFailed(words, f"{answers}")


@COMMANDS.must
def never_refused(probe: Probe) -> None:
    """EXPRESS and STOP are taken whatever the robot is doing, also while it is stopped."""
    welcome = probe.open_session()
    for _ in range(2):
        for item, count in ((m.ITEM_MOTION, welcome.motions), (m.ITEM_SOUND, welcome.sounds)):
            if count:
                probe.send(m.Play(probe.next_number(), item, count - 1))
        if probe.takes_move and welcome.joints:
            angles = probe.beat("HELLO").joints
            probe.send(m.Move(probe.next_number(), 1.0, 0, 1, angles))
        probe.express(0.0, 0.0)
        probe.command(m.Stop(probe.next_number()))
        probe.command(m.Stop(probe.next_number()))
        probe.express(0.0, 0.0)


@COMMANDS.must
def unknown_index_refused(probe: Probe) -> None:
    """PLAY with an index that the catalogue does not have gets ACK with result 1, and is taken."""
    welcome = probe.open_session()
    for item, count in ((m.ITEM_MOTION, welcome.motions), (m.ITEM_SOUND, welcome.sounds)):
        for index in {count, 255}:
            number = probe.command(m.Play(probe.next_number(), item, index), m.RESULT_REFUSED)
            probe.expect_taken(number, f"PLAY {number} with index {index}")


@COMMANDS.must
def unknown_mood_refused(probe: Probe) -> None:
    """EXPRESS with a mood that the catalogue does not have gets ACK with result 1, and is taken."""
    if probe.open_session().version < 2:
        raise NotApplicableError("it speaks version 1")
    welcome = probe.open_neutral_session()
    before = probe.beat("HELLO").valence
    for mood in {welcome.moods, 254}:
        command = m.Express(probe.next_number(), 0.8, 0.0, mood)
        number = probe.command(command, m.RESULT_REFUSED)
        probe.expect_taken(number, f"EXPRESS {number} with mood {mood}")
    after = probe.keep_alive(EFFECT_WITHIN_S)[-1].valence
    if after > before + EMOTION_CHANGE:
        raise CheckFailed("no effect of a refused EXPRESS", f"valence from {before} to {after}")


@COMMANDS.must
def result_in_state(probe: Probe) -> None:
    """STATE says the result of the command taken last; 0 after HELLO of another host.

    Its own host may begin another session, end it or be silent: the result stays.
    """
    welcome = probe.open_session()
    if probe.version < 3:
        raise NotApplicableError("it speaks an earlier version")
    refused = m.Play(probe.next_number(), m.ITEM_MOTION, welcome.motions)
    for command, result in ((refused, m.RESULT_REFUSED), (None, m.RESULT_TAKEN)):
        if command is None:
            probe.express(0.0, 0.0)
        else:
            probe.command(command, result)
        _expect_result(probe, result, f"a command with result {result}")
    probe.command(replace(refused, number=probe.next_number()), m.RESULT_REFUSED)
    for end in ("another HELLO", "BYE", "the failsafe"):
        if end == "BYE":
            probe.send(m.Bye())
        elif end == "the failsafe":
            probe.receive(SILENCE_S)
        probe.reopen_session()
        _expect_result(probe, m.RESULT_REFUSED, f"a refused command and {end}")
    probe.open_session()
    _expect_result(probe, m.RESULT_TAKEN, "HELLO of another host")


@COMMANDS.must_of(5)
def refusal_in_earlier_versions(probe: Probe) -> None:
    """In a session of version 1 or 2 every refusal is 1, whatever its reason."""
    if probe.open_session().version < 3:
        raise NotApplicableError("it speaks an earlier version")
    for offer in (1, 2):
        probe.open_session(offer)
        # Every joint far beyond its limits; a robot without MOVE refuses that too.
        beyond = m.Move(probe.next_number(), 0.0, 0, 1, (32.767,) * m.JOINTS_MAX)
        probe.command(beyond, m.RESULT_REFUSED)


@COMMANDS.must
def refusal_changes_nothing(probe: Probe) -> None:
    """A refused command changes nothing: a stopped robot stays so. Its repeats are refused too."""
    probe.open_session()
    probe.command(m.Stop(probe.next_number()))
    for command, result in refused_commands(probe):
        probe.command(command, result)
        probe.command(command, result)
    flags = probe.keep_alive(EFFECT_WITHIN_S)[-1].flags
    if not flags & m.FLAG_STILL:
        raise CheckFailed("flag 1 after STOP and refused commands", f"flags={flags}")


def refused_commands(probe: Probe) -> Iterator[tuple[m.Command, int]]:
    """Yield commands that every robot refuses, each with its number, and their results."""
    welcome = probe.welcome
    assert welcome is not None
    if probe.version >= 2:
        for mood in (welcome.moods, m.NOTHING - 1):
            yield m.Express(probe.next_number(), -0.5, 0.5, mood), m.RESULT_REFUSED
    for item, count in ((m.ITEM_MOTION, welcome.motions), (m.ITEM_SOUND, welcome.sounds)):
        yield m.Play(probe.next_number(), item, count), m.RESULT_REFUSED
    if not probe.takes_move:
        return
    known = (1 << welcome.joints) - 1
    angles = probe.beat("HELLO").joints
    if welcome.joints < m.JOINTS_MAX:
        for released, moved in ((known, 1 << 15), (known | 1 << 15, known)):
            command = m.Move(probe.next_number(), 1.0, released, moved, angles)
            yield command, m.RESULT_REFUSED
    if welcome.joints:
        beyond = (*angles[: welcome.joints - 1], FAR_RAD) + (0.0,) * m.JOINTS_MAX
        far = m.Move(probe.next_number(), 1.0, known, known, beyond[: m.JOINTS_MAX])
        yield far, m.RESULT_OUT_OF_RANGE


def _expect_result(probe: Probe, result: int, after: str) -> None:
    state = probe.beat(after)
    if state.result != result:
        raise CheckFailed(f"STATE(result={result}) after {after}", f"result={state.result}")
