"""Which page's camera is that of the session."""

from types import SimpleNamespace
from typing import Any

from cubeling.app.ui.web.place import CAMERA_QUIET_S, CameraPlace
from tests.app.ui.web.test_server import JPEG, page_of, serve


def test_a_recording_keeps_its_camera_whoever_asks():
    async def use(server):
        async with page_of(server, "first") as first, page_of(server, "second") as second:
            await first.say(do="camera", name="ab12-back")
            await first.see(1, JPEG)
            await first.told("got")
            server.keeps_camera = True
            refused = "A recording keeps its camera: end it first"
            await second.say(do="camera", name="cd34-back", take=True)
            assert (await second.told("words"))["said"]["words"] == refused
            await first.say(do="camera", name="ab12-front")
            assert (await first.told("words"))["said"]["words"] == refused
            await first.see(2, JPEG)
            await first.told("got")
            assert server.feed.number == 1, "of the other side of the phone"
            await first.say(do="camera", name="ab12-back")
            await first.see(3, JPEG)
            await first.told("got")
            assert server.feed.number == 2
            await second.say(do="camera", name="ab12-back", take=True)  # its page was opened again
            await second.see(4, JPEG)
            await second.told("got")
            assert server.feed.number == 3

    serve(use)


def test_a_camera_that_sends_nothing_gives_its_place_up():
    now = [100.0]
    places: dict[str, list[str]] = {"first": [], "second": []}
    pages: Any = [
        SimpleNamespace(
            page=name, role="play", tell=lambda do, camera, name=name: places[name].append(camera)
        )
        for name in places
    ]
    first, second = pages
    place = CameraPlace(lambda: now[0])
    place.join(first)
    place.join(second)
    assert place.ask(first, take=False)
    for _ in range(3):
        now[0] += 0.9 * CAMERA_QUIET_S
        assert place.saw(first)
        place.check()
    assert not place.saw(second)
    now[0] += 1.1 * CAMERA_QUIET_S
    place.check()
    assert place.ask(second, take=False)
    assert places == {"first": ["free", "yours", "free", "other"],
                      "second": ["free", "other", "free", "yours"]}  # fmt: skip
