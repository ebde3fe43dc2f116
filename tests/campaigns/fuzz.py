"""Coverage-guided fuzzing of one decoder: `python -m tests.campaigns.fuzz --seconds 60 TARGET`.

Needs atheris (`pip install atheris==3.0.0`; Linux, CPython 3.11 to 3.13), which is no dependency of
the project: the suite runs the same targets with Hypothesis. Without TARGET all are listed. What
libFuzzer finds it writes to the folder that `--found` names, a temporary one if none is named.
"""

import argparse
import sys
import tempfile
from importlib import import_module
from pathlib import Path


def main() -> int:
    """Fuzz a target until the time is over; libFuzzer ends the process itself if it finds a bug."""
    parser = argparse.ArgumentParser(description="Fuzz a decoder, guided by coverage.")
    parser.add_argument("target", nargs="?", help="which; without, they are listed")
    parser.add_argument("--seconds", type=int, default=60)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--found", help="folder for what breaks it")
    wanted = parser.parse_args()
    try:
        atheris = import_module("atheris")
    except ImportError:
        parser.error("atheris is not installed: pip install atheris==3.0.0")
    with atheris.instrument_imports(include=["robot", "tests.campaigns.decoders"]):
        from tests.campaigns.decoders import TARGETS
    if wanted.target not in TARGETS:
        parser.error(f"the targets are {', '.join(TARGETS)}")
    target = TARGETS[wanted.target]
    found = wanted.found or tempfile.mkdtemp(prefix="cubeling-fuzz-")
    Path(found).mkdir(parents=True, exist_ok=True)

    def one_input(data: bytes) -> None:
        target(data)

    options = [
        f"-max_total_time={wanted.seconds}",
        f"-seed={wanted.seed}",
        "-max_len=4096",
        "-len_control=0",
    ]
    atheris.Setup(
        [sys.argv[0], *options, "-rss_limit_mb=1024", f"-artifact_prefix={found}/"], one_input
    )
    atheris.Fuzz()
    return 0


if __name__ == "__main__":
    sys.exit(main())
