"""Which commands a robot refuses because its catalogue says so."""

from cubeling.robot.contract.catalogue import Catalogue
from cubeling.robot.protocol import messages as m

TAKEN = (m.RESULT_TAKEN, "")


def entry_names(catalogue: Catalogue, item: int) -> tuple[str, ...]:
    """Return the names of the motions, sounds or moods; none for another item."""
    lists = {
        m.ITEM_MOTION: catalogue.motions,
        m.ITEM_SOUND: catalogue.sounds,
        m.ITEM_MOOD: catalogue.moods,
    }
    return lists.get(item, ())


def refusal(command: m.Command, catalogue: Catalogue) -> tuple[int, str]:
    """Return the result of a command, and for its owner what is wrong with it."""
    match command:
        case m.Express(mood=mood) if m.NOTHING > mood >= len(catalogue.moods):
            return m.RESULT_REFUSED, f"EXPRESS {command.number}: no mood {mood}"
        case m.Play(item=item, index=index) if index >= len(entry_names(catalogue, item)):
            what = "motion" if item == m.ITEM_MOTION else "sound"
            return m.RESULT_REFUSED, f"PLAY {command.number}: no {what} {index}"
        case m.Move():
            return _move_refusal(command, catalogue)
    return TAKEN


def _move_refusal(command: m.Move, catalogue: Catalogue) -> tuple[int, str]:
    bits = command.moved | command.released
    if bits >> len(catalogue.joints):
        return m.RESULT_REFUSED, f"MOVE {command.number}: no joint {bits.bit_length() - 1}"
    for index, joint in enumerate(catalogue.joints):
        # In counts of the wire, as a host knows the limits from JOINT alone.
        angle, low, high = (
            round(1000 * one) for one in (command.angles[index], joint.low, joint.high)
        )
        if command.moved >> index & 1 and not low <= angle <= high:
            what = f"MOVE {command.number}: joint {index} not to {angle} mrad"
            return m.RESULT_OUT_OF_RANGE, what
    return TAKEN
