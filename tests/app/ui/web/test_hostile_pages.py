"""Pages that misbehave, read nothing or say nothing, and strangers: all others play on."""

import asyncio

import aiohttp
import pytest

from cubeling.app.ui.web.limits import WebLimits
from cubeling.app.ui.web.messages import PICTURE, pack
from cubeling.app.ui.web.server import LOOPBACK
from tests.app.ui.web.test_server import JPEG, TOKEN, WAIT_S, Drawn, page_of, serve, until

HUGE = JPEG.replace(b"\x00\x30\x00\x40", b"\xff\xdc\xff\xdc")
"""The same picture with a header that claims 65,500 x 65,500 pixels."""


def test_a_page_that_reads_nothing_holds_two_pictures_and_stalls_nobody():
    async def use(server):
        async with page_of(server, "slow") as slow, page_of(server, "quick") as quick:
            for number in range(1, 41):
                server.show(Drawn(number, size=300_000))
                assert await quick.picture() == number
                await quick.say(do="shown", id=number)
            server.say("done")
            seen: list[int] = []
            while len(seen) < 2:
                seen.append(await slow.picture())
            assert seen[0] == 1
            assert len(seen) == 2
            assert (await slow.told("words"))["said"] == {"words": "done", "language": ""}

    serve(use)


@pytest.mark.parametrize(
    ("what", "messages"),
    [
        ("a header of 65,500 pixels", [pack(PICTURE, 1, 0.0, HUGE)]),
        ("no JPEG", [pack(PICTURE, 1, 0.0, b"GIF89a" * 9)]),
        ("half a head", [b"\x01\x00"]),
        ("a time that is none", [pack(PICTURE, 1, float("nan"), JPEG)]),
        ("no JSON", ["{"]),
        ("another message", ['{"do":"format"}']),
        ("a name with a path", ['{"do":"camera","name":"../x"}']),
        ("a long text", ["x" * 5000]),
        ("a flood of texts", ['{"do":"tick"}'] * 2000),
        ("too large a message", [bytes(5 << 20)]),
    ],
)
def test_who_misbehaves_is_disconnected_and_others_play_on(what, messages):
    assert HUGE != JPEG

    async def use(server):
        async with page_of(server, "good", "window") as good:
            async with page_of(server, "evil") as evil:
                await evil.say(do="camera", name="evil")
                await evil.say(do="tick")
                await evil.told("tick")
                try:
                    for message in messages:
                        if isinstance(message, str):
                            await evil.socket.send_str(message)
                        else:
                            await evil.socket.send_bytes(message)
                except (ConnectionError, aiohttp.ClientError):
                    pass  # it was disconnected meanwhile
                assert await evil.why_closed() in (4000, 1009, 1006), what
            await until(lambda: [*server.clients] == ["good"])
            assert server.feed.number == 0
            await good.say(do="tick")
            await good.told("tick")

    serve(use)


def test_strangers_who_ask_nothing_are_let_go():
    async def use(server):
        opened = [await asyncio.open_connection(LOOPBACK, server.ports[0]) for _ in range(12)]
        for number, (_, writer) in enumerate(opened):
            writer.write(b"GET / HT" if number % 2 else b"")
        for reader, writer in opened:
            with pytest.raises((ConnectionError, asyncio.IncompleteReadError)):
                await asyncio.wait_for(reader.readexactly(1), WAIT_S)
            writer.close()
        async with page_of(server):
            pass

    serve(use, WebLimits(stranger_s=0.2, strangers=8, connections_per_s=200.0))


def test_there_is_room_for_so_many_pages():
    async def use(server):
        async with page_of(server, "first"), page_of(server, "second"):
            with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
                async with page_of(server, "third"):
                    pass
            assert refused.value.status == 503
            for token, why in ((TOKEN.text, 503), ("wrong-token", 403)):
                async with (
                    aiohttp.ClientSession(headers={"Authorization": f"Bearer {token}"}) as session,
                    session.get(f"http://{LOOPBACK}:{server.ports[0]}/token") as answer,
                ):
                    assert answer.status == why
            async with page_of(server, "second"):
                pass  # again

    serve(use, WebLimits(clients=2))


def test_a_page_that_says_nothing_is_let_go():
    async def use(server):
        async with page_of(server) as phone:
            assert await phone.why_closed() == 4000

    serve(use, WebLimits(idle_s=0.2))
