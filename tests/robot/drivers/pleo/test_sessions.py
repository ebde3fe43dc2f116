"""Long sessions with the simulated Pleo in virtual time: discipline, truth and recovery."""

import numpy as np
import pytest
from hypothesis import given, strategies as st

from cubeling.affect import Emotion
from cubeling.robot.drivers.pleo import timing
from cubeling.robot.drivers.pleo.driver import PleoDriver
from cubeling.robot.drivers.pleo.settings import load_settings
from cubeling.robot.protocol import messages as m
from cubeling.robot.simulators.memory import simulator_of
from tests.examples import some

MOODS = ("neutral", "happy", "angry")

HEARS_OF_SILENCE = timing.PING_INTERVAL_S + timing.DEGRADED_AFTER_S
"""A console that falls silent is not called ready for longer than this [s]."""

GIVES_UP = (
    timing.LONG_TIMEOUT_S + timing.MAX_NUDGES * timing.NUDGE_INTERVAL_S + timing.PING_INTERVAL_S
)
"""… and is called lost after this [s], whatever was on its way."""

COMES_BACK = 12.0
"""A console that answers again is ready within this [s]: a search, and three slow answers."""


def wander(world, random, chance: float = 0.004):
    """Return what asks for moods, actions and stops as they come."""

    def each() -> None:
        if random.random() > chance:
            return
        match int(random.integers(6)):
            case 0:
                world.driver.stop()
            case 1:
                world.driver.play(m.ITEM_MOTION, int(random.integers(2)))
            case 2:
                world.driver.play(m.ITEM_SOUND, 0)
            case _:
                world.express(str(random.choice(MOODS)))

    return each


@pytest.mark.parametrize("seed", some(range(4)))
def test_nothing_is_typed_before_the_prompt_and_only_what_is_allowed(pleo_world, allowed, seed):
    world = pleo_world(seed, cut_reads=True)
    random = np.random.default_rng(seed)
    world.run(120, wander(world, random))
    assert len(world.robot.executed) > 30
    assert list(world.robot.violations) == []
    assert all(allowed.fullmatch(line) for _, line in world.sent)


@pytest.mark.parametrize("seed", some(range(6)))
def test_the_last_mood_asked_is_the_one_that_ends_up_playing(pleo_world, seed):
    world = pleo_world(seed)
    world.robot.slow_probability = world.robot.error_probability = 0.1
    random = np.random.default_rng(seed)
    world.run(60, wander(world, random, chance=0.02))
    world.express("neutral")
    world.run(1)
    world.express("happy")
    world.run_until(
        lambda: world.playing("happy") and world.telemetry.acknowledged is not None, within=60
    )
    world.run_until(lambda: world.robot.portrait()[1] == "happy", within=10)
    assert list(world.robot.violations) == []


@pytest.mark.parametrize("seed", some(range(8)))
def test_after_a_reboot_the_mood_is_back_and_the_application_is_not(pleo_world, seed):
    world = pleo_world(seed)
    world.robot.slow_probability = 0.0
    world.express("angry")
    world.run_until(lambda: world.telemetry.acknowledged is not None, within=COMES_BACK)
    world.run(float(np.random.default_rng(seed).uniform(0, 5)))
    world.robot.reboot()
    world.run_until(
        lambda: not world.robot.monitor.application and world.playing("angry"),
        within=4 + COMES_BACK,
    )
    world.run_until(lambda: world.state == "ready", within=COMES_BACK)
    assert list(world.robot.violations) == []


@pytest.mark.parametrize("seed", some(range(4)))
def test_after_an_unplugging_the_mood_is_back(pleo_world, seed):
    world = pleo_world(seed)
    world.express("happy")
    world.run_until(lambda: world.telemetry.acknowledged is not None, within=COMES_BACK)
    world.unplugged = True
    world.driver.port_lost()
    assert world.state == "lost"
    assert world.telemetry.acknowledged is None
    world.run(3)
    world.robot.body.played.clear()
    world.unplugged = False
    world.driver.port_opened(world.now)
    world.run_until(lambda: world.telemetry.acknowledged is not None, within=COMES_BACK)
    assert world.playing("happy")


@pytest.mark.parametrize("seed", some(range(6)))
def test_a_silent_console_is_never_called_ready_and_found_again(pleo_world, seed):
    world = pleo_world(seed)
    world.robot.slow_probability = 0.0
    world.express("happy")
    world.run_until(lambda: world.telemetry.acknowledged is not None, within=COMES_BACK)
    world.run(float(np.random.default_rng(seed).uniform(0, 4)))
    world.silent, since = True, world.now

    def truthful() -> None:
        silence = world.now - since
        assert silence < HEARS_OF_SILENCE + 0.01 or world.state in ("degraded", "lost")
        assert silence < GIVES_UP + 0.01 or world.state == "lost"

    world.run(30, truthful)
    assert world.telemetry.acknowledged is None
    world.silent = False
    world.run_until(lambda: world.telemetry.acknowledged is not None, within=COMES_BACK)
    assert world.state in ("ready", "degraded")
    assert world.playing("happy")


def test_a_console_that_only_babbles_is_not_called_ready(script):
    pleo = script().started()
    states = set()
    for number in range(400):
        pleo.say(f"mu: sensor {number % 16} = 1\r\n", 0.1)
        if number > 10 * (GIVES_UP + 0.1):
            states.add(pleo.state)
    assert states == {"lost"}


def test_a_robot_that_does_not_answer_at_first_is_looked_for_for_ever(script):
    pleo = script()
    sent = pleo.run(60)
    assert set(sent) == {ord("\n")}
    assert len(sent) == 30
    assert pleo.state == "connecting"
    assert pleo.say("> ", 1.0) == b"APP UNLOAD\n"


def test_a_long_session_grows_nothing(pleo_world):
    world = pleo_world(5)
    world.run_until(lambda: world.state == "ready", within=COMES_BACK)
    random = np.random.default_rng(5)
    each = wander(world, random, chance=0.02)
    world.run(60, each)
    before = sizes(world.driver)
    world.run(120, each)
    assert sizes(world.driver) <= before + 20


def sizes(thing: object, depth: int = 4) -> int:
    """Count what hangs on the driver."""
    if isinstance(thing, str | bytes | bytearray):
        return len(thing) // 1000
    if isinstance(thing, dict):
        return len(thing) + sum(sizes(one, depth - 1) for one in thing.values())
    if isinstance(thing, list | tuple | set) or type(thing).__name__ == "deque":
        return len(thing)  # type: ignore[arg-type]
    return sizes(vars(thing), depth - 1) if depth and hasattr(thing, "__dict__") else 1


@given(st.lists(st.tuples(st.binary(max_size=200), st.floats(0, 3)), max_size=15))
def test_garbage_raises_nothing_and_the_link_works_afterwards(chunks):
    driver, now = PleoDriver(load_settings()), 10.0
    driver.port_opened(now)
    driver.express(Emotion(0.8, 0.5))
    for chunk, pause in chunks:
        driver.receive(chunk, now)
        driver.tick(now)
        now += pause
        driver.tick(now)
        driver.telemetry(now)
        assert len(driver.bytes_to_send()) < 100
    for _ in range(400):  # a console that answers at once, and a link that comes to itself
        now += 0.1
        driver.tick(now)
        for _ in range(driver.bytes_to_send().count(b"\n")):
            driver.receive(b"\r\n> ", now)
    assert driver.state(now) == "ready"
    assert driver.telemetry(now).acknowledged is not None


FAULTS = "drop=0.1", "reboot=20s", "stall=2s/10s&dup=0.05&delay=20ms"


@pytest.mark.parametrize("faults", some(FAULTS))
def test_moods_are_acknowledged_despite_faults_of_the_line(faults):
    robot, driver, now = simulator_of(f"sim:pleo?{faults}"), PleoDriver(load_settings()), 10.0
    driver.port_opened(now)
    taken = 0
    for _ in range(12000):
        now += 0.010
        robot.advance(now)
        driver.receive(robot.bytes_to_send(), now)
        driver.tick(now)
        robot.receive(driver.bytes_to_send(), now)
        known = driver.telemetry(now)
        if known.acknowledged == known.commanded:
            taken += 1
            driver.express(Emotion(0.0, taken / 1000, MOODS[taken % 3]))
    assert taken > 20  # in two minutes, where a mood takes 1 to 2 s and a lost answer up to 9
