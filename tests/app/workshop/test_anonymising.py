"""Anonymised sessions: sharp at the cube, blurred elsewhere, and the same in all other channels."""

import shutil
from dataclasses import replace

import cv2
import numpy as np
import pytest

from cubeling.app.session import SessionFile, messages
from cubeling.app.session.encoding import IMAGE_TOPIC, encode
from cubeling.app.workshop.anonymising import BLOCKS_ACROSS, blurred, sharp_region, without_room
from cubeling.tracking import Intrinsics, open_source
from cubeling.tracking.appearance import (
    ENVIRONMENT_PX,
    Appearance,
    EnvironmentMap,
    PictureQuality,
)

EDGE = 0.06


def pose(x, y, z):
    matrix = np.eye(4)
    matrix[:3, 3] = x, y, z
    return matrix


def test_what_is_sharp_holds_the_cube_and_the_table_around_it():
    lens = Intrinsics.guess((640, 360))
    cube = pose(0.0, 0.0, 0.5)
    focal = lens.matrix[0, 0]
    alone = sharp_region((360, 640), ((cube, None),), lens, EDGE)
    half = focal * 0.045 / (0.5 - 0.045)  # the nearest face, with its margin
    assert np.ptp(np.flatnonzero(alone.any(0))) == pytest.approx(2 * half, abs=2)
    table = pose(0.1, 0.03, 0.6)  # its y axis is the camera's: seen from its edge
    both = sharp_region((360, 640), ((cube, table),), lens, EDGE)
    assert (both >= alone).all()
    assert np.ptp(np.flatnonzero(both.any(0))) == pytest.approx(2 * focal * 0.16 / 0.5, rel=0.1)
    assert not sharp_region((360, 640), (), lens, EDGE).any()
    assert not sharp_region((360, 640), ((pose(0, 0, 0.0), None),), lens, EDGE).any()


def test_what_is_not_sharp_has_no_detail_left():
    noise = np.random.default_rng(1).integers(0, 256, (360, 640, 3), np.uint8)
    mask = np.zeros((360, 640), np.uint8)
    mask[100:200, 300:400] = 255
    picture = blurred(noise, mask)
    assert (picture[mask > 0] == noise[mask > 0]).all()
    outside = picture.astype(float)[:90]
    assert outside.std() < noise.std() / 10
    step = 640 // BLOCKS_ACROSS
    neighbours = np.abs(np.diff(outside, axis=1)).mean()
    assert neighbours < np.abs(outside[:, step:] - outside[:, :-step]).mean() / 4


def test_the_map_of_the_room_is_left_out():
    planes = np.full((18 * ENVIRONMENT_PX, ENVIRONMENT_PX), 90, np.uint8)
    seen = Appearance(None, None, PictureQuality(0.7, 2.0), 0.5)
    shown = replace(seen, room=EnvironmentMap(planes, np.zeros(3), 1.0, 0.5))
    assert without_room(encode(shown)) == encode(seen)


@pytest.mark.slow(reason="a session is blurred and tracked again")
def test_an_anonymised_session_differs_in_its_pictures_only(cubeling, short_session):
    shutil.copyfile(short_session, "part.mcap")
    code, out, err = cubeling("anonymise", "part.mcap", "-o", "shared.mcap")
    assert (code, err) == (0, "")
    assert "pictures blurred" in out
    code, out, _ = cubeling("diff", "part.mcap", "shared.mcap")
    channels = [line.split()[0] for line in out.splitlines() if line.strip().startswith("/")]
    assert (code, channels) == (1, [IMAGE_TOPIC])
    code, out, _ = cubeling("replay", "shared.mcap", "--no-pictures")
    assert "100.0 % of the frames" in out
    with open_source("part.mcap") as one, open_source("shared.mcap") as other:
        for first, second in zip(one, other, strict=True):
            change = np.abs(first.image.astype(float) - second.image)
            assert change[:40].mean() > change.min()  # the background is another one
    code, _, err = cubeling("anonymise", "part.mcap", "-o", "part.mcap", "--overwrite")
    assert (code, len(err.splitlines())) == (2, 1)


@pytest.mark.full
@pytest.mark.slow(reason="a part of a recording is tracked, twice")
def test_a_session_without_video_has_all_but_the_pictures(cubeling, tmp_path, bundled_session):
    part = ("--no-pictures", "--start", 2, "--end", 3.0, "--record", "part.mcap")
    assert cubeling("replay", bundled_session, *part)[0] == 0
    play = ("play", "companion", "--source", "part.mcap", "--no-pictures", "--no-video")
    assert cubeling(*play, "--record", "blind.mcap")[0] == 0
    _, out, _ = cubeling("diff", "part.mcap", "blind.mcap")
    channels = [line.split()[0] for line in out.splitlines() if line.strip().startswith("/")]
    assert channels == [IMAGE_TOPIC]
    pictures = {data for _, _, data in messages(tmp_path / "blind.mcap", IMAGE_TOPIC)}
    assert max(map(len, pictures)) < 20_000
    with open_source(str(tmp_path / "blind.mcap")) as source:
        assert not any(frame.image.any() for frame in source)
    with SessionFile(tmp_path / "blind.mcap") as session:
        assert not session.info.has_video
    # It is replayed from where the cube was, to the same end.
    assert cubeling("replay", "blind.mcap", "--no-pictures", "--record", "again.mcap")[0] == 0
    _, out, _ = cubeling("diff", "blind.mcap", "again.mcap")
    assert "/character/pose" not in out
    with SessionFile(tmp_path / "again.mcap") as session:
        assert not session.info.has_video
    # Its film shows the cube and the character in a plain room, not in the dark.
    assert cubeling("replay", "blind.mcap", "--start", 0.8, "-o", "film.png")[0] == 0
    sheet = cv2.imread("film.png")
    assert sheet is not None
    film = sheet[len(sheet) // 8 :].astype(int)
    assert np.median(film) > 100
    assert (film.min(axis=2) > 200).any()  # the paper of the cube, and the cards
    assert (np.ptp(film, axis=2) > 60).mean() > 0.005  # the character's colours
    for command in (
        ("play", "companion", "--source", "blind.mcap", "--no-pictures"),
        ("replay", "blind.mcap", "--check"),
        ("anonymise", "blind.mcap", "-o", "x.mcap"),
    ):
        code, _, err = cubeling(*command)
        assert (code, len(err.splitlines())) == (2, 1)
