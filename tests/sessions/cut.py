"""Cuts two seconds out of a session: `python -m tests.sessions.cut SESSION NEW --start 9`.

Metadata and messages stay as the program of that time wrote them, those of every third frame; the
camera's pictures are made small. Older sessions are in the history: `git log -- recordings`, and
`git show COMMIT:recordings/companion.mcap`.
"""

import argparse
import dataclasses
from pathlib import Path

import cv2
import numpy as np
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo

from cubeling.app.session.copying import copy_session
from cubeling.app.session.encoding import IMAGE_TOPIC
from cubeling.app.session.frames import H264Encoder
from cubeling.tracking import open_source

SIZE = (320, 180)
SECONDS = 2.0
EVERY = 3
"""Every how many frames one is kept."""


def cut(session: Path, path: Path, start: float) -> None:
    """Write the part of a session that begins at `start` [s]."""
    encode = H264Encoder(SIZE, 30 / EVERY)
    pictures: dict[float, bytes] = {}
    with open_source(str(session)) as source:
        part = (frame for frame in source if start <= frame.timestamp < start + SECONDS)
        for number, frame in enumerate(part):
            now = frame.timestamp
            if number % EVERY == 0:
                small = np.asarray(
                    cv2.resize(frame.image, SIZE, interpolation=cv2.INTER_AREA), np.uint8
                )
                small_frame = dataclasses.replace(frame, image=small, encoded=None, encoding="")
                pictures[now] = encode(small_frame).encoded or b""

    def change(topic: str, time: float, data: bytes) -> bytes | None:
        if topic == IMAGE_TOPIC and time in pictures:
            message = CompressedVideo.FromString(data)
            message.data = pictures[time]
            return bytes(message.SerializeToString())
        if topic == "/camera/calibration":
            return data
        if topic in ("/robot/wire", "/events"):
            return data if start <= time < start + SECONDS else None
        return data if time in pictures else None

    copy_session(session, path, change)


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("session", type=Path)
    parser.add_argument("new", type=Path)
    parser.add_argument("--start", type=float, default=0.0)
    arguments = parser.parse_args()
    cut(arguments.session, arguments.new, arguments.start)
