"""Sessions for Foxglove: read again with its own schemas, what is drawn is where it was."""

import json
from collections import defaultdict
from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from foxglove_schemas_protobuf.LinePrimitive_pb2 import LinePrimitive
from mcap.reader import make_reader
from mcap_protobuf.decoder import DecoderFactory

from cubeling.app.session import SessionFile, messages
from cubeling.app.workshop.exporting.foxglove import LAYOUT_FILE
from cubeling.characters import PosedCharacter
from cubeling.characters.skeleton import rotations
from cubeling.tracking import CubeControls, CubeState, open_source
from tests.app.conftest import SHORT_FRAMES


def read_view(path):
    """Return the messages that Foxglove decodes by the schemas in the file: {topic: {ns: …}}."""
    found: defaultdict[str, dict[int, Any]] = defaultdict(dict)
    schemas: dict[str, str] = {}
    with path.open("rb") as file:
        reader = make_reader(file, decoder_factories=[DecoderFactory()])
        topics = [f"/view/{name}" for name in ("calibration", "transforms", "annotations", "scene")]
        for schema, channel, message, decoded in reader.iter_decoded_messages(topics=topics):
            found[channel.topic][message.log_time] = decoded
            assert schema is not None
            schemas[channel.topic] = schema.name
    return found, schemas


def matrix_of(transform):
    t, r = transform.translation, transform.rotation
    pose = np.eye(4)
    pose[:3, :3] = rotations.to_matrix(np.array([r.x, r.y, r.z, r.w]))
    pose[:3, 3] = t.x, t.y, t.z
    return pose


@pytest.fixture
def shown(cubeling, short_session):
    code, _, err = cubeling("export", short_session, "-o", "out", "--foxglove")
    assert (code, err) == (0, "")
    return Path("out", "short-foxglove.mcap")


def test_transforms_annotations_and_scene_are_in_place(shown, short_session):
    found, schemas = read_view(shown)
    assert schemas == {
        "/view/calibration": "foxglove.CameraCalibration",
        "/view/transforms": "foxglove.FrameTransforms",
        "/view/annotations": "foxglove.ImageAnnotations",
        "/view/scene": "foxglove.SceneUpdate",
    }
    assert {len(each) for each in found.values()} == {SHORT_FRAMES}
    with SessionFile(short_session) as session:
        kinds = {
            "/cube/state": CubeState,
            "/cube/controls": CubeControls,
            "/character/pose": PosedCharacter,
        }
        told: defaultdict[int, dict[str, Any]] = defaultdict(dict)
        for topic, time, message in session.decode_messages(kinds):
            told[round(time * 1e9)][topic] = message
    with open_source(str(short_session)) as source:
        lens = source.intrinsics
    assert lens is not None
    seen_on_table = 0
    for now, of_frame in told.items():
        state, posed = of_frame["/cube/state"], of_frame["/character/pose"]
        table = of_frame["/cube/controls"].camera_from_table
        frames = {
            (each.parent_frame_id, each.child_frame_id): matrix_of(each)
            for each in found["/view/transforms"][now].transforms
        }
        placed = frames["table", "vleo"]
        np.testing.assert_allclose(placed[:3, 3], posed.table_from_character[:3, 3], atol=1e-9)
        if not state.visible:
            continue
        np.testing.assert_allclose(frames["camera", "cube"], state.camera_from_cube, atol=1e-6)
        calibration = found["/view/calibration"][now]
        matrix = np.array(calibration.K).reshape(3, 3)
        assert matrix[0, 0] == pytest.approx(lens.matrix[0, 0] * state.focal_scale)
        drawn = found["/view/annotations"][now].points[0]
        ends = np.array([(point.x, point.y) for point in drawn.points])
        assert len(ends) == 24
        middle, _ = cv2.projectPoints(
            state.camera_from_cube[:3, 3], np.zeros(3), np.zeros(3), matrix, lens.distortion
        )
        assert np.linalg.norm(ends.mean(0) - middle.ravel()) < 0.1 * np.ptp(ends, axis=0).max()
        if table is None:
            continue
        seen_on_table += 1
        world_from_camera = frames["world", "table"] @ frames["table", "camera"]
        np.testing.assert_allclose(frames["table", "camera"] @ table, np.eye(4), atol=1e-6)
        # A cube that stands on the table is above it: z is up in the world.
        assert 0.0 < (world_from_camera @ frames["camera", "cube"])[2, 3] < 0.3
        entities = {each.id: each for each in found["/view/scene"][now].entities}
        assert entities["cube"].frame_id == "cube"
        assert entities["cube"].lines[0].type == LinePrimitive.LINE_LIST
        if posed.visible:
            heights = [point.y for point in entities["vleo's body"].lines[0].points]
            assert -0.02 < min(heights) < max(heights) < 0.3
    assert seen_on_table > 5


def test_the_rest_is_still_the_session_and_the_layout_names_what_is_there(shown, short_session):
    def kept(path):
        return [each for each in messages(path) if not each[0].startswith("/view/")]

    assert kept(shown) == kept(short_session)
    layout = json.loads(Path("out", LAYOUT_FILE).read_text("utf-8"))
    panels = layout["configById"]

    def leaves(node):
        return [node] if isinstance(node, str) else leaves(node["first"]) + leaves(node["second"])

    assert sorted(leaves(layout["layout"])) == sorted(panels)
    topics = {topic for topic, _, _ in messages(shown)}
    image = panels["Image!picture"]["imageMode"]
    named = {image["imageTopic"], image["calibrationTopic"], *image["annotations"]}
    named |= set(panels["3D!space"]["topics"])
    assert named <= topics
    series = [
        path["value"]
        for name in ("Plot!emotion", "StateTransitions!state")
        for path in panels[name]["paths"]
    ]
    last = {
        topic: json.loads(data)
        for topic, _, data in messages(shown, *{value.partition(".")[0] for value in series})
    }
    for value in series:
        topic, *fields = value.split(".")
        message = last[topic]
        for field in fields:
            assert field in message, value
            message = message[field]
