"""The picture of the guide docs/phone.md: the page on a phone, from the start to the games."""

import asyncio
from pathlib import Path

import cv2
import numpy as np

from tests.bench.web.camera import write_camera
from tests.bench.web.chromium import chromium
from tests.bench.web.serving import say, serving

GUIDE_PICTURE = Path(__file__).parents[3] / "docs" / "pictures" / "phone.jpg"
PHONE, HEIGHT_PX, GAP_PX = (390, 844), 900, 24

AS_IT_IS = (
    "(() => { const of = navigator.mediaDevices, get = of.getUserMedia.bind(of); "
    "of.getUserMedia = asked => { delete asked.video.width; delete asked.video.height; "
    "return get(asked); }; })()"
)
"""Lets the fake camera give its upright pictures, as a phone does that is held upright."""


async def picture(folder: Path) -> None:
    """Draw the picture of the guide about the page again."""
    camera, shots = folder / "camera.mjpeg", []
    write_camera(camera, "companion", 8.0, upright=True, clock=False)
    async with chromium(camera) as browser, serving(folder) as served:
        tab = await browser.tab()
        await tab.resize(*PHONE, phone=True)
        await tab.call("Emulation.setTouchEmulationEnabled", enabled=True, maxTouchPoints=5)
        await tab.open(served.address)
        await tab.until("!$('start').hidden && Object.keys(tiles).length > 3")
        for number, (script, seconds) in enumerate(
            (("true", 0.5), (f"{AS_IT_IS}; $('go').click()", 9.0), ("BUTTONS.games()", 1.0))
        ):
            await tab.run(script)
            await asyncio.sleep(seconds)
            await tab.picture(folder / f"{number}.png")
            shots.append(cv2.imread(str(folder / f"{number}.png")))
    width = round(HEIGHT_PX * PHONE[0] / PHONE[1])
    parts = [np.full((HEIGHT_PX, GAP_PX, 3), 255, np.uint8)] * 5
    for place, shot in enumerate(shots):
        assert shot is not None
        small = cv2.resize(shot, (width, HEIGHT_PX), interpolation=cv2.INTER_AREA)
        parts[2 * place] = np.asarray(small, np.uint8)
    cv2.imwrite(str(GUIDE_PICTURE), np.hstack(parts), (cv2.IMWRITE_JPEG_QUALITY, 86))
    say(f"{GUIDE_PICTURE.name} is drawn")
