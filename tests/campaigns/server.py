"""Attacks on `behave --serve` over loopback: `python -m tests.campaigns.server --seconds 3`.

A server with a character runs in a process of its own. While each attack goes on, on a thread,
honest clients connect one after the other, and each waits until its block has started. Prints for
every attack how long the slowest of them waited, and the longest frame.

Exits with 1 if one has waited longer than `SERVED_S`, a frame has taken more CPU time than
`FRAME_CPU_S`, or the process needs more than `MEMORY_MB`.
"""

import argparse
import os
import sys
import threading
import time
from dataclasses import dataclass

from rich.console import Console

from tests.campaigns.attacks import ATTACKS, Attack
from tests.campaigns.served import Seen, Served, serve, served_s

SERVED_S = 2.0
"""Most time from connecting to the start of a block [s], on a machine that nobody else uses.
Where programs share a core when the campaign begins, it is longer by their number."""

FRAME_CPU_S = 0.3
"""Most CPU time of a frame [s]. It lasts longer beside the attacks, which run here too."""

MEMORY_MB = 800.0
"""Most memory of the process [MB]; without an attack it is about 250 MB."""

JOIN_S = 10.0
"""Time in which an attack ends when its time is over [s]."""

SHORT = (
    "a flood of documents",
    "fifteen slow lorises",
    "a slow token",
    "feedback that is not read",
    "the wrong token",
    "2,400 constraints",
    "as many constraints as are taken",
    "a billion laughs",
    "200 gestures at once",
    "blocks that replace all",
)
"""Attacks of the short form."""


@dataclass(frozen=True)
class Outcome:
    """What an attack has done."""

    waited_s: float
    """Longest time that an honest client waited [s]; inf if one was not served."""

    clients: int
    """Honest clients that were served."""

    seen: Seen

    allowed_s: float = SERVED_S
    """Most time that a client may wait on this machine [s]."""

    @property
    def wrong(self) -> str:
        """What is wrong, or ""."""
        found = []
        if self.waited_s > self.allowed_s:
            found.append("not served")
        if self.seen.worst_cpu_s > FRAME_CPU_S:
            found.append("a long frame")
        if self.seen.peak_mb > MEMORY_MB:
            found.append("memory")
        return ", ".join(found)


def run_attack(
    server: Served, name: str, attack: Attack, seconds: float, allowed_s: float = SERVED_S
) -> Outcome:
    """Attack for a time [s] while honest clients come."""
    until = time.monotonic() + seconds
    thread = threading.Thread(target=attack, args=(server, until), daemon=True)
    server.seen()
    thread.start()
    waits: list[float] = []
    key = "".join(letter for letter in name if letter.isalnum())
    while time.monotonic() < until or not waits:
        waits.append(served_s(server, f"{key}{len(waits)}", 3.0 * allowed_s))
    seen = server.seen()
    thread.join(JOIN_S)
    return Outcome(max(waits), sum(wait < allowed_s for wait in waits), seen, allowed_s)


def main() -> int:
    """Run the campaign."""
    arguments = argparse.ArgumentParser(description="Attack `behave --serve` over loopback.")
    arguments.add_argument("--seconds", type=float, default=3.0, help="time of each attack")
    arguments.add_argument("--short", action="store_true", help=f"{len(SHORT)} attacks only")
    arguments.add_argument("--only", default="", help="part of the names of attacks")
    wanted = arguments.parse_args()
    console, wrong = Console(width=120, highlight=False), 0
    chosen = {
        name: attack
        for name, attack in {"(none)": lambda *_: None, **ATTACKS}.items()
        if wanted.only in name and (not wanted.short or name in SHORT)
    }
    console.print(
        f"{'attack':34} {'served':>6} {'waited s':>8} {'frame s':>8} {'CPU s':>6} {'MB':>5}"
    )
    allowed_s = SERVED_S * max(os.getloadavg()[0] / (os.cpu_count() or 1), 1.0)
    console.print(f"each client is to be served within {allowed_s:.1f} s")
    with serve() as server:
        for name, attack in chosen.items():
            outcome = run_attack(server, name, attack, wanted.seconds, allowed_s)
            wrong += bool(outcome.wrong)
            console.print(
                f"{name:34} {outcome.clients:6} {outcome.waited_s:8.2f} "
                f"{outcome.seen.worst_s:8.3f} {outcome.seen.worst_cpu_s:6.3f} "
                f"{outcome.seen.peak_mb:5.0f}  {outcome.wrong.upper()}",
                soft_wrap=True,
            )
    console.print(f"{wrong} of {len(chosen)} attacks hurt others")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
