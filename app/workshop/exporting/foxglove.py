"""Sessions as Foxglove shows them: what is seen, drawn into the picture and in space.

Everything of the session is copied, and channels below /view are added: a session does not grow by
what can be computed from it.
"""

import json
from collections.abc import Iterable, Iterator
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

import cv2
import numpy as np
from foxglove_schemas_protobuf.Color_pb2 import Color
from foxglove_schemas_protobuf.FrameTransforms_pb2 import FrameTransforms
from foxglove_schemas_protobuf.ImageAnnotations_pb2 import ImageAnnotations
from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
from foxglove_schemas_protobuf.PointsAnnotation_pb2 import PointsAnnotation
from foxglove_schemas_protobuf.SceneEntityDeletion_pb2 import SceneEntityDeletion
from foxglove_schemas_protobuf.SceneUpdate_pb2 import SceneUpdate
from google.protobuf.message import Message

from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.app.session import SessionFile
from cubeling.app.session.copying import copy_session
from cubeling.app.session.encoding import IMAGE_TOPIC, message_type
from cubeling.app.session.recorder import calibration_message
from cubeling.app.workshop.exporting.motion import cast_of
from cubeling.characters import Character, PosedCharacter
from cubeling.characters.motion import Array, rotations
from cubeling.files import write_whole
from cubeling.tracking import CubeControls, CubeState, Intrinsics, nanoseconds_of, open_source

CALIBRATION_TOPIC, TRANSFORMS_TOPIC = "/view/calibration", "/view/transforms"
ANNOTATIONS_TOPIC, SCENE_TOPIC = "/view/annotations", "/view/scene"

LAYOUT_FILE = "foxglove_layout.json"
"""Name of the layout that shows these channels."""

WORLD_FROM_TABLE = np.array([[1, 0, 0, 0], [0, 0, -1, 0], [0, 1, 0, 0], [0, 0, 0, 1]], float)
"""Foxglove's z is up, and the table's y."""

NEAREST_M = 0.02
"""What is nearer to the camera is not drawn into the picture [m]."""

LINE_PX = 2.0
TEXT_PX = 18.0
CUBE_COLOUR, BODY_COLOUR = (1.0, 0.6, 0.1, 1.0), (0.2, 0.8, 1.0, 1.0)
"""Red, green, blue and opacity, 0…1."""

_CORNERS = np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float) / 2.0
_EDGES = [
    corner
    for pair in [(a, b) for a in range(8) for b in range(a) if bin(a ^ b).count("1") == 1]
    for corner in pair
]
_CUBE_LINES = _CORNERS[_EDGES]  # (24, 3), two by two


def write_foxglove(session: Path, path: Path) -> None:
    """Write a session that has every channel with what Foxglove shows of it.

    Raises
    ------
    AppError, TrackingError, CharacterError
        The session cannot be read, or the file cannot be written.
    """
    with open_source(str(session)) as source:
        lens = source.intrinsics or Intrinsics.guess(source.size)
    with SessionFile(session) as file:
        view = _View(file, lens)
        copy_session(session, path, lambda topic, time, data: data, view.messages)


def write_layout(path: Path) -> None:
    """Write the layout that opens what `write_foxglove` writes; raises AppError."""
    write_whole(path, json.dumps(layout(), indent=2) + "\n", AppError)


def layout() -> dict[str, Any]:
    """Return a layout of Foxglove: picture, space, and the emotion over time."""
    image = {
        "imageTopic": IMAGE_TOPIC,
        "calibrationTopic": CALIBRATION_TOPIC,
        "annotations": {ANNOTATIONS_TOPIC: {"visible": True}},
        "synchronize": False,
    }
    series = [
        {
            "value": f"/robot/emotion.emotion.{name}",
            "label": name,
            "enabled": True,
            "timestampMethod": "receiveTime",
        }
        for name in ("valence", "arousal")
    ]
    space = {
        "followTf": "world",
        "followMode": "follow-none",
        "topics": {SCENE_TOPIC: {"visible": True}, CALIBRATION_TOPIC: {"visible": True}},
        "cameraState": {
            "perspective": True,
            "distance": 0.9,
            "phi": 60.0,
            "thetaOffset": 30.0,
            "targetOffset": [0.0, 0.0, 0.0],
            "target": [0.0, 0.0, 0.0],
            "targetOrientation": [0.0, 0.0, 0.0, 1.0],
            "fovy": 45.0,
            "near": 0.01,
            "far": 100.0,
        },
        "transforms": {f"frame:{name}": {"visible": True} for name in ("table", "camera", "cube")},
    }
    return {
        "configById": {
            "Image!picture": {"foxglovePanelTitle": "Picture", "imageMode": image},
            "3D!space": {"foxglovePanelTitle": "Table", **space},
            "Plot!emotion": {
                "foxglovePanelTitle": "Emotion",
                "paths": series,
                "xAxisVal": "timestamp",
                "minYValue": -1,
                "maxYValue": 1,
                "showLegend": True,
                "isSynced": True,
            },
            "StateTransitions!state": {
                "foxglovePanelTitle": "What it does",
                "paths": [
                    {"value": path, "enabled": True, "timestampMethod": "receiveTime"}
                    for path in ("/character/pose.state", "/robot/emotion.emotion.word")
                ],
                "isSynced": True,
            },
        },
        "globalVariables": {},
        "userNodes": {},
        "playbackConfig": {"speed": 1},
        "layout": {
            "direction": "column",
            "first": {
                "direction": "row",
                "first": "Image!picture",
                "second": "3D!space",
                "splitPercentage": 55,
            },
            "second": {
                "direction": "row",
                "first": "Plot!emotion",
                "second": "StateTransitions!state",
                "splitPercentage": 55,
            },
            "splitPercentage": 65,
        },
    }


class _View:
    """What is shown of each frame of a session, computed as the pictures are copied."""

    def __init__(self, file: SessionFile, lens: Intrinsics) -> None:
        self._lens, self._edge = lens, file.cube_edge
        self._cast = dict(cast_of(file))
        kinds = {topic: message_type(topic) or object for topic in file.channels}
        shown = (CubeState, CubeControls, PosedCharacter, EmotionTarget)
        wanted = {topic: kind for topic, kind in kinds.items() if kind in shown}
        self._frames = groupby(file.decode_messages(wanted), key=itemgetter(1))
        self._table: Array | None = None

    def messages(self, time: float) -> Iterator[tuple[str, Message]]:
        """Yield topics and messages of the frame at a time [s], which may only grow."""
        for at, found in self._frames:
            if at == time:
                yield from self._view({topic: message for topic, _, message in found}, time)
            if at >= time:
                return

    def _view(self, found: dict[str, Any], time: float) -> Iterator[tuple[str, Message]]:
        state: CubeState | None = found.get("/cube/state")
        lens = self._lens if state is None else self._lens.lengthen(state.focal_scale, None)
        controls: CubeControls | None = found.get("/cube/controls")
        if controls is not None and controls.camera_from_table is not None:
            self._table = controls.camera_from_table
        cubes = {"cube": state} if state is not None else {}
        for topic, message in found.items():
            if isinstance(message, CubeState) and topic.startswith("/cubes/"):
                cubes[f"cube {topic.split('/')[2]}"] = message
        seen = {
            name: each.camera_from_cube if each.visible else None for name, each in cubes.items()
        }
        bodies = {
            name: (found[topic], self._cast[topic][1])
            for topic, (name, _) in self._cast.items()
            if topic in found
        }
        yield CALIBRATION_TOPIC, calibration_message(lens, time)
        yield TRANSFORMS_TOPIC, self._transforms(seen, bodies, time)
        lines = {name: _bones(posed, character) for name, (posed, character) in bodies.items()}
        yield ANNOTATIONS_TOPIC, self._annotations(found, seen, lines, lens, time)
        yield SCENE_TOPIC, self._scene(seen, lines, time)

    def _transforms(
        self,
        cubes: dict[str, Array | None],
        bodies: dict[str, tuple[PosedCharacter, Character]],
        time: float,
    ) -> Message:
        message = FrameTransforms()
        frames: list[tuple[str, str, Array]] = [
            ("camera", name, pose) for name, pose in cubes.items() if pose is not None
        ]
        if self._table is not None:
            frames.append(("world", "table", WORLD_FROM_TABLE))
            frames.append(("table", "camera", np.asarray(np.linalg.inv(self._table), float)))
        for name, (posed, _) in bodies.items():
            frames.append(("table", name, posed.table_from_character))
        for parent, child, pose in frames:
            transform = message.transforms.add(parent_frame_id=parent, child_frame_id=child)
            transform.timestamp.FromNanoseconds(nanoseconds_of(time))
            turn = pose[:3, :3] / np.linalg.norm(pose[:3, :3], axis=0)  # without its size
            _set(transform.translation, "xyz", pose[:3, 3])
            _set(transform.rotation, "xyzw", rotations.from_matrix(turn))
        return message

    def _annotations(
        self,
        found: dict[str, Any],
        cubes: dict[str, Array | None],
        bodies: dict[str, Array],
        lens: Intrinsics,
        time: float,
    ) -> Message:
        message = ImageAnnotations()
        message.timestamp.FromNanoseconds(nanoseconds_of(time))
        drawn = [
            (self._edge * _CUBE_LINES, pose, CUBE_COLOUR)
            for pose in cubes.values()
            if pose is not None
        ]
        if self._table is not None:
            drawn += [(lines, self._table, BODY_COLOUR) for lines in bodies.values()]
        for lines, camera_from, colour in drawn:
            points = _pixels(lines, camera_from, lens)
            if len(points):
                outline = message.points.add(type=PointsAnnotation.LINE_LIST, thickness=LINE_PX)
                outline.timestamp.FromNanoseconds(nanoseconds_of(time))
                outline.outline_color.CopyFrom(_colour(colour))
                for x, y in points.tolist():
                    outline.points.add(x=x, y=y)
        text = message.texts.add(text=_words(found), font_size=TEXT_PX)
        text.timestamp.FromNanoseconds(nanoseconds_of(time))
        _set(text.position, "xy", (TEXT_PX / 2.0, 1.5 * TEXT_PX))
        text.text_color.CopyFrom(_colour((1.0, 1.0, 1.0, 1.0)))
        text.background_color.CopyFrom(_colour((0.0, 0.0, 0.0, 0.6)))
        return message

    def _scene(
        self, cubes: dict[str, Array | None], bodies: dict[str, Array], time: float
    ) -> Message:
        message = SceneUpdate()
        things = [
            *((name, name, self._edge * _CUBE_LINES, CUBE_COLOUR) for name in cubes),
            *((f"{name}'s body", "table", lines, BODY_COLOUR) for name, lines in bodies.items()),
        ]
        for name, frame, lines, colour in things:
            if (name in cubes and cubes[name] is None) or not len(lines):
                gone = message.deletions.add(id=name, type=SceneEntityDeletion.MATCHING_ID)
                gone.timestamp.FromNanoseconds(nanoseconds_of(time))
                continue
            entity = message.entities.add(id=name, frame_id=frame, frame_locked=True)
            entity.timestamp.FromNanoseconds(nanoseconds_of(time))
            drawn = entity.lines.add(
                type=LinePrimitive.LINE_LIST, thickness=LINE_PX, scale_invariant=True
            )
            drawn.pose.orientation.w = 1.0
            drawn.color.CopyFrom(_colour(colour))
            for point in lines.tolist():
                drawn.points.add(x=point[0], y=point[1], z=point[2])
        return message


def _words(found: dict[str, Any]) -> str:
    """Return what is told of a frame: the cube's pose, the character's state, the emotion."""
    state, posed, emotion = (
        found.get(topic) for topic in ("/cube/state", "/character/pose", "/robot/emotion")
    )
    words = ["" if state is None else state.verdict, "" if posed is None else posed.state]
    words.append("" if emotion is None else emotion.emotion.label)
    return " · ".join(word for word in words if word)


def _bones(posed: PosedCharacter, character: Character) -> Array:
    """Return the ends of the bones on the table, two by two, (2n, 3) [m]."""
    skeleton = character.skeleton
    if not posed.visible or len(posed.pose.rotations) != len(skeleton):
        return np.zeros((0, 3))
    places = (posed.table_from_character @ posed.pose.globals(skeleton))[:, :3, 3]
    pairs = [(parent, joint) for joint, parent in enumerate(skeleton.parents) if parent >= 0]
    ends: Array = places[np.array(pairs, int).ravel()]
    return ends


def _pixels(lines: Array, camera_from: Array, lens: Intrinsics) -> Array:
    """Return the ends of lines in the picture, two by two, without those behind the camera [px]."""
    seen = lines @ camera_from[:3, :3].T + camera_from[:3, 3]
    before = (seen[:, 2] > NEAREST_M).reshape(-1, 2).all(1).repeat(2)
    if not before.any():
        return np.zeros((0, 2))
    pixels, _ = cv2.projectPoints(
        seen[before], np.zeros(3), np.zeros(3), lens.matrix, lens.distortion
    )
    return np.asarray(pixels, float).reshape(-1, 2)


def _set(message: Any, names: str, values: Iterable[float]) -> None:
    for name, value in zip(names, values, strict=True):
        setattr(message, name, float(value))


def _colour(values: tuple[float, float, float, float]) -> Color:
    red, green, blue, opacity = values
    return Color(r=red, g=green, b=blue, a=opacity)
