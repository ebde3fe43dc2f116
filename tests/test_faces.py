"""The faces of the rooms: every name is there, and loads no more than it needs."""

import importlib
import subprocess
import sys
from pathlib import Path

import pytest

from tools.package_links import ROOMS

ROOT = Path(__file__).parents[1]

FACES = [
    ".".join(("cubeling", *stub.relative_to(ROOT).parent.parts))
    for room in ROOMS
    for stub in sorted((ROOT / room).rglob("__init__.pyi"))
]


@pytest.mark.parametrize("name", FACES)
def test_every_name_of_a_face_is_there(name):
    package = importlib.import_module(name)
    assert package.__all__
    for each in package.__all__:
        assert getattr(package, each) is not None
    with pytest.raises(AttributeError, match="no attribute 'absent'"):
        _ = package.absent


@pytest.mark.parametrize("name", FACES)
def test_no_name_of_a_face_is_hidden_by_a_module(name):
    package = importlib.import_module(name)
    folder = Path(*package.__path__)
    modules = {path.stem for path in folder.iterdir() if path.suffix == ".py" or path.is_dir()}
    assert not modules & {*package.__all__}


def test_a_face_loads_nothing_until_it_is_asked():
    program = (
        "import sys, " + ", ".join(FACES) + "; rooms = [each for each in sys.modules if"
        " each.startswith('cubeling.')]; print(*rooms); assert 'numpy' not in sys.modules"
    )
    run = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert run.returncode == 0, run.stderr
    parents = {name.rsplit(".", depth)[0] for name in FACES for depth in (0, 1)}
    assert {*run.stdout.split()} <= {*parents, "cubeling.faces"}
