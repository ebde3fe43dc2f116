"""`python -m tests.bench.vmc`: our character on a stranger's receiver of the VMC protocol.

Clips of the bundled person are sent by UDP; node-osc hears them, and three-vrm in a headless
Chromium shows them on models of other proportions, as VRM 0 and as VRM 1.0 whose bones have axes
of their own. The places of its wrists, seen from the hips, are compared with those of our own
retargeting of the same clips to the same models.

Without node, npm or Chromium it says so and measures nothing. The packages are installed once into
.bench/vmc, at the versions of package.json.
"""

import argparse
import asyncio
import json
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from types import SimpleNamespace
from typing import Any

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.bridges.addresses import UdpAddress
from cubeling.app.bridges.vmc import VmcOut
from cubeling.characters import Character, Clip, PosedCharacter
from cubeling.characters.model import retarget
from cubeling.characters.skeleton.anatomy import Anatomy
from cubeling.characters.skeleton.pose import Skeleton
from tests.bench.vmc.models import normalised_model, raw_model, write_vrm
from tests.bench.web.chromium import Tab, chromium, program

ROOT = Path(__file__).parents[3]
PACKAGES = ROOT / ".bench" / "vmc"
"""Where npm puts the packages."""

CLIPS = ("wave", "cheer", "Walk")
FRAMES = 12
"""Frames of each clip."""

LIMIT_M = 0.02
"""How far a wrist may be from where our own retargeting puts it [m]."""

Model = tuple[Skeleton, Anatomy]


def make_model(
    version: str, make: Callable[[Character], Skeleton], who: Character, path: Path
) -> Model:
    """Write a model made of a character to a file, and return it."""
    skeleton = make(who)
    write_vrm(skeleton, path, version)
    return skeleton, Anatomy("humanoid", {name: n for n, name in enumerate(skeleton.names)})


def load_model(given: Path, who: Character, path: Path) -> Model:
    """Copy somebody's model to a file, and return it."""
    shutil.copyfile(given, path)
    model = Character.load(given)
    return model.skeleton, model.anatomy


MakeModel = Callable[[Character, Path], Model]
MODELS: dict[str, MakeModel] = {
    "VRM 0, the same body": partial(make_model, "0.0", normalised_model),
    "VRM 0, long arms, short legs": partial(
        make_model, "0.0", partial(normalised_model, arms=1.4, legs=0.7)
    ),
    "VRM 1.0, the same body": partial(make_model, "1.0", normalised_model),
    "VRM 1.0, axes of its own": partial(make_model, "1.0", partial(raw_model, arms=0.8, legs=1.2)),
}
"""What makes each model."""


def missing() -> str:
    """Return which program is missing; "" if all are there."""
    programs = [name for name in ("node", "npm") if shutil.which(name) is None]
    return ", ".join([*programs, *([] if program() else ["Chromium"])])


def install() -> None:
    """Install the packages unless they are there; raises CalledProcessError if npm fails."""
    PACKAGES.mkdir(parents=True, exist_ok=True)
    wanted = (Path(__file__).parent / "package.json").read_bytes()
    stated = PACKAGES / "package.json"
    if (PACKAGES / "node_modules").is_dir() and stated.read_bytes() == wanted:
        return
    stated.write_bytes(wanted)
    subprocess.run(
        ["npm", "install", "--silent", "--no-audit", "--no-fund"], cwd=PACKAGES, check=True
    )


@contextmanager
def relay(models: Path) -> Iterator[dict[str, int]]:
    """Run what hears OSC; yield its ports."""
    here = Path(__file__).parent
    with subprocess.Popen(
        ["node", str(here / "relay.mjs"), str(here), str(models)],
        cwd=PACKAGES,
        stdout=subprocess.PIPE,
        text=True,
    ) as process:
        try:
            assert process.stdout is not None
            ports: dict[str, int] = json.loads(process.stdout.readline())
            yield ports
        finally:
            process.terminate()


async def distances(
    tab: Tab,
    out: VmcOut,
    who: Character,
    clip: Clip,
    skeleton: Skeleton,
    anatomy: Anatomy,
    *,
    turned: bool,
) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return how far the wrists are from where ours are, (frames, 2) [m].

    `turned` says that the model looks along −z there, and along +z here.
    """
    ours = retarget(clip, who.skeleton, who.anatomy, skeleton, anatomy)
    axes = np.array([-1.0, 1.0, -1.0]) if turned else np.ones(3)
    found = []
    for frame in np.linspace(0, len(clip) - 1, FRAMES).astype(int).tolist():
        pose = clip.poses[frame]
        posed = PosedCharacter(pose, np.eye(4), True, clip.name, 0.0, 0.0, 0.0, frame / clip.rate)
        out.follow(SimpleNamespace(cast=[SimpleNamespace(posed=posed)]), [who], 0.0)  # type: ignore[arg-type]
        shown = await tab.run("take()")
        places = ours.poses[frame].globals(skeleton)[:, :3, 3]
        hips = places[anatomy.joints["hips"]]
        found.append(
            [
                np.linalg.norm(
                    np.array(shown["places"][hand]) * axes - (places[anatomy.joints[hand]] - hips)
                )
                for hand in ("leftHand", "rightHand")
            ]
        )
    return np.array(found)


async def measure(files: Sequence[Path] = ()) -> dict[str, dict[str, float]]:
    """Return the largest distance of a wrist by model and clip [m]; `files` are further models."""
    who = Character.load("human")
    models: dict[str, MakeModel] = dict(MODELS)
    models |= {path.name: partial(load_model, path) for path in files}
    results: dict[str, dict[str, float]] = {}
    with TemporaryDirectory() as folder, relay(Path(folder)) as ports:
        async with chromium() as browser:
            tab = await browser.tab()
            await tab.open(f"http://127.0.0.1:{ports['http']}/page/receiver.html")
            await tab.until("window.ready")
            with VmcOut(UdpAddress("127.0.0.1", ports["osc"])) as out:
                out.begin([who])
                for number, (name, make) in enumerate(models.items()):
                    skeleton, anatomy = make(who, Path(folder) / f"{number}.vrm")
                    turned = await tab.run(f"load('/models/{number}.vrm')") == "0"
                    results[name] = {}
                    for clip in CLIPS:
                        apart = await distances(
                            tab, out, who, who.clips[clip], skeleton, anatomy, turned=turned
                        )
                        results[name][clip] = float(apart.max())
    return results


def main() -> int:
    """Print the table; return 1 if a wrist is too far from ours."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("models", nargs="*", type=Path, help="further models, .vrm files")
    files = parser.parse_args().models
    console = Console()
    if absent := missing():
        console.print(f"nothing is measured: there is no {absent} here")
        return 0
    install()
    results = asyncio.run(measure(files))
    table = Table("model in three-vrm", *(f"{clip}, wrists off by" for clip in CLIPS))
    for name, by_clip in results.items():
        table.add_row(name, *(f"{1000 * value:.1f} mm" for value in by_clip.values()))
    console.print(table)
    worst = max(value for by_clip in results.values() for value in by_clip.values())
    return int(worst > LIMIT_M)


if __name__ == "__main__":
    sys.exit(main())
