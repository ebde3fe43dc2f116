"""Feedback is written as the standard's XML."""

import math
from xml.etree import ElementTree

from cubeling.characters.behaviour.bml import (
    BML,
    BlockPrediction,
    BlockProgress,
    BmlWarning,
    PredictedBehaviour,
    SyncPointProgress,
    feedback_xml,
)


def written(feedback):
    element = ElementTree.fromstring(feedback_xml(feedback))
    return element.tag.removeprefix(f"{{{BML}}}"), element


def test_block_progress():
    tag, element = written(BlockProgress("bml1", "end", 2.5, "Anna"))
    assert tag == "blockProgress"
    assert element.attrib == {"id": "bml1:end", "globalTime": "2.5", "characterId": "Anna"}


def test_sync_point_progress():
    tag, element = written(SyncPointProgress("bml1", "g", "stroke", 111.0, 10.0))
    assert tag == "syncPointProgress"
    assert element.attrib == {"id": "bml1:g:stroke", "globalTime": "111", "time": "10"}


def test_warnings_with_signs_of_xml():
    tag, element = written(BmlWarning('a"<b', "NO_SUCH_TARGET", "<no> & never", 1.0))
    assert tag == "warningFeedback"
    assert element.attrib == {"id": 'a"<b', "type": "NO_SUCH_TARGET"}
    assert element.text == "<no> & never"


def test_predictions():
    gaze = PredictedBehaviour("z", "gaze", (("start", 0.5), ("end", math.inf)))
    tag, element = written(BlockPrediction("bml1", 3.0, math.inf, (gaze,)))
    assert tag == "predictionFeedback"
    assert [child.attrib for child in element] == [
        {"id": "bml1", "globalStart": "3"},
        {"id": "bml1:z", "start": "0.5"},
    ]
