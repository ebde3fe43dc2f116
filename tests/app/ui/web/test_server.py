"""The page and its server: who is let in, what is exchanged, and clients that misbehave."""

import asyncio
import re
import time
from contextlib import asynccontextmanager, closing
from dataclasses import dataclass

import aiohttp
import cv2
import numpy as np
import pytest

from cubeling.app.admission import Token
from cubeling.app.ui.web.acceptor import Listener
from cubeling.app.ui.web.content import MAX_SENT_BYTES
from cubeling.app.ui.web.language import English
from cubeling.app.ui.web.messages import PICTURE, SOUND, pack, read_said, unpack
from cubeling.app.ui.web.page import MAX_PAGE_BYTES, document
from cubeling.app.ui.web.server import LOOPBACK, WebServer
from tests.bench.web.sizes import pages, sizes

WAIT_S = 20.0
TOKEN = Token("open-sesame")
JPEG = cv2.imencode(".jpg", np.full((48, 64, 3), 90, np.uint8))[1].tobytes()


@dataclass
class Drawn:
    """A picture for pages."""

    number: int
    size: int = 1000

    def data(self, look):
        return bytes(self.size) if look[0] == "cards en" else None

    def taken(self, page):
        return 0.0


class Client:
    """A page without a browser."""

    def __init__(self, socket):
        self.socket = socket

    async def say(self, **message):
        await self.socket.send_json(message)

    async def see(self, number, jpeg, taken=1.0):
        await self.socket.send_bytes(pack(PICTURE, number, taken, jpeg))

    async def told(self, do):
        """Return the next message of a kind, and skip others; no picture may come before it."""
        while True:
            message = await asyncio.wait_for(self.socket.receive(), WAIT_S)
            if message.type == aiohttp.WSMsgType.TEXT and message.json()["do"] == do:
                return message.json()
            assert message.type == aiohttp.WSMsgType.TEXT, message

    async def picture(self):
        while True:
            message = await asyncio.wait_for(self.socket.receive(), WAIT_S)
            if message.type == aiohttp.WSMsgType.BINARY:
                return unpack(message.data)[1]

    async def why_closed(self):
        while not self.socket.closed:
            await asyncio.wait_for(self.socket.receive(), WAIT_S)
        return self.socket.close_code


@asynccontextmanager
async def page_of(server, name="page", role="play", token=TOKEN.text, headers=None, attempt=1):
    url = f"http://{LOOPBACK}:{server.ports[0]}/socket?page={name}&role={role}&attempt={attempt}"
    async with (
        aiohttp.ClientSession() as session,
        session.ws_connect(
            url, protocols=("cubeling", token), headers=headers, autoping=True
        ) as socket,
    ):
        client = Client(socket)
        await client.told("welcome")
        yield client


def serve(use, limits=None):
    """Run a coroutine function with a server."""
    with closing(WebServer([Listener(LOOPBACK, 0)], TOKEN, {"rate": 48000}, limits)) as server:
        asyncio.run(use(server))


async def until(condition):
    end = time.monotonic() + WAIT_S
    while not condition():
        assert time.monotonic() < end
        await asyncio.sleep(0.005)


def test_the_page_is_small_and_loads_nothing_from_elsewhere():
    assert set(sizes()) == {"play", "window", "camera", "view", "study", "desk"}
    assert max(sizes().values()) <= MAX_PAGE_BYTES
    for found in (each for documents in pages().values() for each in documents.values()):
        text = found.body.decode().replace("http://www.w3.org/2000/svg", "")
        assert not re.search(
            r"(https?:)?//[a-z0-9]", re.sub("https:// or? http://localhost", "", text)
        )
        assert "/*" not in text, "no comments"
        assert "default-src 'none'" in found.headers["Content-Security-Policy"]


def test_only_who_knows_the_token_is_let_in():
    async def use(server):
        for token, headers in (
            ("wrong-token", None),
            ("none", None),
            (TOKEN.text, {"Origin": "http://elsewhere.example"}),
        ):
            with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
                async with page_of(server, token=token, headers=headers):
                    pass
            assert refused.value.status == 403
        async with aiohttp.ClientSession() as session:
            root = f"http://{LOOPBACK}:{server.ports[0]}"
            async with session.get(f"{root}/") as answer:
                assert answer.status == 200
                assert "frame-ancestors 'none'" in answer.headers["Content-Security-Policy"]
            async with session.get(
                f"{root}/token", headers={"Authorization": f"Bearer {TOKEN.text}"}
            ) as answer:
                assert answer.status == 204
                assert answer.headers["Connection"] == "close", "each look has its own connection"
            for path in ("/etc/passwd", "/page.js", "/socket", "/../server.py"):
                async with session.get(root + path) as answer:
                    assert answer.status in (403, 404)

    serve(use)


def test_a_picture_arrives_with_its_very_bytes_and_is_acknowledged():
    async def use(server):
        async with page_of(server) as phone:
            await phone.say(do="camera", name="ab12-back")
            await phone.see(7, JPEG, 12.5)
            assert (await phone.told("got"))["id"] == 7
            await until(lambda: server.feed.number == 1)
            _, jpeg, _ = server.feed.next(0, 0.0)
            assert jpeg == JPEG
            assert server.camera == "ab12-back"
            assert server.feed.size == (64, 48)
            assert server.taken_by(jpeg) == ("page", 12.5)
            assert server.taken_by(bytes(JPEG[:1] + JPEG[1:])) == ("", 0.0), "by identity"

    serve(use)


def test_one_phone_is_the_camera_and_its_place_is_free_when_it_leaves():
    async def use(server):
        async with page_of(server, "second") as second:
            assert (await second.told("place"))["camera"] == "free"
            async with page_of(server, "first") as first:
                await first.say(do="camera", name="first")
                assert (await second.told("place"))["camera"] == "other"
                await first.see(1, JPEG)
                await first.told("got")
                await second.say(do="camera", name="second")
                await second.see(1, JPEG)
                await second.told("got")
                assert server.camera == "first"
                assert server.feed.number == 1
            assert (await second.told("place"))["camera"] == "free"
            await second.say(do="camera", name="second")
            assert (await second.told("place"))["camera"] == "yours"
            assert server.camera == "second"

    serve(use)


def test_a_phone_may_take_the_place_of_another_and_a_window_cannot():
    async def use(server):
        async with (
            page_of(server, "first", "camera") as first,
            page_of(server, "second") as second,
            page_of(server, "third", "window") as third,
        ):
            await first.say(do="camera", name="first")
            await second.told("place")
            assert (await second.told("place"))["camera"] == "other"
            await second.say(do="camera", name="second", take=True, mirror=True)
            assert (await second.told("place"))["camera"] == "yours"
            await third.say(do="camera", name="third", take=True)
            await third.say(do="tick")
            await third.told("tick")
            await first.told("place")
            assert (await first.told("place"))["camera"] == "yours"
            assert (await first.told("place"))["camera"] == "other"
            assert server.camera == "second"
            assert [each.mirror for each in server.take_requests()] == [False, True]

    serve(use)


def test_a_page_that_is_connected_anew_keeps_its_place_unless_it_is_another_thing_now():
    async def use(server):
        async with page_of(server) as before:
            await before.say(do="camera", name="ab12")
            await before.see(1, JPEG)
            await before.told("got")
            async with page_of(server) as again:
                assert (await again.told("place"))["camera"] == "yours"
                assert await before.why_closed() == 4000
                await again.see(2, JPEG)
                await again.told("got")
                assert server.feed.number == 2
                async with page_of(server, role="window") as window:
                    assert (await window.told("place"))["camera"] == "free"

    serve(use)


class Desk:
    """What another page than the players' serves."""

    def get(self, place):
        return ("text/plain", b"secret") if place == "state" else None

    def post(self, data):
        return "text/plain", data.upper()


def test_what_is_opened_has_a_token_of_its_own():
    desk = Token("the-wizards-own")

    async def use(server):
        server.open(
            "/desk", Desk(), desk, document("desk.html", ["base.css"], ["base.js"], ["desk"])
        )
        server.open("/shown", Desk())
        bearers = {token.text: {"Authorization": f"Bearer {token.text}"} for token in (TOKEN, desk)}
        here = f"http://localhost:{server.ports[0]}"
        assert server.addresses("/desk", desk) == [f"{here}/desk#{desk.text}"]
        async with aiohttp.ClientSession(f"http://{LOOPBACK}:{server.ports[0]}") as session:
            async with session.get("/desk") as found:
                assert "sha256-" in found.headers["Content-Security-Policy"]
            for path, token, status in (
                ("/desk/state", desk, 200),
                ("/desk/other", desk, 404),
                ("/desk/state", TOKEN, 403),
                ("/shown/state", TOKEN, 200),
                ("/shown/state", desk, 403),
                ("/token", desk, 403),
                ("/nothing/state", desk, 404),
            ):
                async with session.get(path, headers=bearers[token.text]) as found:
                    assert found.status == status, (path, token)
            async with session.get("/desk/state") as found:
                assert found.status == 403
            for data, token, status in (
                (b"say", desk, 200),
                (b"say", TOKEN, 403),
                (b"", desk, 413),
                (bytes(MAX_SENT_BYTES + 1), desk, 413),
            ):
                async with session.post("/desk", data=data, headers=bearers[token.text]) as found:
                    assert found.status == status
                    assert status != 200 or await found.read() == data.upper()

    serve(use)


def test_a_connection_that_was_held_up_does_not_replace_a_later_one():
    async def use(server):
        async with page_of(server, attempt=7) as phone:
            with pytest.raises(aiohttp.WSServerHandshakeError) as refused:
                async with page_of(server, attempt=6):
                    pass
            assert refused.value.status == 409
            await phone.say(do="tick")
            await phone.told("tick")

    serve(use)


def test_who_comes_later_is_told_the_present_state():
    async def use(server):
        server.tell("sheet", html="first")
        server.tell("sheet", html="second")
        async with page_of(server) as phone:
            assert (await phone.told("sheet"))["html"] == "second"

    serve(use)


def test_each_page_is_told_in_its_language():
    async def use(server):
        server.tell("status", hint=English("Show me the cube"), own=[English("Of my own")])
        async with page_of(server) as one, page_of(server, "dos1&language=es") as other:
            for page, words in ((one, "Show me the cube"), (other, "Enséñame el cubo")):
                told = await page.told("status")
                language = "es" if page is other else "en"
                assert told["hint"] == {"words": words, "language": language}
                assert told["own"] == [{"words": "Of my own", "language": ""}]

    serve(use)


def test_players_ask_and_viewers_cannot():
    async def use(server):
        async with page_of(server, "view", "view") as view, page_of(server, "play") as play:
            await view.say(do="snapshot")
            await view.say(do="tick")
            await view.told("tick")
            await play.say(do="play", name="follow")
            await play.say(do="tick")
            await play.told("tick")
            assert server.take_requests() == [read_said('{"do":"play","name":"follow"}')]
            assert server.take_requests() == []
            assert server.wanted == {("plain", 0), ("cards en", 0)}

    serve(use)


def test_a_camera_beside_a_screen_gets_neither_pictures_nor_sound():
    async def use(server):
        async with page_of(server, "camera", "camera") as camera, page_of(server) as screen:
            server.show(Drawn(1))
            assert await screen.picture() == 1
            server.sound(pack(SOUND, 2, 0.0, bytes(8)))
            sound = await asyncio.wait_for(screen.socket.receive(), WAIT_S)
            while sound.type == aiohttp.WSMsgType.TEXT:
                sound = await asyncio.wait_for(screen.socket.receive(), WAIT_S)
            assert sound.data == pack(SOUND, 2, 0.0, bytes(8))
            await camera.say(do="tick")
            await camera.told("tick")  # and nothing binary came before it

    serve(use)


def test_at_most_two_pictures_are_on_their_way_and_the_newest_is_next():
    async def use(server):
        async with page_of(server) as phone:
            for number in (1, 2):
                server.show(Drawn(number))
                assert await phone.picture() == number
            for number in range(3, 50):
                server.show(Drawn(number))
            await phone.say(do="tick")
            await phone.told("tick")  # and no picture came before it
            await phone.say(do="shown", id=1)
            assert await phone.picture() == 49

    serve(use)
