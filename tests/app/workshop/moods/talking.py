"""What a robot and its host say, and the words of a plot."""

import xml.etree.ElementTree as ElementTree

from cubeling.robot.protocol import messages as m


def state(valence, arousal, mood=0):
    return m.State(0, 0, 0, valence, arousal, 1.0, mood, 0, m.NOTHING, (0.0,) * 16)


SAID = [
    (0.00, "tx", m.Hello(2, 7)),
    (0.01, "rx", m.Welcome(2, 0, 1, 0, 0, 0, 2, "dino", "test")),
    (0.02, "rx", m.Name(m.ITEM_MOOD, 1, "merry")),
    (0.05, "tx", m.Express(1, 0.5, 0.25)),
    (0.10, "rx", m.Ack(1, m.RESULT_TAKEN)),
    (0.11, "rx", m.Ack(1, m.RESULT_TAKEN)),
    (0.15, "rx", state(0.1, 0.05)),
    (0.16, "tx", m.Express(2, 0.6, 0.3)),  # its acknowledgement is lost
    (0.20, "rx", state(0.4, 0.2, 1)),
    (0.25, "tx", m.Express(3, 0.7, 0.4)),
    (0.26, "rx", m.Ack(3, m.RESULT_REFUSED)),
    (0.30, "rx", m.Gone()),
]


def words_of(path):
    """Return all text of an SVG."""
    return [each.text for each in ElementTree.parse(path).iter() if each.text]
