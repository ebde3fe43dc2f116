"""Checks of the catalogue (sections 4 and 5): what the robot says that it has."""

from robot.conformance.check import Chapter
from robot.conformance.probe import Probe, told
from robot.conformance.verdicts import UnmetError
from robot.protocol import messages as m

CATALOGUE = Chapter("Catalogue", 5)

SAMPLES = 4
"""Entries that are asked for twice, about."""

_ITEMS = {
    m.ITEM_JOINT: "joint",
    m.ITEM_MOTION: "motion",
    m.ITEM_SOUND: "sound",
    m.ITEM_MOOD: "mood",
}


@CATALOGUE.must
def catalogue_complete(robot: Probe) -> str:
    """ASK is answered by JOINT or NAME for every entry that WELCOME counts, within 100 ms."""
    entries = read_catalogue(robot)
    counts = {item: sum(key[0] == item for key in entries) for item in _ITEMS}
    return ", ".join(f"{count} {_ITEMS[item]}s" for item, count in counts.items())


@CATALOGUE.must
def names_distinct(robot: Probe) -> None:
    """No entry is without a name, and no two of a kind have the same; the robot has a name too."""
    entries = known_catalogue(robot)
    for item, word in _ITEMS.items():
        names = [entry.name for key, entry in entries.items() if key[0] == item]
        if not all(name.strip() for name in names) or len(set(names)) != len(names):
            raise UnmetError(f"a name of its own for every {word}", ", ".join(map(repr, names)))
    if robot.welcome is None or not robot.welcome.name.strip():
        raise UnmetError("a name of the robot in WELCOME", "none")


@CATALOGUE.must
def joint_limits_sensible(robot: Probe) -> None:
    """Every joint has a smallest angle below its largest, and a speed."""
    for entry in known_joints(robot):
        if not (entry.low < entry.high and entry.speed > 0):
            raise UnmetError(
                f"joint {entry.index} with low < high and speed > 0",
                f"low={entry.low}, high={entry.high}, speed={entry.speed}",
            )


@CATALOGUE.must
def catalogue_steady(robot: Probe) -> None:
    """The catalogue is the same for every host and in every session, as its number says."""
    first = robot.fresh()
    robot.again()
    second = robot.fresh()
    for field in ("catalogue", "joints", "motions", "sounds", "moods", "name", "firmware"):
        one, other = getattr(first, field), getattr(second, field)
        if one != other:
            raise UnmetError(f"WELCOME({field}={one}) in every session", f"{field}={other}")
    keys = _keys(second)
    for key in keys[:: max(len(keys) // SAMPLES, 1)]:
        if _ask(robot, *key) != _ask(robot, *key):
            raise UnmetError(f"the same entry at every ASK for {_ITEMS[key[0]]} {key[1]}", "two")


@CATALOGUE.must
def no_entry_beyond_the_catalogue(robot: Probe) -> None:
    """ASK for an entry that the catalogue does not have is not answered, and does no harm."""
    welcome = robot.fresh()
    counts = (welcome.joints, welcome.motions, welcome.sounds, welcome.moods)
    questions = [(item, count) for item, count in enumerate(counts)]
    questions += [(item, 255) for item in _ITEMS] + [(4, 0), (255, 255)]
    for item, index in questions:
        what = f"ASK for item {item}, index {index}"
        came = robot.reaction(robot.frame(m.Ask(item, index)), after=what)
        if came:
            raise UnmetError(f"no answer to {what}", told(came))


def read_catalogue(robot: Probe) -> dict[tuple[int, int], m.Joint | m.Name]:
    """Open a session and read all entries, by item and index."""
    welcome = robot.fresh()
    robot.catalogue = {key: _ask(robot, *key) for key in _keys(welcome)}
    return robot.catalogue


def known_catalogue(robot: Probe) -> dict[tuple[int, int], m.Joint | m.Name]:
    """Return all entries, read by the first check that wanted them."""
    return read_catalogue(robot) if robot.catalogue is None else robot.catalogue


def known_joints(robot: Probe) -> list[m.Joint]:
    """Return the robot's joints."""
    return [entry for entry in known_catalogue(robot).values() if isinstance(entry, m.Joint)]


def _keys(welcome: m.Welcome) -> list[tuple[int, int]]:
    counts = (welcome.joints, welcome.motions, welcome.sounds, welcome.moods)
    return [(item, index) for item, count in enumerate(counts) for index in range(count)]


def _ask(robot: Probe, item: int, index: int) -> m.Joint | m.Name:
    robot.say(m.Ask(item, index))
    after = f"ASK for {_ITEMS[item]} {index}"
    if item == m.ITEM_JOINT:
        return robot.expect(m.Joint, after, index=index)
    return robot.expect(m.Name, after, item=item, index=index)
