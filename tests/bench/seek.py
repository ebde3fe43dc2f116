"""How long a seek takes in a recording of hours: `python -m tests.bench.seek`.

Records some seconds of `companion` with every channel, repeats them for ten hours in one file with
two chunks a second, and seeks times at random, forwards and backwards. Printed is the processor's
time from the request to the step that is shown (drawing it comes on top, as for any frame), and the
time that passes. Exits with 1 if the processor works for more than half a second.

`--exact` processes all frames on the way instead, as in short recordings, and seeks one minute.
"""

import argparse
import re
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from foxglove_schemas_protobuf.CompressedVideo_pb2 import CompressedVideo
from mcap.writer import Writer
from rich.console import Console

from cubeling.app.pipeline.scenario import Inputs
from cubeling.app.pipeline.step import RobotView, Step
from cubeling.app.running.opening import open_session
from cubeling.app.running.playback import transport
from cubeling.app.running.runner import run
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.session.encoding import IMAGE_TOPIC
from cubeling.app.session.recorder import CHUNK_S
from cubeling.app.ui.playback.requests import Pause, SeekTo, SessionRequest
from cubeling.app.ui.screen import NullScreen

BAR_S = 0.5
RATE, SIZE, BASE_S = 6, "640x360", 20.0
"""Pictures a second, their size [px], and how long the recording is that is repeated [s]."""

TIMESTAMP = re.compile(rb'"timestamp":[-+.e0-9]+\}$')


def record(path: Path) -> None:
    """Record some seconds with every channel."""
    source = f"synthetic:companion?rate={RATE}&size={SIZE}"
    options = SessionOptions(
        scenario="companion", source=source, record=path, end_s=BASE_S, pictures=False
    )
    with open_session(options) as session:
        run(session).check()


def repeat(base: Path, path: Path, hours: float) -> int:
    """Write a recording again and again into one file; return how many chunks that has."""
    with SessionFile(base) as session, path.open("wb") as file:
        writer = Writer(file, chunk_size=1 << 20)
        writer.start(profile="", library="cubeling")
        for name, values in session.metadata.items():
            writer.add_metadata(name, values)
        records, ids = list(session.records()), dict[str, int]()
        length = round(1e9 * (session.info.duration + 1.0 / RATE))
        chunk_ns, end = round(1e9 * CHUNK_S), records[0][2].log_time
        for shift in range(0, round(3.6e12 * hours), length):
            for schema, channel, message in records:
                now = message.log_time + shift
                if now >= end:
                    writer.flush()
                    end = now + chunk_ns
                if channel.topic not in ids:
                    assert schema is not None
                    ids[channel.topic] = writer.register_channel(
                        channel.topic,
                        channel.message_encoding,
                        writer.register_schema(schema.name, schema.encoding, schema.data),
                    )
                data = message.data
                if channel.topic == IMAGE_TOPIC:
                    image = CompressedVideo.FromString(data)
                    image.timestamp.FromNanoseconds(now)
                    data = image.SerializeToString()
                elif channel.message_encoding == "json":
                    data = TIMESTAMP.sub(b'"timestamp":%.9f}' % (now / 1e9), data)
                writer.add_message(ids[channel.topic], now, data, now)
        writer.finish()
    with SessionFile(path) as session:
        return len(session._index.summary.chunk_indexes)


class Seeker(NullScreen):
    """Seeks one place after the other, and measures until each is shown."""

    attended = True

    def __init__(self, places: Sequence[float]) -> None:
        self._places, self._asked = list(places), False
        self._since = 0.0, 0.0
        self.closed = False
        self.took: list[tuple[float, float]] = []
        """Of each seek: the processor's time, and that which passed [s]."""
        self.missed = 0.0
        """How far a shown frame was from what was sought at most [s]."""
        self._first: float | None = None

    def show(self, step: Step, robot: RobotView) -> Inputs:
        """Note when a place is reached."""
        now = step.frame.timestamp
        self._first = now if self._first is None else self._first
        if self._asked:
            self.took.append(
                (time.process_time() - self._since[0], time.monotonic() - self._since[1])
            )
            self.missed = max(self.missed, abs(now - self._first - self._places.pop(0)))
            self._asked = False
            self.closed = not self._places
        return Inputs()

    def take_requests(self) -> tuple[SessionRequest, ...]:
        """Seek the next place once the last one is shown."""
        if self._asked or self._first is None or not self._places:
            return ()
        self._asked, self._since = True, (time.process_time(), time.monotonic())
        return (Pause(), SeekTo(self._places[0]))


def main() -> int:
    """Build the recording, seek, and print the figures."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--hours", type=float, default=10.0)
    parser.add_argument("--seeks", type=int, default=40)
    parser.add_argument("--exact", action="store_true")
    wanted = parser.parse_args()
    console = Console(width=110)
    length = 3600 * wanted.hours - BASE_S
    places = np.random.default_rng(1).uniform(0.0, length, wanted.seeks).tolist()
    if wanted.exact:
        transport.LONG_S, places = float("inf"), [60.0]
    with TemporaryDirectory() as folder:
        base, path = Path(folder) / "base.mcap", Path(folder) / "long.mcap"
        record(base)
        chunks = repeat(base, path, wanted.hours)
        megabytes = path.stat().st_size / 1e6
        console.print(f"{wanted.hours:g} h, {chunks} chunks, {megabytes:.0f} MB")
        screen, began = Seeker(places), time.process_time()
        with SessionFile(path) as replayed:
            options = replayed.info.options
            with open_session(options, screen=screen, replayed=replayed) as session:
                session.pace = None
                console.print(f"opened in {time.process_time() - began:.2f} s of a processor")
                run(session)
    worked, passed = np.array(screen.took).T
    for name, values in (("processor", worked), ("passed", passed)):
        middle, most = np.quantile(values, (0.5, 0.95))
        console.print(
            f"{len(values)} seeks, {name}: first {values[0]:.3f}, median {middle:.3f}, "
            f"95 % {most:.3f}, longest {values.max():.3f} s"
        )
    console.print(f"shown at most {screen.missed:.3f} s from what was sought")
    late = worked.max() > BAR_S or screen.missed > 1.5 / RATE
    return 1 if late else 0


if __name__ == "__main__":
    sys.exit(main())
