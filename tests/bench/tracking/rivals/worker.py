"""The benchmark's side of `serving`: one process for each tracker, asked in turn."""

import json
import os
import subprocess
import tempfile
from collections.abc import Iterable
from pathlib import Path
from typing import Any, Self

from tests.bench.tracking.rivals.environments import ROOT, Entry, UnavailableError, python_of


class Worker:
    """A tracker in its process.

    Whoever makes it closes it, best by `with`; while it is not asked it waits and costs nothing.

    Raises
    ------
    UnavailableError
        The process cannot be started, or has ended.
    """

    def __init__(self, entry: Entry, threads: int) -> None:
        self.entry = entry
        python = python_of(entry.environment)
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115, closed by `close`
        self._process = subprocess.Popen(
            [str(python), "-m", entry.module, *filter(None, [entry.argument])],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            cwd=ROOT,
            env=os.environ | _one_setting(threads),
            text=True,
            encoding="utf-8",
        )
        try:
            self.versions: dict[str, str] = self._answer()["ready"]
        except UnavailableError:
            self.close()
            raise

    def begin(self, frames: Path, job: dict[str, Any]) -> None:
        """Start a sequence, whose frames lie in a `.npy` file."""
        self._tell({"begin": {"frames": str(frames)} | job})

    def ask(self, indices: Iterable[int]) -> list[dict[str, Any]]:
        """Let it track these frames, of which each must follow the last."""
        own = [index for index in indices if index % self.entry.every == 0]
        self._tell({"ask": own})
        return [self._answer() for _ in own]

    def close(self) -> None:
        """End the process; a second call does nothing."""
        if self._process.stdin and not self._process.stdin.closed:
            self._process.stdin.close()
        if self._process.stdout:
            self._process.stdout.close()
        try:
            self._process.wait(timeout=10)
        except subprocess.TimeoutExpired:
            self._process.kill()
            self._process.wait()
        self._errors.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()

    def _tell(self, message: dict[str, Any]) -> None:
        assert self._process.stdin is not None
        try:
            self._process.stdin.write(json.dumps(message) + "\n")
            self._process.stdin.flush()
        except BrokenPipeError as error:
            raise UnavailableError(f"its process ended: {self._last_words()}") from error

    def _answer(self) -> dict[str, Any]:
        assert self._process.stdout is not None
        line = self._process.stdout.readline()
        if not line:
            raise UnavailableError(f"its process ended: {self._last_words()}")
        answer: dict[str, Any] = json.loads(line)
        return answer

    def _last_words(self) -> str:
        self._errors.seek(0)
        lines = self._errors.read().decode(errors="replace").strip().splitlines()
        return lines[-1] if lines else "it said nothing"


def _one_setting(threads: int) -> dict[str, str]:
    """Give every library that makes threads the same number of them."""
    names = ("BENCH", "OMP_NUM", "OPENBLAS_NUM", "MKL_NUM", "RAYON_NUM")
    return {f"{name}_THREADS": str(threads) for name in names}
