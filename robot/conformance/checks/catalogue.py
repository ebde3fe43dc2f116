"""Checks of the catalogue (sections 4 and 5): joints, motions, sounds and moods."""

from cubeling.robot.conformance.check import CheckGroup
from cubeling.robot.conformance.errors import CheckFailed
from cubeling.robot.conformance.probe import Probe
from cubeling.robot.protocol import messages as m

CATALOGUE = CheckGroup("Catalogue", 5)

REPEATED_ENTRIES = 4
"""Entries that are read twice, about."""

ITEM_WORDS = {
    m.ITEM_JOINT: "joint",
    m.ITEM_MOTION: "motion",
    m.ITEM_SOUND: "sound",
    m.ITEM_MOOD: "mood",
}
"""The items of a catalogue, in words."""


@CATALOGUE.must
def catalogue_complete(probe: Probe) -> str:
    """ASK is answered by JOINT or NAME for every entry that WELCOME counts, within 100 ms."""
    entries = _read_catalogue(probe)
    counts = {item: sum(key[0] == item for key in entries) for item in ITEM_WORDS}
    return ", ".join(f"{count} {ITEM_WORDS[item]}s" for item, count in counts.items())


@CATALOGUE.must
def names_distinct(probe: Probe) -> None:
    """Every entry has a name, different from the others of its kind; the robot has a name too."""
    entries = _known_catalogue(probe)
    for item, word in ITEM_WORDS.items():
        names = [entry.name for key, entry in entries.items() if key[0] == item]
        if not all(name.strip() for name in names) or len(set(names)) != len(names):
            raise CheckFailed(f"a different name for every {word}", ", ".join(map(repr, names)))
    if probe.welcome is None or not probe.welcome.name.strip():
        raise CheckFailed("a name of the robot in WELCOME", "none")


@CATALOGUE.must
def joint_limits_sensible(probe: Probe) -> None:
    """The smallest angle of every joint is below its largest, and its speed is not 0."""
    for entry in known_joints(probe):
        if not (entry.low < entry.high and entry.speed > 0):
            raise CheckFailed(
                f"joint {entry.index} with low < high and speed > 0",
                f"low={entry.low}, high={entry.high}, speed={entry.speed}",
            )


@CATALOGUE.must
def catalogue_constant(probe: Probe) -> None:
    """The catalogue is the same for every host and in every session, as its number says."""
    first = probe.open_session()
    keys = _keys(first)[:: max(len(_keys(first)) // REPEATED_ENTRIES, 1)]
    entries = {key: _ask(probe, *key) for key in keys}
    probe.reopen_session()
    second = probe.open_session()
    for field in ("catalogue", "joints", "motions", "sounds", "moods", "name", "firmware"):
        one, other = getattr(first, field), getattr(second, field)
        if one != other:
            raise CheckFailed(f"WELCOME({field}={one}) in every session", f"{field}={other}")
    for key, entry in entries.items():
        if not entry == _ask(probe, *key) == _ask(probe, *key):
            what = f"{ITEM_WORDS[key[0]]} {key[1]}"
            raise CheckFailed(f"the same entry at every ASK for {what}", "two different ones")


@CATALOGUE.must
def no_entry_beyond_the_catalogue(probe: Probe) -> None:
    """ASK for an entry that the catalogue does not have is not answered, and does no harm."""
    welcome = probe.open_session()
    questions = list(enumerate(_counts(welcome)))
    questions += [(item, 255) for item in ITEM_WORDS] + [(4, 0), (255, 255)]
    for item, index in questions:
        what = f"ASK for item {item}, index {index}"
        probe.expect_no_reply(probe.frame(m.Ask(item, index)), what)


def known_joints(probe: Probe) -> list[m.Joint]:
    """Return the robot's joints; the first call may read the catalogue."""
    return [entry for entry in _known_catalogue(probe).values() if isinstance(entry, m.Joint)]


def _known_catalogue(probe: Probe) -> dict[tuple[int, int], m.Joint | m.Name]:
    return _read_catalogue(probe) if probe.catalogue is None else probe.catalogue


def _read_catalogue(probe: Probe) -> dict[tuple[int, int], m.Joint | m.Name]:
    """Open a session and read all entries, by item and index."""
    welcome = probe.open_session()
    probe.catalogue = {key: _ask(probe, *key) for key in _keys(welcome)}
    return probe.catalogue


def _counts(welcome: m.Welcome) -> tuple[int, int, int, int]:
    return welcome.joints, welcome.motions, welcome.sounds, welcome.moods


def _keys(welcome: m.Welcome) -> list[tuple[int, int]]:
    counts = enumerate(_counts(welcome))
    return [(item, index) for item, count in counts for index in range(count)]


def _ask(probe: Probe, item: int, index: int) -> m.Joint | m.Name:
    probe.send(m.Ask(item, index))
    after = f"ASK for {ITEM_WORDS[item]} {index}"
    if item == m.ITEM_JOINT:
        return probe.expect(m.Joint, after, index=index)
    return probe.expect(m.Name, after, item=item, index=index)
