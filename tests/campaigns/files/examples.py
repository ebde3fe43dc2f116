"""Good files of every kind: those in the tree, in `../shared/data`, and some that are made here."""

from collections.abc import Callable, Iterator
from pathlib import Path

import cv2
import numpy as np

from cubeling.app.preferences import PreferenceStore
from cubeling.app.session import Mark, SessionLabels, write_labels
from cubeling.app.sound import write_wave
from cubeling.app.ui.video_file import VideoFile
from cubeling.app.workshop.scenario_templates import RULES
from cubeling.bad_input import BadInputError
from cubeling.characters import Character
from cubeling.characters.control.speech_profile import SpeechProfile
from cubeling.characters.face.fap import FAP_COUNT, FapTrack, write_faps
from cubeling.characters.formats.mocap.bap import BapTrack, write_baps
from cubeling.characters.formats.mocap.bvh_writing import save_bvh
from cubeling.characters.formats.mocap.hanim import BAP_COUNT
from cubeling.characters.retargeting.root import with_root_joint
from cubeling.characters.speech.textgrid import Interval, TextGrid, Tier, write_textgrid
from cubeling.characters.synthesis.gestures.marks import GestureMarks
from cubeling.characters.synthesis.gestures.marks_files import MARKS_FILE
from cubeling.characters.synthesis.gestures.marks_writing import write_marks
from cubeling.characters.synthesis.graphs.building import analyse
from cubeling.characters.synthesis.graphs.storage import save_graph
from cubeling.characters.synthesis.library import MotionLibrary
from cubeling.files import FileKind
from cubeling.tracking import Intrinsics
from tests.characters.formats.built_gltf import build_arm
from tests.characters.formats.hopper import hopper
from tests.characters.formats.written_fbx import arm

TREE = Path(__file__).parents[3]
SHARED = TREE.parent / "shared" / "data"

MOST, MOST_BYTES = 6, 1_500_000
"""Most files of a kind, the smallest of them, and the largest of them [bytes]."""


def examples_of(kind: FileKind, made: Path, read: Callable[[Path], object]) -> list[Path]:
    """Return good files of a kind; `made` is the folder of `make_examples`."""
    folders = (TREE / room for room in ("affect", "app", "characters", "recordings", "robot"))
    others = (TREE / "tracking", TREE / "tests" / "sessions", TREE / "docs", SHARED)
    found = {
        path
        for folder in (made, *folders, *others)
        for path in folder.rglob("*")
        if path.suffix in kind.suffixes and path.stat().st_size <= MOST_BYTES
    }
    good: list[Path] = []
    for path in sorted(found, key=lambda each: (each.stat().st_size, each.name)):
        if len(good) < MOST and _is_read(read, path):
            good.append(path)
    return good


def _is_read(read: Callable[[Path], object], path: Path) -> bool:
    try:
        read(path)
    except BadInputError:
        return False
    return True


def make_examples(folder: Path) -> None:
    """Write an example of each format that no file in the tree has."""
    hopper(folder)
    for name, write in _writers():
        write(folder / name)


def _writers() -> Iterator[tuple[str, Callable[[Path], object]]]:
    random = np.random.default_rng(1)
    person = with_root_joint(Character.load("human"))
    clip = person.clips["Walk"]
    some = random.integers(-1000, 1000, (4, FAP_COUNT))
    yield "a.fap", lambda path: write_faps(path, FapTrack(25.0, some))
    angles = random.integers(-1000, 1000, (4, BAP_COUNT))
    yield "a.bap", lambda path: write_baps(path, BapTrack(25.0, angles))
    yield "a.wav", lambda path: write_wave(path, np.sin(np.arange(9000) / 20.0))
    words = tuple(Interval(n, n + 1.0, label) for n, label in enumerate(("", "one", "two")))
    grid = TextGrid(3.0, (Tier("words", words), Tier("notes", words)))
    yield "long.TextGrid", lambda path: write_textgrid(path, grid)
    yield "short.TextGrid", lambda path: write_textgrid(path, grid, short=True)
    yield "a.yaml", Intrinsics.guess((640, 480)).save
    grey = random.integers(0, 255, (64, 64), np.uint8)
    yield "a.png", lambda path: path.write_bytes(cv2.imencode(".png", grey)[1].tobytes())
    yield "a.bvh", lambda path: save_bvh(clip, person.skeleton, person.anatomy, path)
    library = MotionLibrary.of([clip], person.skeleton, person.anatomy)
    yield "a.graph", lambda path: save_graph(analyse(library), path)
    yield "a.mp4", _write_video
    yield "a.txt", lambda path: path.write_text(TEXT, "utf-8")
    yield "a.bml", lambda path: path.write_text(BLOCK, "utf-8")
    table = {"a": [GestureMarks(0.1, 0.4, 0.5, 0.6, 0.8, 1.0, 1.4)]}
    for suffix in MARKS_FILE.suffixes:
        yield f"marks{suffix}", lambda path: write_marks(path, table)
    yield "labels.csv", lambda path: path.write_text("start,end,label\n0.2,0.3,H*\n1,1.1,\n")
    yield "rules.toml", lambda path: path.write_text(RULES, "utf-8")
    yield "a.glb", lambda path: path.write_bytes(build_arm().bytes())
    yield "a.fbx", lambda path: path.write_text(arm(), "utf-8")
    yield "profile.toml", SpeechProfile().save
    yield "preferences.toml", _keep_preferences
    labels = SessionLabels("P1", "calm", "tired", (Mark(0.5, "error", "fell"),))
    yield "a.labels.toml", lambda path: write_labels(path.with_name("a.mcap"), labels)
    yield "study.json", lambda path: path.write_text('{"format": 1, "kind": "pilot"}\n', "utf-8")
    yield "wizard.toml", lambda path: path.write_text(WIZARD_PLAN, "utf-8")
    yield "log.jsonl", lambda path: path.write_text(STUDY_LOG, "utf-8")


def _write_video(path: Path) -> None:
    with VideoFile(path, (160, 120), 30.0) as video:
        for number in range(12):
            video.write(np.full((120, 160, 3), 20 * number, np.uint8), number / 30.0)


def _keep_preferences(path: Path) -> None:
    store = PreferenceStore(path)
    store.change(panels=("tracking@0.1:0.2",), window_size=(640, 480), volume=0.3)
    store.save()


STUDY_LOG = """{"begins": "P1", "number": 0, "kept": [], "at": "2026-05-04T15:03:09.000"}
{"key": "p/q/easy", "answer": 4.0, "seconds": 2.5, "at": "2026-05-04T15:03:12.000"}
"""

WIZARD_PLAN = """cues = ["placed", "child asks"]
say = ["Hello!", "Well done!"]
emotions = ["happy", "sad"]
[[place]]
name = "left"
x_cm = -12.0
z_cm = 3.5
"""

TEXT = '<begin_gesture id="a" anim="wave"/>Hello<end_gesture id="a"/> you, it is good to see you.'

BLOCK = """<bml xmlns="http://www.bml-initiative.org/bml/bml-1.0" id="b" characterId="a">
<speech id="s"><text>Hello <sync id="x"/>you</text></speech>
<gesture id="g" lexeme="WAVE" start="s:x" stroke="s:end-0.2"/>
<head id="h" lexeme="NOD" start="g:stroke+0.5" end="g:end"/>
<faceFacs id="f" au="12" side="BOTH" start="1" end="3"/>
<constraint id="c"><synchronize ref="g:end"><sync ref="f:end"/></synchronize></constraint>
</bml>"""
