"""Sessions without the people in them: only the cubes and the table around them stay sharp."""

from collections import defaultdict
from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
from foxglove_schemas_protobuf.CompressedImage_pb2 import CompressedImage
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from numpy.typing import NDArray

from cubeling.app.errors import AppError
from cubeling.app.session import SessionFile, frame_encoder
from cubeling.app.session.copying import copy_session
from cubeling.app.session.encoding import (
    APPEARANCE_TOPIC,
    IMAGE_TOPIC,
    decode,
    encode as encode_message,
    message_type,
)
from cubeling.tracking import (
    CubeControls,
    CubeState,
    Intrinsics,
    nanoseconds_of,
    open_source,
)
from cubeling.tracking.appearance import Appearance

Array = NDArray[np.float64]
Image = NDArray[np.uint8]

TABLE_RADIUS_M = 0.16
"""What stays sharp of the table around a cube [m]."""

CUBE_MARGIN = 1.5
"""What stays sharp around a cube, as a multiple of its size."""

BLOCKS_ACROSS = 24
"""Blocks across the width of a picture where it is not sharp: a face that fills a quarter of the
picture has six."""

RIM_POINTS = 48
"""Points of the circle on the table."""


def anonymise(session: Path, path: Path, edge: float) -> int:
    """Write a session whose pictures are blurred outside cubes and table, and return their number.

    All other channels stay as they are, but for the map of the room. A picture in which no cube was
    found is blurred as a whole.

    Parameters
    ----------
    session
        A session with every channel.
    path
        The .mcap file to write; it is whole or not there.
    edge
        Edge of the cube [m].

    Raises
    ------
    AppError
        The session cannot be read, was recorded without video, or the file cannot be written.
    """
    with SessionFile(session) as file:
        if not file.info.has_video:
            raise AppError(f"'{session}' was recorded without video: there is nobody in it")
        regions = _regions(file)
    count = 0
    with open_source(str(session)) as source:
        frames, lens = iter(source), source.intrinsics or Intrinsics.guess(source.size)
        codec = "jpeg" if source.size[0] % 2 or source.size[1] % 2 else "h264"
        kind = CompressedVideo if codec == "h264" else CompressedImage
        encode = frame_encoder(codec, source.size, source.rate)

        def change(topic: str, time: float, data: bytes) -> bytes:
            nonlocal count
            if topic == APPEARANCE_TOPIC:
                return without_room(data)
            if topic != IMAGE_TOPIC:
                return data
            frame = next(frames, None)
            if frame is None:
                raise AppError(f"cannot read the session '{session}': a picture is missing")
            count += 1
            places = regions.get(nanoseconds_of(time), ())
            picture = blurred(frame.image, sharp_region(frame.image.shape[:2], places, lens, edge))
            made = encode(replace(frame, image=picture, encoded=None, encoding=""))
            message = kind(frame_id="camera", data=made.encoded or b"", format=made.encoding)
            message.timestamp.FromNanoseconds(nanoseconds_of(time))
            return bytes(message.SerializeToString())

        copy_session(session, path, change, pictures=kind)
    return count


def without_room(data: bytes) -> bytes:
    """Return an appearance without the map of the room, which shows who is in it."""
    return encode_message(replace(decode(Appearance, data), room=None))


Places = tuple[tuple[Array, Array | None], ...]
"""`camera_from_cube` and `camera_from_table`, (4, 4), of each cube that was found."""


def _regions(file: SessionFile) -> dict[int, Places]:
    """Return where cubes and table are in each frame, by its time [ns]."""
    kinds = {topic: message_type(topic) for topic in file.channels}
    wanted = {t: kind for t, kind in kinds.items() if kind in (CubeState, CubeControls)}
    cubes: defaultdict[int, list[Array]] = defaultdict(list)
    tables: dict[int, Array] = {}
    for _, time, message in file.decode_messages(wanted):
        now = nanoseconds_of(time)
        if isinstance(message, CubeState):
            if message.visible and message.camera_from_cube is not None:
                cubes[now].append(message.camera_from_cube)
        elif message.camera_from_table is not None:
            tables[now] = message.camera_from_table
    return {now: tuple((cube, tables.get(now)) for cube in each) for now, each in cubes.items()}


def sharp_region(
    shape: tuple[int, ...], places: Places, lens: Intrinsics, edge: float
) -> NDArray[np.uint8]:
    """Return where a picture stays sharp, 255 or 0, (height, width)."""
    mask = np.zeros(shape[:2], np.uint8)
    half = CUBE_MARGIN * edge / 2.0
    corners = half * np.array([(x, y, z) for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)], float)
    turn = np.linspace(0.0, 2.0 * np.pi, RIM_POINTS, endpoint=False)
    rim = TABLE_RADIUS_M * np.stack([np.cos(turn), np.zeros(RIM_POINTS), np.sin(turn)], 1)
    for cube, table in places:
        _fill(mask, cube, corners, lens)
        if table is not None:
            foot = (np.linalg.inv(table) @ cube)[:3, 3] * (1.0, 0.0, 1.0)
            _fill(mask, table, rim + foot, lens)
    return mask


def blurred(image: Image, sharp: NDArray[np.uint8]) -> Image:
    """Return a picture with large blocks where it is not sharp."""
    height, width = image.shape[:2]
    size = BLOCKS_ACROSS, max(1, round(BLOCKS_ACROSS * height / width))
    blocks = cv2.resize(image, size, interpolation=cv2.INTER_AREA)
    smooth = cv2.resize(blocks, (width, height), interpolation=cv2.INTER_LINEAR)
    return np.where(sharp[..., None] > 0, image, np.asarray(smooth, np.uint8))


def _fill(mask: NDArray[np.uint8], camera_from: Array, points: Array, lens: Intrinsics) -> None:
    """Fill the hull of points that are given in some frame [m]."""
    seen = points @ camera_from[:3, :3].T + camera_from[:3, 3]
    if (seen[:, 2] < 0.02).any():  # behind the camera: no hull
        return
    pixels, _ = cv2.projectPoints(seen, np.zeros(3), np.zeros(3), lens.matrix, lens.distortion)
    hull = cv2.convexHull(np.round(pixels.reshape(-1, 2)).astype(np.int32))
    cv2.fillConvexPoly(mask, hull, 255)
