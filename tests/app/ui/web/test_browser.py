"""The page in a real browser, where there is one."""

import asyncio

import pytest

from tests.bench.web.camera import write_camera
from tests.bench.web.chromium import chromium, program
from tests.bench.web.serving import serving

pytestmark = pytest.mark.skipif(program() is None, reason="there is no Chromium")


@pytest.mark.slow("starts a browser and a session")
@pytest.mark.full
def test_a_browser_plays_with_its_camera_and_goes_on_after_a_reload(tmp_path):
    async def use():
        camera = tmp_path / "camera.mjpeg"
        write_camera(camera, "companion", 1.0)
        async with chromium(camera, language="es") as browser, serving(tmp_path) as served:
            tab = await browser.tab()
            await tab.open(served.address)
            await tab.until("!$('start').hidden && Object.keys(tiles).length > 3")
            assert await tab.run("$('go').getAttribute('aria-label')") == "Jugar"
            for _ in range(2):
                await tab.run("$('go').click()")
                await tab.until("delays.length > 2", 60.0)
                assert await tab.run("$('picture').width") == 1280
                await tab.call("Page.reload")
                await tab.until("document.readyState === 'complete' && !$('start').hidden")
            assert not [each for each in tab.log if "exception" in each]

    asyncio.run(use())
