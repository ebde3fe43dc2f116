"""Runs `cubeling serve`, or another command that serves pages, beside a benchmark."""

import asyncio
import re
import signal
import subprocess
import sys
from contextlib import asynccontextmanager
from dataclasses import dataclass
from pathlib import Path

from rich.console import Console

from cubeling.app.admission import Token

TOKEN = Token("bench-token")
READY_S = 60.0

say = Console(highlight=False, soft_wrap=True).print
"""Prints a line of the result."""


@dataclass
class Served:
    """A running server."""

    process: subprocess.Popen[bytes]
    folder: Path
    log: Path
    """What it has printed."""
    address: str = ""
    output: str = ""
    """The same at the end, with its summary."""

    @property
    def port(self) -> int:
        return int(self.address.partition("localhost:")[2].partition("/")[0])

    @property
    def desk(self) -> str:
        """The address of the wizard's desk."""
        found = re.search(r"http://localhost\S+/desk#\S+", self.log.read_text())
        assert found, "it was started with --wizard"
        return found[0]

    def at(self, port: int, path: str = "/") -> str:
        """Return the address of a page at another port, as of a proxy."""
        return f"http://localhost:{port}{path}#{TOKEN.text}"

    def resident_mb(self) -> float:
        """Return the memory of the process [MB]."""
        status = Path(f"/proc/{self.process.pid}/status").read_text()
        return int(status.partition("VmRSS:")[2].split()[0]) / 1024


@asynccontextmanager
async def running(folder: Path, *command: str):
    """Run a command that serves pages, in a folder, until the block ends or it does."""
    log = folder / "serve.log"
    with log.open("w") as out:
        process = subprocess.Popen(
            [sys.executable, "-c", "from cubeling.app.entry import main; main()", *command],
            stdout=out,
            stderr=out,
            cwd=folder,
        )
        try:
            found = None
            for _ in range(round(READY_S / 0.05)):
                found = re.search(r"http://localhost:\d+/#\S+", log.read_text())
                if found or process.poll() is not None:
                    break
                await asyncio.sleep(0.05)
            assert found, log.read_text()
            served = Served(process, folder, log, found[0])
            yield served
        finally:
            process.send_signal(signal.SIGINT)
            try:
                process.wait(30)
            except subprocess.TimeoutExpired:
                process.kill()
                process.wait()
    served.output = log.read_text()


def serving(folder: Path, *options: str):
    """Run `cubeling serve` until the block ends."""
    return running(
        folder,
        *("serve", "--port", "0", "--token", TOKEN.text),
        *("--preferences", str(folder / "preferences.toml"), "--folder", str(folder), *options),
    )


def line_times_ms(output: str) -> tuple[float, float]:
    """Return what a frame took in the program, in the median and at 95 %, by its summary [ms]."""
    found = re.search(r"a frame took\s+([\d.]+) ms in the median, ([\d.]+) ms", output)
    assert found, output
    return float(found[1]), float(found[2])
