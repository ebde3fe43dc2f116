"""The picture of the guide docs/phone.md: the page on a phone, from the start to the games."""

import asyncio
from pathlib import Path

import cv2
import numpy as np

from tests.bench.web.camera import write_camera
from tests.bench.web.chromium import chromium
from tests.bench.web.playing import open_phone
from tests.bench.web.serving import say, serving

GUIDE_PICTURE = Path(__file__).parents[3] / "docs" / "pictures" / "phone.jpg"
PHONE, HEIGHT_PX, GAP_PX = (390, 844), 900, 24

SETTLE_S = 1.0
"""Time until what moves on the page has come to rest [s]."""

KISSING = "Turn the cube like a knob: right for more, left for less"
"""The hint while the character does something."""

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
        await open_phone(tab, served.address)
        await tab.run("$('delay').hidden = true")  # it says how busy the computer is that draws
        for number, (script, done) in enumerate(
            (
                ("true", "true"),
                (f"{AS_IT_IS}; $('go').click()", f"$('said').textContent === {KISSING!r}"),
                ("BUTTONS.games()", "true"),
            )
        ):
            await tab.run(script)
            await tab.until(done, 120.0)
            await asyncio.sleep(SETTLE_S)
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
