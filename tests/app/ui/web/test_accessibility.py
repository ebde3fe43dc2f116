"""Who sees nothing, or has a keyboard only, finds all that is on a page, in the page's language."""

import json
from pathlib import Path

import pytest

from tests.bench.web.chromium import program
from tests.bench.web.playing import open_phone

pytestmark = [
    pytest.mark.skipif(program() is None, reason="there is no Chromium: apt install chromium"),
    pytest.mark.slow("starts a browser and a session"),
    pytest.mark.full,
]

SEEN = Path(__file__).with_name("seen.js").read_text()

FOCUSED, CONTRASTS = "JSON.stringify(focusSeen())", "JSON.stringify(contrastsSeen())"


async def tree_of(tab):
    """Return role and name of all that a screen reader finds."""
    nodes = (await tab.call("Accessibility.getFullAXTree"))["nodes"]
    return [
        (each["role"]["value"], each.get("name", {}).get("value", ""))
        for each in nodes
        if not each["ignored"]
    ]


async def press(tab, key, code):
    for kind in ("keyDown", "keyUp"):
        await tab.call("Input.dispatchKeyEvent", type=kind, key=key, code=key,
                       windowsVirtualKeyCode=code, text="\r" if key == "Enter" else "")  # fmt: skip


async def focused_by_tab(tab, count):
    """Return what is focused after each press of the tabulator."""
    found = []
    for _ in range(count):
        await press(tab, "Tab", 9)
        found.append(json.loads(await tab.run(FOCUSED)))
    return found


def named(tree, role):
    return [name for each, name in tree if each == role]


async def check(tab):
    """Refuse buttons and pictures without names, and words that are hard to see."""
    tree = await tree_of(tab)
    for role in ("button", "image", "dialog", "radio", "textbox"):
        assert all(named(tree, role)), role
    contrasts = json.loads(await tab.run(CONTRASTS))
    assert contrasts
    assert {name: each for name, each in contrasts.items() if each < 4.5} == {}
    return tree


def test_a_screen_reader_and_a_keyboard_find_all_of_the_page(desk):
    async def use():
        tab = await desk.browser.tab()
        await tab.resize(390, 844, phone=True)
        await open_phone(tab, desk.served.address)
        await tab.call("Accessibility.enable")
        await tab.run(SEEN)
        tree = await check(tab)
        assert named(tree, "heading") == ["Cubeling"]
        assert {"Jugar", "Cámara y pantalla"} <= {*named(tree, "button")}
        rings = await focused_by_tab(tab, 2)
        assert {each["name"] for each in rings} == {"Jugar", "Cámara y pantalla"}
        while json.loads(await tab.run(FOCUSED))["name"] != "Jugar":
            await press(tab, "Tab", 9)
        await press(tab, "Enter", 13)
        await tab.until("playing && shown > 2", 60.0)
        tree = await check(tab)
        (picture,) = named(tree, "image")
        assert picture == "La imagen de la cámara con el personaje: Compañero"
        buttons = named(tree, "button")
        assert {*buttons} == {
            *("Elegir un juego", "Empezar de nuevo", "Guardar una foto"),
            *("La otra cámara", "Sonido", "Grabar", "Cámara y pantalla"),
        }
        rings += (found := await focused_by_tab(tab, len(buttons) + 1))
        assert {each["name"] for each in found} >= {*buttons}, "and nothing that is not seen"
        while json.loads(await tab.run(FOCUSED))["name"] != "Elegir un juego":
            await press(tab, "Tab", 9)
        await press(tab, "Enter", 13)
        tree = await check(tab)
        assert named(tree, "dialog") == ["¿A qué jugamos?"]
        assert "Compañero: Vleo besa o grita, y cambia el humor del robot" in named(tree, "button")
        focused = json.loads(await tab.run(FOCUSED))
        assert focused["name"].startswith("Compañero"), "what is played has the focus"
        await press(tab, "Escape", 27)
        assert not await tab.run("$('games').open")
        await tab.run("$('role').click()")
        assert named(await check(tab), "dialog") == ["¿Qué es este aparato?"]
        await tab.run("$('roles').close(); trouble('gone')")
        tree = await check(tab)
        assert named(tree, "alert")
        assert "Probar otra vez" in named(tree, "button")
        await tab.run("trouble('gone', false)")
        buttons = [each for each in rings if each["name"]]  # else the browser's own
        assert all(each["ring"] >= 3.0 and each["inside"] for each in buttons)
        await tab.call("Page.close")

    desk.use(use())


def test_nothing_moves_for_those_who_want_no_motion(desk):
    async def use():
        tab = await desk.browser.tab()
        moving = "document.getAnimations().filter(each => each instanceof CSSAnimation).length"
        await open_phone(tab, desk.served.address)
        assert await tab.run(moving) > 0
        reduced = {"name": "prefers-reduced-motion", "value": "reduce"}
        await tab.call("Emulation.setEmulatedMedia", features=[reduced])
        await tab.until(f"{moving} === 0")
        await tab.call("Page.close")

    desk.use(use())
