"""Lets the tests compute and print as the program does on any computer."""

import gc
import os
import sys
import time
from collections.abc import Callable, Generator
from pathlib import Path
from typing import Protocol

import pytest
from hypothesis import settings, strategies as st

from tests.cost import CostCheck
from tests.examples import register_profiles
from tools.package_links import ROOMS

register_profiles()
settings.load_profile("quick")  # `make test-all` takes another: --hypothesis-profile full

for name in ("FORCE_COLOR", "GITHUB_ACTIONS", "PY_COLORS"):
    os.environ.pop(name, None)  # with them, Typer prints colours without a terminal

# OpenCV reads it when it is imported. The suite keeps all cores busy by itself; two processes whose
# threads wait for each other take twice as long for the frames of a session.
os.environ.setdefault("OPENCV_FOR_THREADS_NUM", "1")

# Mesa reads it when it draws without a graphics card: in the thread of the test, for the same
# reason. Other threads for each of the small pictures take a tenth longer.
os.environ.setdefault("LP_NUM_THREADS", "0")

# The C library of Linux reads them when a process starts, so they are for the workers of xdist. It
# keeps the memory of pictures instead of returning it and asking for it again a frame later.
os.environ.setdefault("MALLOC_MMAP_THRESHOLD_", str(2**25))
os.environ.setdefault("MALLOC_TRIM_THRESHOLD_", str(2**30))

import cubeling as cubeling  # noqa: E402  before numpy, whose rounding it sets


def pytest_configure(config: pytest.Config) -> None:
    """Name the tests that take long without a reason; in CI they fail the run."""
    in_ci = "CI" in os.environ and not hasattr(config, "workerinput")  # workers only measure
    of_all_examples = config.getoption("hypothesis_profile", None) is not None
    config.pluginmanager.register(CostCheck(in_ci and not of_all_examples), "cost")


def pytest_xdist_auto_num_workers(config: pytest.Config) -> int:
    """Return one process more than there are cores: some tests wait for a robot or a window."""
    return (os.cpu_count() or 1) + 1


@pytest.fixture(scope="session", autouse=True)
def _one_copy_of_each_room() -> Generator[None, None, None]:
    """Fail if a test imported `tracking` for `cubeling.tracking`: its classes would be others."""
    yield
    assert not {*ROOMS} & sys.modules.keys(), "import it from cubeling"


@pytest.hookimpl(wrapper=True)
def pytest_collection() -> Generator[None, object, object]:
    """Collect no garbage among the modules and thousands of tests: they stay until the end.

    Each pass over them took a quarter of a second, in every test that makes many objects.
    """
    gc.disable()
    try:
        st.text().validate()  # in a fresh clone, its table of Unicode takes two seconds of a test
        return (yield)
    finally:
        gc.freeze()
        gc.enable()


COMPUTING_S = 300.0
"""A process waits so long for a recording that another one computes [s]."""


FIRST_S = 5.0
"""What `make test` computes of a bundled recording [s]: in it the cube is put down, and turned or
tipped. Whole recordings take ten times as long; `make test-all` computes them."""


MakeOnce = Callable[[str, Callable[[Path], object]], Path]
"""Returns a file of a name; the first process that asks makes it, at the path that it is given."""


@pytest.fixture(scope="session")
def make_once(tmp_path_factory: pytest.TempPathFactory) -> MakeOnce:
    """Let all processes share what takes long to make."""
    folder = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        folder = folder.parent  # of all processes

    def find(name: str, make: Callable[[Path], object]) -> Path:
        path, begun = folder / name, folder / f"{name}.begun"
        try:
            begun.touch(exist_ok=False)
        except FileExistsError:
            end = time.monotonic() + COMPUTING_S
            while not path.exists():
                assert time.monotonic() < end, f"another process did not make {name}"
                time.sleep(0.1)
            return path
        partial = folder / f"partial-{name}"
        make(partial)
        return partial.rename(path)

    return find


class ComputedSession(Protocol):
    """Returns a bundled recording with every channel, or its first seconds."""

    def __call__(self, name: str, seconds: float | None = None) -> Path:
        """Return the file; the first process that asks computes it."""


@pytest.fixture(scope="session")
def computed_session(make_once: MakeOnce) -> ComputedSession:
    """Return a bundled recording with every channel."""
    from cubeling.app.running.computing import compute_channels
    from cubeling.app.session.bundled import bundled_session
    from cubeling.app.session.copying import copy_session

    def find(name: str, seconds: float | None = None) -> Path:
        def compute(path: Path) -> None:
            source = bundled_session(name)
            if seconds is not None:
                recording, source = source, path.with_name(f"source-{path.name}")
                copy_session(recording, source, lambda _, at, data: data if at < seconds else None)
            compute_channels(source, path)

        part = name if seconds is None else f"{name}-{seconds:g}s"
        return make_once(f"{part}.mcap", compute)

    return find
