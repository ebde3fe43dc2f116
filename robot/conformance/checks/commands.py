"""Checks of section 6: commands are acknowledged, and take effect exactly once."""

from robot.conformance.check import Chapter
from robot.conformance.probe import ACTS_WITHIN, Probe
from robot.conformance.verdicts import NotApplicableError, UnmetError
from robot.protocol import messages as m

COMMANDS = Chapter("Commands", 6)

RISE = 0.05
"""A change of the emotion shown that is no chance."""


@COMMANDS.must
def command_acknowledged(robot: Probe) -> None:
    """EXPRESS, PLAY and STOP are each answered by ACK with their number, within 100 ms."""
    robot.fresh()
    robot.express(0.0, 0.0)
    robot.next_number()
    robot.say(m.Play(2, m.ITEM_MOTION, 254))
    robot.expect(m.Ack, "PLAY 2", number=2)
    robot.next_number()
    robot.command(m.Stop(3))


@COMMANDS.must
def taken_reported(robot: Probe) -> None:
    """STATE names the last command taken: 0 before the first, then the highest number."""
    robot.fresh()
    _sees(robot, "HELLO of a new host", taken=0)
    for _ in range(3):
        number = robot.express(0.0, 0.0)
        _sees(robot, f"EXPRESS {number}", taken=number)
    robot.command(m.Stop(100))
    _sees(robot, "STOP 100", taken=100)


@COMMANDS.must
def repeat_acknowledged(robot: Probe) -> None:
    """A command that has come before, or an older one, is answered by ACK all the same."""
    robot.fresh()
    robot.command(m.Express(5, 0.0, 0.0))
    for number in (5, 5, 4, 1):
        robot.say(m.Express(number, 0.0, 0.0))
        robot.expect(m.Ack, f"EXPRESS {number}, with 5 taken before", number=number)
        _sees(robot, f"EXPRESS {number}, with 5 taken before", taken=5)


@COMMANDS.must
def repeat_without_effect(robot: Probe) -> None:
    """A command whose number is not above the last one's has no effect."""
    robot.calm()
    before = robot.beat("HELLO").valence
    robot.command(m.Express(5, 0.8, 0.6))
    for number in (5, 4):
        robot.say(m.Express(number, -0.8, -0.6))
        robot.say(m.Stop(number))
    after = robot.live(ACTS_WITHIN)[-1]
    if after.flags & m.STILL:
        raise UnmetError("no effect of STOP 4 after EXPRESS 5", f"STATE(flags={after.flags})")
    if after.valence <= before:
        raise UnmetError(
            "valence going up after EXPRESS 5 (valence 0.8) and a repeat with valence -0.8",
            f"from {before} to {after.valence} within {1000 * ACTS_WITHIN:.0f} ms",
        )


@COMMANDS.must
def numbers_compared_unsigned(robot: Probe) -> None:
    """Numbers of commands go up to 4294967295, and gaps between them do no harm."""
    robot.fresh()
    for number in (1, 0x7FFFFFFF, 0x80000000, 0xFFFFFFFF):
        robot.command(m.Express(number, 0.0, 0.0))
        _sees(robot, f"EXPRESS {number}", taken=number)
    robot.say(m.Express(7, 0.0, 0.0))
    robot.expect(m.Ack, "EXPRESS 7 after EXPRESS 4294967295", number=7)
    _sees(robot, "EXPRESS 7 after EXPRESS 4294967295", taken=0xFFFFFFFF)


@COMMANDS.must
def latest_wins(robot: Probe) -> None:
    """Of two commands in one go both are acknowledged, and the later one holds."""
    robot.calm()
    before = robot.beat("HELLO").valence
    robot.say(m.Express(1, 0.8, 0.0), m.Express(2, -0.8, 0.0))
    for number in (1, 2):
        robot.expect(m.Ack, "EXPRESS 1 and 2 in one go", number=number, result=m.TAKEN)
    states = robot.live(1.0, lambda state: abs(state.valence - before) > RISE)
    if states[-1].valence >= before:
        raise UnmetError(
            "valence going to -0.8, asked for by EXPRESS 2, and not to 0.8, asked for by EXPRESS 1",
            f"from {before} to {states[-1].valence}",
        )


@COMMANDS.must
def unknown_index_refused(robot: Probe) -> None:
    """PLAY with an index that the catalogue does not have gets ACK with result 1, and is taken."""
    welcome = robot.fresh()
    for item, count in ((m.ITEM_MOTION, welcome.motions), (m.ITEM_SOUND, welcome.sounds)):
        for index in {count, 255}:
            number = robot.command(m.Play(robot.next_number(), item, index), m.UNKNOWN)
            _sees(robot, f"PLAY {number} with index {index}", taken=number)


@COMMANDS.must
def unknown_mood_refused(robot: Probe) -> None:
    """EXPRESS with a mood that the catalogue does not have gets ACK with result 1, and is taken."""
    if robot.fresh().version < 2:
        raise NotApplicableError("it speaks version 1")
    welcome = robot.calm()
    before = robot.beat("HELLO").valence
    for mood in {welcome.moods, 254}:
        command = m.Express(robot.next_number(), 0.8, 0.0, mood)
        number = robot.command(command, m.UNKNOWN)
        _sees(robot, f"EXPRESS {number} with mood {mood}", taken=number)
    after = robot.live(ACTS_WITHIN)[-1].valence
    if after > before + RISE:
        raise UnmetError(
            "no effect of an EXPRESS that was refused", f"valence from {before} to {after}"
        )


@COMMANDS.must
def refusal_changes_nothing(robot: Probe) -> None:
    """A refused command changes nothing: who is stopped stays so. Its repeats are refused too."""
    welcome = robot.fresh()
    robot.command(m.Stop(robot.next_number()))
    commands: list[m.Play | m.Express] = [
        m.Play(robot.next_number(), m.ITEM_MOTION, welcome.motions),
        m.Play(robot.next_number(), m.ITEM_SOUND, welcome.sounds),
    ]
    if robot.version >= 2:
        commands.append(m.Express(robot.next_number(), 0.5, 0.5, m.NOTHING - 1))
    for command in commands:
        robot.command(command, m.UNKNOWN)
        robot.command(command, m.UNKNOWN)
    flags = robot.live(ACTS_WITHIN)[-1].flags
    if not flags & m.STILL:
        raise UnmetError("flag 1 after STOP and commands that are refused", f"flags={flags}")


def _sees(robot: Probe, after: str, taken: int) -> None:
    state = robot.beat(after)
    if state.taken != taken:
        raise UnmetError(f"STATE(taken={taken}) after {after}", f"taken={state.taken}")
