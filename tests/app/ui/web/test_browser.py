"""The page in a real browser, where there is one."""

import hashlib
import json

import pytest

from cubeling.tracking import open_source
from tests.bench.web.chromium import program
from tests.bench.web.playing import open_phone, play, time_to_picture

pytestmark = [
    pytest.mark.skipif(program() is None, reason="there is no Chromium: apt install chromium"),
    pytest.mark.slow("starts a browser and a session"),
    pytest.mark.full,
]

ROLE = "$('role').textContent"

HASH_PICTURES = """(() => {
  const own = send;
  window.sent = [];
  send = async (jpeg, taken) => {
    own(jpeg, taken);
    const digest = await crypto.subtle.digest("SHA-256", await jpeg.arrayBuffer());
    sent.push(Array.from(new Uint8Array(digest), b => b.toString(16).padStart(2, "0")).join(""));
  };
})()"""

COUNT_SAMPLES = """(async () => {
  const counter = `registerProcessor("counter", class extends AudioWorkletProcessor {
    process([[left]]) {
      this.heard = (this.heard || 0) + (left || []).filter(each => each !== 0).length;
      this.port.postMessage(this.heard);
      return true;
    }
  })`;
  const script = new Blob([counter], {type: "text/javascript"});
  await audio.audioWorklet.addModule(URL.createObjectURL(script));
  const node = new AudioWorkletNode(audio, "counter");
  node.port.onmessage = message => { window.heardSamples = message.data; };
  loudness.connect(node);
  return audio.state;
})()"""


def errors(*tabs):
    return [each for tab in tabs for each in tab.log if "exception" in each]


def test_a_browser_plays_and_goes_on_after_a_reload_and_faults_of_its_line(desk):
    async def use():
        tab = await desk.browser.tab()
        await open_phone(tab, desk.served.at(desk.proxy.port))
        assert await tab.run("$('go').getAttribute('aria-label')") == "Jugar"
        await tab.run("$('go').click()")
        await tab.until("delays.length > 2", 60.0)
        assert await tab.run("$('picture').width") == 1280
        await tab.run("window.isOld = true")
        await tab.call("Page.reload")
        await tab.until("!window.isOld && typeof delays !== 'undefined' && delays.length > 2")
        assert await tab.run("$('start').hidden"), "nobody has touched it"
        await tab.run("window.onpicture = (id, taken) => { window.lastTaken = taken; }; true")
        proxy = desk.proxy
        for fault in (proxy.stall(0.5), proxy.cut(0.0), proxy.cut(2.0), proxy.forget(0.5)):
            await fault
            await time_to_picture(tab, 20.0)
        assert not errors(tab)
        await tab.call("Page.close")

    desk.use(use())


def test_a_recording_holds_the_very_pictures_that_the_browser_has_sent(desk):
    async def use():
        tab = await desk.browser.tab()
        await play(tab, desk.served.address)
        await tab.run(HASH_PICTURES)
        before = await tab.run("shown")
        await tab.until(f"shown > {before + 5}")
        await tab.run("bar.record.click()")
        await tab.until("session.recording > 1.0", 60.0)
        await tab.run("bar.record.click()")
        await tab.until("session.recording == null && !$('role').hidden", 60.0)
        sent = {*json.loads(await tab.run("JSON.stringify(sent)"))}
        assert not errors(tab)
        await tab.call("Page.close")
        (path,) = desk.served.folder.glob("**/*.mcap")
        with open_source(str(path)) as frames:
            kept = [hashlib.sha256(frame.encoded or b"").hexdigest() for frame in frames]
        assert kept
        assert {*kept} <= sent

    desk.use(use())


def test_a_second_phone_is_a_screen_and_each_may_become_the_camera(desk):
    async def use():
        first, second = await desk.browser.tab(), await desk.browser.tab()
        await play(first, desk.served.address)
        await open_phone(second, desk.served.address)
        assert await second.run(ROLE) == "Pantalla: otro es la cámara"
        await second.run("$('go').click()")
        await second.until("shown > 2")
        # On a loaded machine the first may be silent for so long that its place is given away.
        assert await second.run("!stream || place === 'yours'"), "its camera is not opened"
        await second.run("roles.play.click()")
        await second.until("place === 'yours' && live()")
        await first.until("place === 'other' && !stream")
        assert await second.run(ROLE) == "Cámara y pantalla"
        await second.run("roles.camera.click()")
        await second.until("role === 'camera' && place === 'yours'")
        assert await second.run("location.pathname") == "/camera"
        assert await second.run("getComputedStyle($('picture')).display") == "none"
        before = await first.run("shown")
        await first.until(f"shown > {before + 3}")
        await second.run("roles.window.click()")
        await first.until("place === 'yours' && live()")
        assert not errors(first, second)
        for tab in (first, second):
            await tab.call("Page.close")

    desk.use(use())


def test_what_is_typed_on_the_page_is_said_to_the_character(desk):
    async def use():
        tab = await desk.browser.tab()
        await play(tab, desk.served.address)
        assert await tab.run("$('talk').hidden"), "nobody listens in companion"
        await tab.run("say({do: 'play', name: 'talk'})")
        await tab.until("!$('talk').hidden", 60.0)
        await tab.run("line.focus()")
        await tab.call("Input.insertText", text="¿Qué comes?")
        await tab.run("$('talk').requestSubmit()")
        await tab.until("session.hint.words.includes('¿Qué comes?')", 60.0)
        assert await tab.run("line.value") == ""
        await tab.run("say({do: 'play', name: 'companion'})")
        await tab.until("$('talk').hidden", 60.0)
        assert not errors(tab)
        await tab.call("Page.close")

    desk.use(use())


def test_the_sound_of_the_session_is_heard_in_the_browser(desk):
    async def use():
        tab = await desk.browser.tab()
        await tab.call("Page.setBypassCSP", enabled=True)
        await play(tab, desk.served.address)
        assert await tab.run(COUNT_SAMPLES) == "running"
        await tab.run("bar.again.click()")  # it sounds
        await tab.until("window.heardSamples > 4800", 60.0)
        await tab.run("bar.sound.click()")
        assert json.loads(await tab.run("JSON.stringify([loudness.gain.value, muted])")) == [
            0,
            True,
        ]
        assert not errors(tab)
        await tab.call("Page.close")

    desk.use(use())
