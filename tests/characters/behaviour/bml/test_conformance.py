"""The cases of the public conformance suite, bml-1, in virtual time."""

from collections.abc import Callable
from pathlib import Path

import pytest

from cubeling.characters.behaviour.bml import FACE_SYNCS, GESTURE_SYNCS, HOLD_SYNCS, SHIFT_SYNCS
from tests.characters.behaviour.bml.suite import Session, Until, block

CASES = Path(__file__).parents[5] / "shared" / "data" / "bml" / "bml-1"

needs_cases = pytest.mark.skipif(not CASES.exists(), reason="the suite's cases are not here")

REPLACE_ALL = block(name="bmlrep", more='composition="REPLACE"')


def perform(*steps: str | Until, folder: str = "core") -> Session:
    """Perform cases of a folder one after the other, and wait until all is over."""
    documents = [
        (CASES / folder / f"{step}.xml").read_text() if isinstance(step, str) else step
        for step in steps
    ]
    return Session(*documents).finish()


def one_behaviour(case: str, behaviour: str, syncs: tuple[str, ...], **times: float) -> None:
    session = perform(case)
    session.check_clean()
    session.check_blocks("bml1")
    session.check_syncs("bml1", behaviour, syncs)
    for sync, seconds in times.items():
        session.check_time(f"bml1:{behaviour}:{sync}", seconds)


def empty() -> None:
    session = perform("empty")
    session.check_clean()
    session.check_blocks("bml1")


def no_id() -> None:
    assert len(perform("bmlnoid").warnings) == 1


def very_short() -> None:
    session = perform("testshortbeh")
    session.check_no_duplicates()
    session.check_blocks("bml1")


def gaze_overlap() -> None:
    session = perform("testgazeoverlap")
    session.check_no_duplicates()
    session.check_blocks("bml1")
    assert [warning.id for warning in session.warnings] == ["bml1:gaze2"]
    session.check_syncs("bml1", "gaze1", HOLD_SYNCS)
    session.check_time("bml1:gaze1:start", 1)
    session.check_time("bml1:gaze1:end", 10)


def nod_timed_to_speech(case: str) -> None:
    session = perform(case)
    session.check_clean()
    session.check_blocks("bml1")
    session.check_syncs("bml1", "speech1", ("start", "syncstart1", "end"))
    session.check_syncs("bml1", "nod1", GESTURE_SYNCS)
    session.check_time("bml1:speech1:start", 6)
    session.check_time("bml1:nod1:end", 9)
    session.check_linked("bml1:speech1:syncstart1", "bml1:nod1:start")


def speech_timed_by_a_constraint() -> None:
    session = perform("testspeechandnod_synctimed")
    session.check_clean()
    session.check_blocks("bml1")
    session.check_syncs("bml1", "speech1", ("start", "s1", "end"))
    session.check_syncs("bml1", "nod1", GESTURE_SYNCS)
    session.check_time("bml1:speech1:s1", 10)
    session.check_linked("bml1:speech1:start", "bml1:nod1:start")
    assert session.report("bml1:speech1:start").block_time < 10
    assert session.report("bml1:speech1:end").block_time > 10


def speech_and_gestures() -> None:
    session = perform("testspeechgestures")
    session.check_clean()
    session.check_blocks("bml1")
    session.check_syncs("bml1", "welkom", ("start", "deicticheart1", "beat1b1", "end"))
    session.check_time("bml1:welkom:deicticheart1", 2)
    for gesture, start, end in (("g1", 2, 4), ("relaxleft", 4.5, 6.8), ("transleft", 0, 2)):
        session.check_syncs("bml1", gesture, GESTURE_SYNCS)
        session.check_time(f"bml1:{gesture}:start", start)
        session.check_time(f"bml1:{gesture}:end", end)


def speech_and_gestures_in_turn() -> None:
    session = perform("testspeechgesturesync2x")
    session.check_clean()
    session.check_blocks("bml1")
    for name, syncs in (("beat", GESTURE_SYNCS), ("speech", SHIFT_SYNCS)):
        for behaviour in {"beat": ("beat5", "beatstop"), "speech": ("speech1", "speech2")}[name]:
            session.check_syncs("bml1", behaviour, syncs)
    session.check_linked("bml1:speech1:start", "bml1:beat5:stroke")
    session.check_linked("bml1:speech2:start", "bml1:beatstop:end")
    session.check_linked("bml1:beatstop:start", "bml1:beat5:end", 3)


def append() -> None:
    session = perform("testspeech", "testspeechappend")
    session.check_clean()
    session.check_blocks("bml1", "bml2")
    session.check_after_block("bml2", "bml1")
    for name in ("bml1", "bml2"):
        session.check_syncs(name, "speech1", SHIFT_SYNCS)
        assert session.block_time(name, "end") > session.block_time(name, "start")


def append_and_replace() -> None:
    first = ("testspeech1", "testspeech2")
    session = perform(*first, Until(seconds=3), "replace", folder="core/appendandreplace")
    session.check_clean()
    session.check_blocks("bml1", "bml2", "bml3")
    perform(*first, folder="core/appendandreplace").check_blocks("bml1", "bml2")


def replace() -> None:
    session = perform("testlongspeechandnod", Until(seconds=0.7), "replace", folder="core/replace")
    session.check_clean()
    session.check_blocks("bml1", "bml3")
    assert session.block_time("bml3", "end") < 2.0


CORE: dict[str, Callable[[], None]] = {
    "empty": empty,
    "bmlnoid": no_id,
    "testface": lambda: one_behaviour("testface", "face1", FACE_SYNCS),
    "testbeatgesture": lambda: one_behaviour("testbeatgesture", "g1", GESTURE_SYNCS),
    "testspeech": lambda: one_behaviour("testspeech", "speech1", SHIFT_SYNCS, start=0),
    "testspeech2": lambda: one_behaviour(
        "testspeech2", "speech1", ("start", "syncstart1", "end"), start=6
    ),
    "testspeech_nodtimedtosync": lambda: nod_timed_to_speech("testspeech_nodtimedtosync"),
    "testspeech_nodtimedtosyncinverseorder": lambda: nod_timed_to_speech(
        "testspeech_nodtimedtosyncinverseorder"
    ),
    "testspeechandnod_synctimed": speech_timed_by_a_constraint,
    "testspeechgestures": speech_and_gestures,
    "testspeechgesturesync2x": speech_and_gestures_in_turn,
    "testnodlong": lambda: one_behaviour("testnodlong", "nod1", GESTURE_SYNCS, start=0, end=5),
    "testgaze": lambda: one_behaviour("testgaze", "gaze1", HOLD_SYNCS, start=1, end=10),
    "testgazewaist": lambda: one_behaviour("testgazewaist", "gaze1", HOLD_SYNCS, start=1),
    "testgazeshift": lambda: one_behaviour("testgazeshift", "gaze1", SHIFT_SYNCS),
    "testgazeoverlap": gaze_overlap,
    "testpoint": lambda: one_behaviour("testpoint", "point1", GESTURE_SYNCS, start=1, end=10),
    "testpose": lambda: one_behaviour("testpose", "pose1", SHIFT_SYNCS, start=5, end=8),
    "testshortbeh": very_short,
    "testspeechappend": append,
    "appendandreplace": append_and_replace,
    "replace": replace,
}
"""Checks by file or folder of bml-1/core."""


@needs_cases
@pytest.mark.parametrize("case", CORE)
def test_core(case: str) -> None:
    CORE[case]()


@needs_cases
def test_every_core_case_is_checked() -> None:
    files = sorted((CASES / "core").rglob("*.xml"))
    assert len(files) == 25
    assert {file.relative_to(CASES / "core").parts[0].removesuffix(".xml") for file in files} == {
        *CORE
    }


@needs_cases
def test_append_after() -> None:
    session = perform(
        "testspeech1", "testspeech2", "testspeech3", "testnodappendafter", folder="asap/appendafter"
    )
    session.check_clean()
    for name in ("bml1", "bml2", "bml3"):
        session.check_syncs(name, "speech1", SHIFT_SYNCS)
    session.check_syncs("bml4", "nod1", GESTURE_SYNCS)
    session.check_after_block("bml2", "bml1")
    session.check_after_block("bml3", "bml2")
    session.check_after_block("bml4", "bml2")


@needs_cases
def test_interrupt_of_a_block() -> None:
    session = perform("testlongspeechandnod", "testinterruptbml1", folder="asap/interruptblock")
    session.check_clean()
    session.check_after_block("bml2", "bml1")
    session.check_blocks("bml1", "bml2")


@needs_cases
def test_interrupt_by_a_behaviour() -> None:
    session = perform(
        "testlongspeechandnod",
        Until(started="bml1"),
        "testspeechinterrupt",
        folder="asap/interrupt",
    )
    session.check_clean()
    session.check_linked("bml2:i1:start", "bml1:speech1:end")
    session.check_linked("bml2:i1:start", "bml1:nod1:relax")
    session.check_blocks("bml1", "bml2")


@needs_cases
def test_interrupt_of_some_behaviours_again_after_all_is_replaced() -> None:
    cases = ("testlongspeechandnod", "testinterruptionspeech", "testspeechinterrupt")
    texts = [(CASES / "asap/interruptbehavior" / f"{case}.xml").read_text() for case in cases]
    session = Session(*texts).finish()
    for _ in range(2):
        session.check_clean()
        session.check_linked("bml1:speech1:s1", "bml1:speech1:end")
        assert session.block_time("bml3", "start") == session.report("bml1:speech1:s1").time
        session.check_syncs("bml3", "speech1", SHIFT_SYNCS)
        assert session.syncs("bml1", "nod1") == []
        session.realizer.accept(REPLACE_ALL)
        session.finish()
        session.feedback.clear()
        for text in texts:
            session.realizer.accept(text)
        session.finish()


@needs_cases
def test_preplanned_block_is_activated_by_the_start_of_another() -> None:
    session = perform(
        "testspeech1", "testspeechinterrupt", Until(seconds=3), "testnod", folder="asap/preplan"
    )
    session.check_clean()
    assert session.blocks("start") == ["bml1", "bml3", "bml2"]
    assert sorted(session.blocks("end")) == ["bml1", "bml2", "bml3"]
    session.check_after_block("bml3", "bml1")


@needs_cases
def test_activate() -> None:
    session = perform("testpreplannedspeech1", "testactivate", folder="asap/activate")
    session.check_clean()
    assert session.predictions("bml1")
    session.check_syncs("bml1", "speech1", SHIFT_SYNCS)
    session.check_syncs("bml2", "nod1", GESTURE_SYNCS)
    session.check_linked("bml2:nod1:end", "bml1:speech1:start")


@needs_cases
@pytest.mark.parametrize("folder", ["chunking", "chunkingconflictres"])
def test_chunks(folder: str) -> None:
    session = perform("firstchunk", "secondchunk", folder=f"asap/{folder}")
    session.check_clean()
    session.check_blocks("bml1", "bml2")
    session.check_syncs("bml1", "g1", GESTURE_SYNCS)
    session.check_syncs("bml2", "g1", GESTURE_SYNCS)
    session.check_linked("bml1:g1:relax", "bml2:g1:start")
    if folder == "chunkingconflictres":
        session.check_linked("bml1:g1:relax", "bml1:g1:end")


@needs_cases
def test_chunk_of_speech() -> None:
    session = perform("firstchunk", "secondchunk", folder="asap/chunkspeech")
    session.check_clean()
    session.check_linked("bml1:speech1:end", "bml2:speech1:start")


@needs_cases
def test_parameter_value_change() -> None:
    session = perform("parametervaluechange", folder="asap")
    session.check_clean()
    session.check_syncs("bml1", "pvc1", SHIFT_SYNCS)
    session.check_linked("bml1:speech1:end", "bml1:pvc1:end")


@needs_cases
def test_parameter_value_change_from_another_block() -> None:
    session = perform("speechandnod", "volumechange", folder="asap/parametervaluechange")
    session.check_clean()
    session.check_syncs("bml1", "speech1", ("start", "s1", "end"))
    session.check_linked("bml1:speech1:start", "bml2:pvc1:start")
    session.check_linked("bml1:speech1:end", "bml2:pvc1:end")


@needs_cases
@pytest.mark.parametrize("folder", ["murml", "bmlis", "bmlt"])
def test_extensions_are_performed_or_warned_of(folder: str) -> None:
    files = sorted((CASES / folder).glob("*.xml"))
    assert files
    for file in files:
        session = perform(file.stem, folder=folder)
        session.check_blocks("bml1")
        foreign = [w for w in session.warnings if w.type == "CUSTOM_BEHAVIOR_NOT_SUPPORTED"]
        assert bool(foreign) == (folder != "bmlis")
