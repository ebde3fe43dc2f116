"""The pictures of the guides about pages: a phone that plays, a study on a phone, the desk."""

import asyncio
from pathlib import Path

import cv2
import numpy as np

from tests.bench.web.camera import write_camera
from tests.bench.web.chromium import Tab, chromium
from tests.bench.web.playing import open_phone
from tests.bench.web.serving import running, say, serving

PICTURES = Path(__file__).parents[3] / "docs" / "pictures"
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
    """Draw the pictures of the guides about pages again."""
    camera = folder / "camera.mjpeg"
    write_camera(camera, "companion", 8.0, upright=True, clock=False)
    async with chromium(camera) as browser:
        async with serving(folder, "--wizard") as served:
            tab = await browser.tab()
            await tab.resize(*PHONE, phone=True)
            await open_phone(tab, served.address)
            await tab.run("$('delay').hidden = true")  # it says how busy the computer is that draws
            playing = f"$('said').textContent === {KISSING!r}"
            shots = [
                await _shot(tab, folder, "true", "true"),
                await _shot(tab, folder, f"{AS_IT_IS}; $('go').click()", playing),
                await _shot(tab, folder, "BUTTONS.games()", "true"),
            ]
            _write("phone", shots)
            await tab.run("$('games').close()")
            desk = await browser.tab()
            await desk.resize(1280, 800)
            await desk.open(served.desk)
            await desk.until("!$('picture').hidden && state.groups?.length")
            for key in (" ", "1"):
                await desk.run(
                    f"document.onkeydown({{key: '{key}', target: {{}}, preventDefault() {{}}}})"
                )
                await asyncio.sleep(SETTLE_S / 2)
            _write("wizard-desk", [await _shot(desk, folder, "true", "state.acts.length > 1")])
        (folder / "study.toml").write_text(STUDY)
        command = ["study", "run", "study.toml", "-o", "s", "--participant", "P01", "--page"]
        async with running(folder, *command, "--source", "phone", "--robot", "none") as study:
            tab = await browser.tab()
            await tab.resize(*PHONE, phone=True)
            await tab.open(study.address)
            asked = "Boolean(document.querySelector('#sheet button'))"
            next_one = "document.querySelector('#sheet button').click()"
            shots = [
                await _shot(tab, folder, AS_IT_IS, asked),
                await _shot(tab, folder, next_one, f"$('sheet').hidden && {playing}"),
                await _shot(
                    tab,
                    folder,
                    "done.click()",
                    f"{asked} && Boolean(sheet.querySelector('img[src]'))",
                ),
            ]
            _write("study-phone", shots)


STUDY = """
title = "A study on a phone"
[[phase]]
name = "p"
parts = ["Play with Vleo", "after"]
[[task]]
name = "Play with Vleo"
title = "Play with Vleo"
text = "Turn the cube until Vleo throws kisses. Touch the tick when you have seen enough."
scenario = "companion"
goal = { value = "mood", equals = "happy" }
limit_s = 300
ends = "person"
[[questionnaire]]
name = "after"
title = "After the game"
[[questionnaire.item]]
name = "fun"
text = "How much fun was it?"
pictures = ["faces"]
"""


async def _shot(tab: Tab, folder: Path, script: str, done: str) -> np.ndarray:
    """Run a script, wait until it has shown what it does, and return the picture of the page."""
    await tab.run(script)
    await tab.until(done, 120.0)
    await asyncio.sleep(SETTLE_S)
    await tab.picture(folder / "shot.png")
    shot = cv2.imread(str(folder / "shot.png"))
    assert shot is not None
    return shot


def _write(name: str, shots: list[np.ndarray]) -> None:
    """Write pictures side by side as one of the guides."""
    parts = []
    for shot in shots:
        width = round(HEIGHT_PX * shot.shape[1] / shot.shape[0])
        small = cv2.resize(shot, (width, HEIGHT_PX), interpolation=cv2.INTER_AREA)
        parts += [np.asarray(small, np.uint8), np.full((HEIGHT_PX, GAP_PX, 3), 255, np.uint8)]
    path = PICTURES / f"{name}.jpg"
    cv2.imwrite(str(path), np.hstack(parts[:-1]), (cv2.IMWRITE_JPEG_QUALITY, 86))
    say(f"{path.name} is drawn")
