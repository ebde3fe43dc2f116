"""How the cost of documents grows with their size: `python -m tests.campaigns.growth`.

Documents of BML, FML and schedules are made larger and larger, each in one way: longer texts, more
elements, more marks, constraints that can be met and that cannot. They are performed, or refused in
one line. For the exponent of the CPU time (1 is linear) the limits are raised, as below them hardly
anything takes long enough to be measured.

Exits with 1 if a cost grows faster than `MAX_EXPONENT` and `MAX_DEARER`, one document within the
limits takes longer than `MAX_S` or needs more than `MAX_MB`, or a refusal is longer than a line.
"""

import argparse
import gc
import math
import sys
import time
import tracemalloc
from collections.abc import Callable, Iterator, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import astuple, dataclass

import numpy as np
from rich.console import Console

from cubeling.characters import Character, CharacterError, xml_elements
from cubeling.characters.behaviour import behaviours_of, parse_dialect, shown_by
from cubeling.characters.behaviour.bml import (
    Block,
    BmlWarning,
    Feedback,
    Realizer,
    feedback_xml,
    parser,
    realizer,
)
from cubeling.characters.motion import schedule_file
from cubeling.characters.motion.schedule_file import ScheduleReader
from cubeling.characters.xml_elements import XmlLimits
from tests.campaigns.growing_documents import Growing, everything
from tests.characters.behaviour.bml.estimates import Estimates

MAX_EXPONENT = 1.35
"""Greatest exponent that counts as linear: fixed costs and caches bend the line a little."""

MAX_DEARER = 2.0
"""How many times as much an element of the largest document may cost as one of the smallest: those
of a large one are no longer in the processor's cache."""

MAX_S = 1.0
"""Most CPU time of one document, of any size [s]."""

MAX_MB = 300.0
"""Most memory for one document [MB]."""

MIN_FITTED_S = 0.01
"""Shorter times are of the clock and of fixed costs, and are not fitted [s]."""

REPEATED_BELOW_S = 0.3
"""A shorter time is the least of `REPEATS`: what else runs beside it only adds [s]."""

REPEATS = 3

MOST_STEPS = 9
"""Sizes over which a cost is fitted again that seems superlinear over fewer: three may mislead."""

SECONDS = ("MAX_BLOCK_S",)
"""Limits that are not raised."""

MAX_LINE = 400
"""Longest refusal [characters]."""


@dataclass(frozen=True)
class Cost:
    """What one document has cost."""

    size: int

    seconds: float
    """CPU time [s]."""

    refusal: str
    """Why it was refused; "" if it was performed."""


def perform_dialect(document: str) -> str:
    """Perform a block in a dialect for a second; return why it was refused, or ""."""
    try:
        return perform(shown_by(parse_dialect(document)))
    except CharacterError as error:
        return str(error)


def perform(document: str | Block) -> str:
    """Perform a block for a second of virtual time; return why it was refused, or ""."""
    performing = Realizer(Estimates())
    performing.accept(document)
    refusal = ""
    for frame in range(26):
        for each in performing.update(frame / 25.0):
            feedback_xml(each)
            refusal = refusal or _refusal_in(each)
        performing.active(frame / 25.0)
    return refusal


def _refusal_in(feedback: Feedback) -> str:
    """Return why a whole block was refused, if feedback says so, or ""."""
    if not isinstance(feedback, BmlWarning) or feedback.type == "READ_AS_DIALECT":
        return ""
    return "" if ":" in feedback.id else feedback.description


def mean(document: str) -> str:
    """Find the behaviours of an FML document; return why it was refused, or ""."""
    try:
        behaviours_of(document)
    except CharacterError as error:
        return str(error)
    return ""


class ScheduleTrial:
    """Reads schedules for the bundled human, and shows one pose of each."""

    def __init__(self) -> None:
        human = Character.load("human")
        clip = human.clips["wave"]
        self._reader = ScheduleReader(
            human.skeleton, human.anatomy, lambda name: clip, lambda name: lambda: clip
        )

    def __call__(self, document: str) -> str:
        try:
            self._reader.read(document.encode(), "trial.xml").sample(0.5)
        except CharacterError as error:
            return str(error)
        return ""


@contextmanager
def raised_limits(factor: int) -> Iterator[None]:
    """Raise the limits of the readers and of the realizer meanwhile."""
    with ExitStack() as undoing:
        for module in (parser, realizer, schedule_file, xml_elements):
            for name, limit in vars(module).copy().items():
                if isinstance(limit, XmlLimits):
                    raised: object = XmlLimits(*(factor * each for each in astuple(limit)))
                elif name.startswith("MAX_") and name not in SECONDS and isinstance(limit, int):
                    raised = factor * limit
                else:
                    continue
                undoing.callback(setattr, module, name, limit)
                setattr(module, name, raised)
        yield


def cost_of(size: int, document: str, read: Callable[[str], str]) -> Cost:
    """Return what a document of a size costs."""
    began = time.process_time()
    refusal = read(document)
    return Cost(size, time.process_time() - began, refusal)


def costs_of(
    growing: Growing, read: Callable[[str], str], steps: int, stop_s: float = math.inf
) -> list[Cost]:
    """Return what documents cost that double in size up to the largest one."""
    costs = []
    for step in range(steps - 1, -1, -1):
        size = max(growing.largest >> step, 1)
        document = growing.make(size)
        costs.append(cost_of(size, document, read))
        for _ in range(REPEATS - 1):
            if MIN_FITTED_S < costs[-1].seconds < REPEATED_BELOW_S:
                again = cost_of(size, document, read)
                costs[-1] = min(costs[-1], again, key=lambda cost: cost.seconds)
        if costs[-1].seconds > stop_s:
            break
    return costs


@dataclass(frozen=True)
class Growth:
    """How the cost of documents grows."""

    exponent: float
    """Of the CPU time over the size; nan if it is too short to tell."""

    span: float
    """The largest size that was fitted, in the smallest."""

    @property
    def is_superlinear(self) -> bool:
        """Whether it is more than what fixed costs and caches do."""
        return self.exponent > MAX_EXPONENT and self.span ** (self.exponent - 1.0) > MAX_DEARER


def growth_of(costs: Sequence[Cost]) -> Growth:
    """Return how the cost of documents grows that are performed."""
    fitted = [cost for cost in costs if not cost.refusal and cost.seconds > MIN_FITTED_S]
    if len(fitted) < 3:
        return Growth(math.nan, 1.0)
    sizes, seconds = [cost.size for cost in fitted], [cost.seconds for cost in fitted]
    exponent = float(np.polyfit(np.log(sizes), np.log(seconds), 1)[0])
    return Growth(exponent, max(sizes) / min(sizes))


def peak_mb(growing: Growing, read: Callable[[str], str], costs: Sequence[Cost]) -> float:
    """Return the peak of memory for the dearest of the documents [MB]."""
    document = growing.make(max(costs, key=lambda cost: cost.seconds).size)
    tracemalloc.start()
    try:
        read(document)
        return tracemalloc.get_traced_memory()[1] / 1e6
    finally:
        tracemalloc.stop()


def wrong(costs: Sequence[Cost], growth: Growth, peak: float) -> str:
    """Return what is wrong with a kind of documents, or ""."""
    found = []
    if growth.is_superlinear:
        found.append("superlinear")
    if max(cost.seconds for cost in costs) > MAX_S:
        found.append("slow")
    if peak > MAX_MB:
        found.append("large")
    if any(len(cost.refusal) > MAX_LINE or "\n" in cost.refusal for cost in costs):
        found.append("long refusal")
    return ", ".join(found)


def main() -> int:
    """Run the campaign."""
    arguments = argparse.ArgumentParser(description="Fit how the cost of documents grows.")
    arguments.add_argument(
        "--steps", type=int, default=MOST_STEPS, help="sizes, each twice the last"
    )
    arguments.add_argument("--stop", type=float, default=1.0, help="CPU s after which none grows")
    arguments.add_argument("--raise", type=int, default=8, dest="factor", help="limits, by this")
    arguments.add_argument("--only", default="", help="part of the names of kinds")
    wanted = arguments.parse_args()
    gc.freeze()  # or each collection looks at all that is loaded
    readers: dict[str, Callable[[str], str]] = {
        "bml": perform,
        "fml": mean,
        "dialect of bml": perform_dialect,
        "schedule": ScheduleTrial(),
    }
    console, faults = Console(width=150, highlight=False, markup=False, emoji=False), list[str]()
    console.print(f"{'what grows':42} {'to':>10} {'CPU s':>6} {'MB':>4} {'exponent':>8}  refused")
    for growing in everything():
        name = f"{growing.read}: {growing.name}"
        if wanted.only not in name:
            continue
        read = readers[growing.read]
        costs = costs_of(growing, read, wanted.steps)
        peak = peak_mb(growing, read, costs)
        with raised_limits(wanted.factor):
            growth = growth_of(costs_of(growing, read, wanted.steps, wanted.stop))
            if growth.is_superlinear and wanted.steps < MOST_STEPS:
                growth = growth_of(costs_of(growing, read, MOST_STEPS, wanted.stop))
        faults.append(wrong(costs, growth, peak))
        most = max(cost.seconds for cost in costs)
        fitted = "–" if math.isnan(growth.exponent) else f"{growth.exponent:.2f}"
        console.print(
            f"{name:42} {costs[-1].size:10,} {most:6.3f} {peak:4.0f} {fitted:>8}  "
            f"{costs[-1].refusal[:60]} {faults[-1].upper()}",
            soft_wrap=True,
        )
    failed = sum(map(bool, faults))
    console.print(f"{failed} of {len(faults)} kinds fail")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
