"""What clients that misbehave cost the player: a page without a browser plays beside them."""

import asyncio
import contextlib
import itertools
import multiprocessing
import os
import time
from multiprocessing.sharedctypes import Synchronized
from pathlib import Path

import aiohttp
import cv2

from cubeling.app.session.bundled import bundled_session
from cubeling.app.ui.web.messages import PICTURE, pack, unpack
from cubeling.tracking import open_source
from tests.bench.web.serving import TOKEN, Served, say, serving

WINDOW_S, ROUNDS = 5.0, 4
"""Length of a time with or without them [s], and how often both are measured."""


def frames() -> list[bytes]:
    """Return two seconds of a bundled recording, half as large, as JPEG."""
    with open_source(str(bundled_session("companion"))) as source:
        pictures = itertools.islice(source, 60)
        small = (cv2.resize(each.image, (640, 360)) for each in pictures)
        return [cv2.imencode(".jpg", each)[1].tobytes() for each in small]


class Player:
    """Sends pictures at 15 Hz, and counts those that come back."""

    def __init__(self, socket: aiohttp.ClientWebSocketResponse) -> None:
        self._socket = socket
        self.shown = 0
        self._tasks = [asyncio.create_task(self._send()), asyncio.create_task(self._read())]

    async def _send(self) -> None:
        for number, jpeg in enumerate(itertools.cycle(frames())):
            await self._socket.send_bytes(pack(PICTURE, number, time.monotonic(), jpeg))
            await asyncio.sleep(1 / 15)

    async def _read(self) -> None:
        async for message in self._socket:
            if message.type == aiohttp.WSMsgType.BINARY and message.data[0] == PICTURE:
                self.shown += 1
                await self._socket.send_json({"do": "shown", "id": unpack(message.data)[1]})
            elif message.type == aiohttp.WSMsgType.TEXT and message.json().get("camera") == "free":
                await self._socket.send_json({"do": "camera", "name": "bench"})

    async def rate(self, seconds: float) -> float:
        """Return how many pictures came back a second."""
        before, began = self.shown, time.monotonic()
        await asyncio.sleep(seconds)
        return (self.shown - before) / (time.monotonic() - began)

    def close(self) -> None:
        for task in self._tasks:
            task.cancel()


def _url(served: Served, page: str) -> str:
    return f"http://127.0.0.1:{served.port}/socket?role=play&attempt=1&page={page}"


async def _attack(port: int, session: aiohttp.ClientSession, kind: int) -> None:
    """Misbehave once, in one of ten ways."""
    url = f"http://127.0.0.1:{port}/socket?role=play&attempt=1&page=evil{kind}"
    if kind < 4:  # no token
        async with session.ws_connect(url, protocols=("cubeling", "wrong-token")):
            raise AssertionError("a stranger was let in")
    elif kind < 6:  # half a request, which never ends
        _, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(b"GET /socket HTTP/1.1\r\nHost: x\r\nX-A: ")
        await asyncio.sleep(1.0)
        writer.close()
    elif kind < 8:  # rubbish
        _, writer = await asyncio.open_connection("127.0.0.1", port)
        writer.write(bytes(range(256)) * 256)
        await asyncio.sleep(0.1)
        writer.close()
    else:  # the token, and then a flood of broken pictures, without reading
        async with session.ws_connect(url, protocols=("cubeling", TOKEN.text)) as socket:
            for _ in range(500):
                await socket.send_bytes(pack(PICTURE, 1, 0.0, b"\xff\xd8" + bytes(2000)))
            await asyncio.sleep(0.5)


async def _attack_for_ever(port: int, tries: "Synchronized[int]") -> None:
    async def one(session: aiohttp.ClientSession, kind: int) -> None:
        while True:
            with contextlib.suppress(OSError, aiohttp.ClientError, asyncio.TimeoutError):
                await _attack(port, session, kind)
            tries.value += 1
            await asyncio.sleep(0.02)

    async with aiohttp.ClientSession() as session:
        await asyncio.gather(*(one(session, kind) for kind in range(10)))


def _attackers(port: int, tries: "Synchronized[int]") -> None:
    """Run ten attackers in a process that takes only what the processor has left."""
    os.nice(15)
    asyncio.run(_attack_for_ever(port, tries))


async def hostile(folder: Path) -> None:
    """Ten clients at once misbehave; measure the player's rate with and without them."""
    spawning = multiprocessing.get_context("spawn")
    tries = spawning.Value("i", 0)
    async with (
        serving(folder, "--robot", "none", "--quality", "reduced") as served,
        aiohttp.ClientSession() as session,
        session.ws_connect(
            _url(served, "good"), protocols=("cubeling", TOKEN.text), max_msg_size=0
        ) as socket,
    ):
        player = Player(socket)
        while player.shown < 20:
            await asyncio.sleep(0.1)
        await player.rate(WINDOW_S)
        quiet, loud, memory = [], [], [served.resident_mb()]
        for _ in range(ROUNDS):
            quiet.append(await player.rate(WINDOW_S))
            memory.append(served.resident_mb())
            attackers = spawning.Process(target=_attackers, args=(served.port, tries))
            attackers.start()
            before = tries.value
            while tries.value == before:
                await asyncio.sleep(0.05)
            loud.append(await player.rate(WINDOW_S))
            attackers.terminate()
            attackers.join()
            memory.append(served.resident_mb())
        player.close()
    alone, beside = sum(quiet) / ROUNDS, sum(loud) / ROUNDS
    grown = [after - before for before, after in itertools.pairwise(memory)]
    say(f"the player alone:   {alone:.2f} Hz ({', '.join(f'{each:.1f}' for each in quiet)})")
    say(f"beside ten of them: {beside:.2f} Hz ({', '.join(f'{each:.1f}' for each in loud)})")
    say(f"it loses {100 * (1 - beside / alone):.1f} % (bar: 5 %) to {tries.value} attacks")
    say(
        f"memory grew by {sum(grown[1::2]):.1f} MB beside them, and by {sum(grown[::2]):.1f} MB "
        f"without, in {ROUNDS * WINDOW_S:.0f} s each "
        f"({', '.join(f'{each:+.0f}' for each in grown)})"
    )
