"""A browser with a profile of its own, until it is not needed any more."""

import asyncio
import subprocess
from contextlib import asynccontextmanager
from pathlib import Path

CHECK_S, END_S = 0.05, 10.0


@asynccontextmanager
async def running(program, *arguments, port_file: Path, start_s: float):
    """Run a browser; yield what it writes into a file when it can be driven."""
    process = subprocess.Popen(
        [program, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
    )
    try:
        for _ in range(round(start_s / CHECK_S)):
            if port_file.exists() and port_file.read_text().strip():
                break
            await asyncio.sleep(CHECK_S)
        yield port_file.read_text()
    finally:
        process.terminate()
        try:
            process.wait(END_S)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
