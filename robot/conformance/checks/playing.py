"""Checks of section 6: motions and sounds are played once, and side by side."""

from math import inf

from robot.conformance.check import Chapter
from robot.conformance.probe import ACTS_WITHIN, Probe
from robot.conformance.verdicts import NotApplicableError, UnmetError
from robot.protocol import messages as m
from robot.protocol import timing

PLAYING = Chapter("Motions and sounds", 6)

LONGEST_PIECE = 10.0
"""What is played longer than this does not seem to end [s]."""

LONG_ENOUGH = 3 * ACTS_WITHIN
"""What is played at least so long can be looked at while something else is commanded [s]."""

LOOK_EVERY = 0.010
"""Time between two looks [s]: more often than a host would, for a sound may be short."""

WORDS = {m.ITEM_MOTION: "motion", m.ITEM_SOUND: "sound"}


@PLAYING.must
def motion_played(robot: Probe) -> None:
    """STATE shows the motion of a PLAY within 250 ms."""
    _played(robot, m.ITEM_MOTION)


@PLAYING.must
def sound_played(robot: Probe) -> None:
    """STATE shows the sound of a PLAY within 250 ms."""
    _played(robot, m.ITEM_SOUND)


@PLAYING.should
def played_once(robot: Probe) -> str:
    """A motion or a sound is played once: it ends. What takes over 10 s does not seem to."""
    lengths = known_lengths(robot)
    for item, length in lengths.items():
        if length > LONGEST_PIECE:
            raise UnmetError(f"the end of a {WORDS[item]} within {LONGEST_PIECE:.0f} s", "none")
    return ", ".join(f"a {WORDS[item]} of {length:.1f} s" for item, length in lengths.items())


@PLAYING.must
def old_play_without_effect(robot: Probe) -> None:
    """A PLAY whose number is not above the last one's plays nothing, and nothing again."""
    lengths = known_lengths(robot)
    item = min(lengths, key=lambda one: lengths[one])
    robot.calm()
    state = robot.beat("HELLO")
    played = chosen(robot, state, item)
    first = m.Play(5, item, played)
    robot.command(first)
    for other in lengths:
        index = chosen(robot, state, other, but=played if other == item else m.NOTHING)
        if index != m.NOTHING:
            for number in (5, 4):
                robot.say(m.Play(number, other, index))
                robot.expect(m.Ack, f"PLAY {number}, with 5 taken before", number=number)
                _not_shown(robot, other, index, f"PLAY {number}, with 5 taken before")
    if lengths[item] > LONGEST_PIECE:
        return
    end = robot.now + lengths[item] + LONG_ENOUGH
    while shown(robot.beat("PLAY 5"), item) == played:  # every repeat might begin it again
        if robot.now > end:
            raise UnmetError(
                f"the end of {WORDS[item]} {played} after {lengths[item]:.1f} s, "
                "however often its PLAY is repeated",
                f"none after {lengths[item] + LONG_ENOUGH:.1f} s",
            )
        robot.say(first)
        robot.expect(m.Ack, "PLAY 5 again", number=5)
        robot.hear(LOOK_EVERY)
    robot.say(first)
    robot.expect(m.Ack, "PLAY 5 again", number=5)
    _not_shown(robot, item, played, "its end and a repeat of its PLAY")


@PLAYING.must
def motion_and_sound_together(robot: Probe) -> None:
    """Motion and sound do not end each other."""
    indices = lasting(robot, m.ITEM_MOTION, m.ITEM_SOUND)
    for first, second in ((m.ITEM_MOTION, m.ITEM_SOUND), (m.ITEM_SOUND, m.ITEM_MOTION)):
        play(robot, first, indices[first])
        see(robot, first, indices[first], "PLAY")
        play(robot, second, indices[second])
        state = see(robot, second, indices[second], "PLAY")
        if shown(state, first) != indices[first]:
            raise UnmetError(
                f"{WORDS[first]} {indices[first]} going on after PLAY of a {WORDS[second]}",
                f"{WORDS[first]}={shown(state, first)}",
            )


@PLAYING.must
def refused_play_ends_nothing(robot: Probe) -> None:
    """What is played goes on when a PLAY is refused."""
    index = lasting(robot, m.ITEM_MOTION)[m.ITEM_MOTION]
    play(robot, m.ITEM_MOTION, index)
    see(robot, m.ITEM_MOTION, index, "PLAY")
    robot.command(m.Play(robot.next_number(), m.ITEM_MOTION, m.NOTHING - 1), m.UNKNOWN)
    motion = robot.live(ACTS_WITHIN)[-1].motion
    if motion != index:
        raise UnmetError(f"motion {index} going on after a refused PLAY", f"motion={motion}")


@PLAYING.should
def motion_survives_an_emotion(robot: Probe) -> None:
    """EXPRESS ends no motion that is played: it comes too often."""
    index = lasting(robot, m.ITEM_MOTION)[m.ITEM_MOTION]
    play(robot, m.ITEM_MOTION, index)
    see(robot, m.ITEM_MOTION, index, "PLAY")
    robot.express(0.4, 0.4)
    motion = robot.live(ACTS_WITHIN)[-1].motion
    if motion != index:
        raise UnmetError(f"motion {index} going on after EXPRESS", f"motion={motion}")


def shown(state: m.State, item: int) -> int:
    """Return the index of the motion or sound that is played."""
    return state.motion if item == m.ITEM_MOTION else state.sound


def count(robot: Probe, item: int) -> int:
    """Return how many motions or sounds the robot has."""
    assert robot.welcome is not None
    return robot.welcome.motions if item == m.ITEM_MOTION else robot.welcome.sounds


def chosen(robot: Probe, state: m.State, item: int, but: int = m.NOTHING) -> int:
    """Return the last motion or sound that is neither played now nor excepted; 255 if none is."""
    kept = (shown(state, item), but)
    return next((one for one in reversed(range(count(robot, item))) if one not in kept), m.NOTHING)


def play(robot: Probe, item: int, index: int) -> None:
    """Command a motion or a sound under the next number, and see its ACK."""
    robot.command(m.Play(robot.next_number(), item, index))


def see(robot: Probe, item: int, index: int, after: str) -> m.State:
    """Return the first STATE that shows what is played; raises UnmetError if none does in time."""
    end = robot.now + ACTS_WITHIN
    while True:
        state = robot.beat(after)
        if shown(state, item) == index:
            return state
        if robot.now > end:
            raise UnmetError(
                f"STATE({WORDS[item]}={index}) within {1000 * ACTS_WITHIN:.0f} ms after {after}",
                f"{WORDS[item]}={shown(state, item)}",
            )
        robot.hear(LOOK_EVERY)


def known_lengths(robot: Probe) -> dict[int, float]:
    """Return how long motion and sound take [s], by item; both are played by the first call.

    What does not end is infinite. Raises NotApplicableError for a robot that has neither.
    """
    if robot.lengths is None:
        robot.lengths = _played_out(robot)
    if not robot.lengths:
        raise NotApplicableError("it has no motions and no sounds")
    return robot.lengths


def lasting(robot: Probe, *items: int) -> dict[int, int]:
    """Open a session and return a motion, a sound or both that last; they are yet to be played."""
    lengths = known_lengths(robot)
    for item in items:
        if lengths.get(item, 0.0) < LONG_ENOUGH:
            raise NotApplicableError(f"it has no {WORDS[item]} that lasts long enough")
    robot.calm()
    state = robot.beat("HELLO")
    return {item: chosen(robot, state, item) for item in items}


def _played_out(robot: Probe) -> dict[int, float]:
    """Play a motion and a sound at once, for that takes less time, and see how long they take."""
    robot.calm()
    state = robot.beat("HELLO")
    indices = {item: chosen(robot, state, item) for item in WORDS}
    indices = {item: index for item, index in indices.items() if index != m.NOTHING}
    lengths = _timed(robot, indices)
    for item, length in lengths.items():
        if length < LONG_ENOUGH and len(lengths) > 1:  # it may be that the other has ended it
            lengths |= _timed(robot, {item: indices[item]})
    return lengths


def _timed(robot: Probe, indices: dict[int, int]) -> dict[int, float]:
    """Play what is named, and return how long each takes [s], by item."""
    begin = robot.now
    for item, index in indices.items():
        play(robot, item, index)
        see(robot, item, index, "PLAY")
    lengths: dict[int, float] = {}
    while len(lengths) < len(indices):
        state = robot.live(timing.BEAT_EVERY)[-1]
        for item in indices.keys() - lengths.keys():
            if shown(state, item) != indices[item]:
                lengths[item] = robot.now - begin
            elif robot.now - begin > LONGEST_PIECE:
                lengths[item] = inf
    return dict(sorted(lengths.items()))


def _played(robot: Probe, item: int) -> None:
    """Play an entry that is not played already, and see it in STATE."""
    robot.fresh()
    if not count(robot, item):
        raise NotApplicableError(f"it has no {WORDS[item]}s")
    index = chosen(robot, robot.beat("HELLO"), item)
    if index == m.NOTHING:  # the only one, and it is played
        index = 0
    play(robot, item, index)
    see(robot, item, index, "PLAY")


def _not_shown(robot: Probe, item: int, index: int, after: str) -> None:
    for state in robot.live(ACTS_WITHIN):
        if shown(state, item) == index:
            raise UnmetError(f"no {WORDS[item]} {index} after {after}", f"{WORDS[item]}={index}")
