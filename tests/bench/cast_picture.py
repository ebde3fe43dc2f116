"""Time of a picture of several characters: `python -m tests.bench.cast_picture [--frames N]`.

The same frames of the recording of `companion` are drawn with one, three and five characters on
the table, in turns, in each quality. Times are of drawing alone, without animation and cards: the
median and the 95th percentile [ms], and the median ÷ that of one character. Exits with 1 if five
take more than `MAX_RATIO` of one in the quality that a machine without a graphics card plays in.
"""

import argparse
import itertools
import sys
import time

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.pipeline.playground import Playground
from cubeling.app.running.kept_lens import intrinsics_for
from cubeling.app.session.bundled import bundled_session
from cubeling.characters import Character
from cubeling.characters.rendering import QUALITIES, create_context, draws_in_software
from cubeling.tracking import open_source

OTHERS = ("human", "vleo", "human", "vleo")
"""Who stands beside Vleo."""

COUNTS = (0, 2, 4)
"""How many of them do, in each row."""

MAX_RATIO = 2.0

WARM_UP = 10
"""First frames, in which the table is found and textures are loaded: not counted."""


def main() -> int:
    """Print the table and return an exit code."""
    parser = argparse.ArgumentParser(description=__doc__.partition("\n")[0])
    parser.add_argument("--frames", type=int, default=40)
    frames = parser.parse_args().frames
    table = Table("quality", "characters", "median ms", "95 %", "÷ one")
    context = create_context()
    lowest = list(QUALITIES)[-1]
    judged = lowest if draws_in_software(context) else next(iter(QUALITIES))
    ratio = 0.0
    for name, quality in QUALITIES.items():
        times: dict[int, list[float]] = {count: [] for count in COUNTS}
        with open_source(str(bundled_session("companion"))) as source:
            camera = intrinsics_for(source.intrinsics, source.size)
            playgrounds = {}
            for count in COUNTS:
                others = [Character.load(each) for each in OTHERS[:count]]
                playgrounds[count] = Playground("companion", camera, others=others, context=context)
                playgrounds[count].quality = quality
            for frame in itertools.islice(source, WARM_UP + frames):
                for count, playground in playgrounds.items():
                    step = playground.step(frame, drawn=False, measured=True)
                    begun = time.perf_counter()
                    playground.draw(step)
                    times[count].append(1e3 * (time.perf_counter() - begun))
            for playground in playgrounds.values():
                playground.close()
        one = float(np.median(times[0][WARM_UP:]))
        for count, spans in times.items():
            median, high = np.quantile(spans[WARM_UP:], (0.5, 0.95)).tolist()
            ratio = median / one if name == judged and count == COUNTS[-1] else ratio
            row = (f"{median:.1f}", f"{high:.1f}", f"{median / one:.2f}")
            table.add_row(name, str(count + 1), *row)
    context.release()
    Console().print(table)
    if ratio > MAX_RATIO:
        Console().print(f"five characters in {judged}: {ratio:.2f} times one, not {MAX_RATIO:g}")
    return int(ratio > MAX_RATIO)


if __name__ == "__main__":
    sys.exit(main())
