"""How soon the program starts: `python -m tests.bench.start`.

CPU times (user and system) of whole processes, byte code cached, beside those of the libraries that
each cannot do without; and how much of the rooms is loaded by a replay without a robot. Rounds
alternate between all rows, and ratios are those of the minima, so that other load of the machine
counts little. It fails where a bar is missed.
"""

import argparse
import os
import resource
import statistics
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console
from rich.table import Table

ROOT = Path(__file__).parents[2]

ROOMS = ("affect", "tracking", "characters", "robot", "app")

MAX_LOADED = 0.5
"""Greatest share of the rooms' lines that a replay without a robot may load."""

COMMAND = "import sys; sys.argv = ['cubeling', *{!r}]; from cubeling.app.entry import main; main()"

FIRST_STEP = """
import os, sys
from cubeling.app.pipeline.playground import Playground
step = Playground.step
def once(*given, **more):
    step(*given, **more)
    {}
    sys.stdout.flush()
    os._exit(0)
Playground.step = once
"""
"""Ends the program after the first step of a replay."""

LOADED = "print(*(m.__file__ for n, m in sys.modules.items() if n.startswith('cubeling.')))"


@dataclass(frozen=True)
class Row:
    """A row of the table."""

    name: str
    """What is measured."""

    code: str
    """The program."""

    base: str = ""
    """The row that it is compared with; "" for none."""

    bar: float = 0.0
    """Greatest ratio of their times."""


def command(*arguments: str) -> str:
    """Return a program that runs a command of `cubeling`."""
    return COMMAND.format(arguments)


def first_step(scenario: str, then: str = "") -> str:
    """Return a program that ends after the first step of a replay; `then` is done before."""
    recording = str(ROOT / "recordings" / f"{scenario}.mcap")
    return FIRST_STEP.format(then) + command("replay", recording, "--robot", "none")


HELP, STEP = "import typer, rich", "import numpy, cv2, moderngl, av, mcap"

ROWS = (
    Row(HELP, HELP),
    Row("--help", command("--help"), HELP, 2.0),
    Row("play --help", command("play", "--help"), HELP, 3.0),
    Row("replay --help", command("replay", "--help"), HELP, 3.0),
    Row("play nosuch", command("play", "nosuch"), HELP, 3.0),
    Row(STEP, STEP),
    Row("first step of companion", first_step("companion"), STEP, 2.0),
    Row("first step of follow", first_step("follow"), STEP, 2.0),
)


def run(code: str) -> str:
    """Run a program and return what it prints; its exit code does not count."""
    environment = {**os.environ, "PYTHONDONTWRITEBYTECODE": ""}
    for display in ("DISPLAY", "WAYLAND_DISPLAY"):  # no window
        environment.pop(display, None)
    done = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT,
        env=environment,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
        check=False,
    )
    return done.stdout


def cpu_s(code: str) -> float:
    """Return the CPU time of a program [s]."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run(code)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def lines(files: list[Path]) -> int:
    """Return the number of lines of some files."""
    return sum(file.read_bytes().count(b"\n") for file in files)


def loaded_lines(scenario: str) -> int:
    """Return how many lines of the rooms are loaded at the first step of a replay."""
    # The replay itself prints too: what counts of the output are the paths of our modules.
    paths = [Path(each) for each in run(first_step(scenario, LOADED)).split() if each != "None"]
    return lines(
        [path for path in set(paths) if path.suffix == ".py" and path.is_relative_to(ROOT)]
    )


def main() -> None:
    """Print the table; fail where a bar is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--rounds", type=int, default=7)
    rounds = parser.parse_args().rounds
    for row in ROWS:
        run(row.code)  # writes the byte code
    times: dict[str, list[float]] = {row.name: [] for row in ROWS}
    for _ in range(rounds):
        for row in ROWS:
            times[row.name].append(cpu_s(row.code))
    table = Table("CPU time", "min s", "median s", "times", "bar")
    missed = []
    for row in ROWS:
        least = min(times[row.name])
        ratio = least / min(times[row.base]) if row.base else 0.0
        table.add_row(
            row.name,
            f"{least:.3f}",
            f"{statistics.median(times[row.name]):.3f}",
            f"{ratio:.2f}" if row.base else "",
            f"{row.bar:g}" if row.base else "",
        )
        if ratio > row.bar:
            missed.append(f"{row.name}: {ratio:.2f} times, not {row.bar:g}")
    whole = lines([file for room in ROOMS for file in (ROOT / room).rglob("*.py")])
    shares = Table("lines loaded by a replay without a robot", "lines", "of", "share", "bar")
    for scenario in ("companion", "follow"):
        found = loaded_lines(scenario)
        shares.add_row(
            scenario, f"{found}", f"{whole}", f"{found / whole:.1%}", f"{MAX_LOADED:.0%}"
        )
        if not 0.0 < found / whole <= MAX_LOADED:
            missed.append(
                f"{scenario} loads {found / whole:.1%} of the lines, not {MAX_LOADED:.0%}"
            )
    console = Console()
    console.print(table)
    console.print(shares)
    if missed:
        sys.exit("\n".join(missed))


if __name__ == "__main__":
    main()
