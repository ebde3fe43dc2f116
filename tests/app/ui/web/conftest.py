"""A browser and a server beside the tests of this folder that need a real one."""

import asyncio
from contextlib import AsyncExitStack
from types import SimpleNamespace

import pytest

from tests.bench.web.camera import write_camera
from tests.bench.web.chromium import chromium
from tests.bench.web.faulty_proxy import FaultyProxy
from tests.bench.web.serving import serving


@pytest.fixture(scope="module")
def desk(tmp_path_factory):
    """Yield a browser, a server and a faulty line to it, with the loop that they live in."""
    loop, folder, closing = (
        asyncio.new_event_loop(),
        tmp_path_factory.mktemp("web"),
        AsyncExitStack(),
    )
    write_camera(folder / "camera.mjpeg", "companion", 2.0)

    async def start():
        browser = await closing.enter_async_context(chromium(folder / "camera.mjpeg", "es"))
        served = await closing.enter_async_context(serving(folder, "--quality", "reduced"))
        proxy = await closing.enter_async_context(FaultyProxy(served.port))
        return SimpleNamespace(
            browser=browser, served=served, proxy=proxy, use=loop.run_until_complete
        )

    try:
        yield loop.run_until_complete(start())
    finally:
        loop.run_until_complete(closing.aclose())
        loop.close()
