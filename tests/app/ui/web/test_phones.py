"""Several phones at one table, what happens to them, and the replay of what they have played."""

import asyncio

import cv2
import pytest

from cubeling.app.running.replay_check import check_session
from cubeling.app.session import SessionFile
from tests.bench.web.camera import PHONE_CAMERA, write_camera
from tests.bench.web.chromium import chromium, program
from tests.bench.web.playing import play
from tests.bench.web.serving import serving

pytestmark = [
    pytest.mark.skipif(program() is None, reason="there is no Chromium: apt install chromium"),
    pytest.mark.slow("starts a browser and sessions"),
    pytest.mark.full,
]

LONG_S = 60.0


async def goes_on(tab):
    """Wait until pictures come again."""
    before = await tab.run("shown")
    await tab.until(f"shown > {before + 2} || shown < {before}", LONG_S)


async def turn(tab, *, upright):
    """Turn a phone, and wait until the picture has turned."""
    await tab.run(f"isTurning = true; upright = {'true' if upright else 'false'}; openCamera()")
    sign = "<" if upright else ">"
    await tab.until(f"$('picture').width {sign} $('picture').height", LONG_S)


async def use_phones(browser, served, folder):
    """Let two phones play, and a third browser show what is drawn only; record a part of it."""
    first, second, clear = [await browser.tab() for _ in range(3)]
    for tab in (first, second):
        await tab.resize(844, 390, phone=True)
        await tab.before_each_page(PHONE_CAMERA)
    await play(first, served.at(served.port, "/?size=640"))
    await play(second, served.at(served.port, "/window"))
    await clear.open(served.at(served.port, "/view?background=none"))
    await clear.until("shown > 1", LONG_S)

    await second.run("becomes('camera')")  # a camera only, and the first one a screen
    await second.until("place === 'yours' && live()", LONG_S)
    await first.until("place === 'other' && !stream", LONG_S)
    await goes_on(first)
    assert await second.run("getComputedStyle($('picture')).display") == "none"
    await second.run("becomes('window')")  # and now the other way round
    await first.until("place === 'yours' && live()", LONG_S)
    await goes_on(second)

    await turn(first, upright=True)
    await turn(first, upright=False)
    await first.run("bar.record.click()")
    await first.until("session.recording > 0.5", LONG_S)
    other = await browser.tab(hides=True)  # hides the one that was opened last
    await other.call("Page.close")
    await first.run("takeCamera()")
    await first.until("!$('trouble').hidden")
    await first.run("isTaken = false")
    await goes_on(first)
    await first.run("window.isOld = true")
    await first.call("Page.reload")
    await first.until("!window.isOld && typeof playing === 'boolean' && shown > 2", LONG_S)
    await goes_on(second)
    long = await second.run("session.recording")
    await second.until(f"session.recording > {long} + 0.5", LONG_S)
    await second.run("bar.record.click()")  # whoever plays may end it
    await second.until("session.recording == null", LONG_S)

    await clear.picture(folder / "clear.png", transparent=True)
    for tab in (first, second, clear):
        assert not [each for each in tab.log if "exception" in each]


@pytest.mark.parametrize("options", [("--players", "2"), ("--cast", "human,vleo")], ids=" ".join)
def test_phones_share_a_table_and_the_session_replays_bit_for_bit(options, tmp_path):
    write_camera(tmp_path / "camera.mjpeg", "companion", 4.0)

    async def use():
        async with (
            chromium(tmp_path / "camera.mjpeg") as browser,
            serving(tmp_path, "--quality", "reduced", "--robot", "none", *options) as served,
        ):
            await use_phones(browser, served, tmp_path)

    asyncio.run(use())
    shown = cv2.imread(str(tmp_path / "clear.png"), cv2.IMREAD_UNCHANGED)
    assert shown is not None
    share = (shown[..., 3] > 0).mean()
    assert 0.005 < share < 0.6, "the characters, and nothing of the table"
    (path,) = tmp_path.glob("**/*.mcap")
    with SessionFile(path) as file:
        assert file.info.options.players == (2 if "--players" in options else 1)
        assert check_session(file, file.info.options).identical
