"""`python -m tools.audit`: ask which versions in constraints.txt have known vulnerabilities.

pip-audit asks the Python Package Index about each of them. Where the index does not tell, as on a
machine that reaches only a mirror of it, nothing has been checked: that is said, and is an error
unless `--if-reachable` is given.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Callable
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from rich.console import Console

CONSTRAINTS = Path(__file__).parents[1] / "constraints.txt"

TIMEOUT_S = 300.0
"""How long the index may take for all packages [s]."""

Audit = Callable[[list[str]], list[dict[str, Any]]]
"""Returns what pip-audit found of pins such as "numpy==2.4.6", an entry for each; may raise
`NotAuditedError`."""


class NotAuditedError(Exception):
    """The index could not be asked."""


def audit(pins: list[str]) -> list[dict[str, Any]]:
    """Return the entries of pip-audit's report on some pins."""
    with tempfile.TemporaryDirectory() as folder:
        requirements = Path(folder) / "pins.txt"
        requirements.write_text("\n".join(pins), "utf-8")
        command = [sys.executable, "-m", "pip_audit", "--requirement", str(requirements)]
        options = "--no-deps --disable-pip --format json --progress-spinner off --timeout 15"
        try:
            run = subprocess.run(
                [*command, *options.split()], capture_output=True, text=True, timeout=TIMEOUT_S
            )
        except subprocess.TimeoutExpired:
            raise NotAuditedError(f"no answer in {TIMEOUT_S:g} s") from None
    try:
        return list(json.loads(run.stdout)["dependencies"])  # 1 is the code of findings too
    except (ValueError, KeyError):
        raise NotAuditedError((run.stderr.strip().splitlines() or ["no report"])[-1]) from None


def check_reachable(pin: str, ask: Audit = audit) -> None:
    """Raise NotAuditedError if the index does not know a pin.

    A mirror that holds packages but no vulnerabilities answers that it knows none of them, which
    pip-audit takes as nothing found. One question is enough to tell.
    """
    (entry,) = ask([pin])
    if "skip_reason" in entry:
        raise NotAuditedError(entry["skip_reason"])


def problems_of(report: list[dict[str, Any]]) -> list[str]:
    """Return a line for each vulnerability, and for each pin that the index does not know."""
    problems = []
    for entry in report:
        if "skip_reason" in entry:
            problems.append(f"{entry['name']}: {entry['skip_reason']}")
        for found in entry.get("vulns", ()):
            fixed = ", ".join(found["fix_versions"]) or "no version yet"
            names = ", ".join([found["id"], *found["aliases"]])
            problems.append(f"{entry['name']} {entry['version']}: {names}; fixed in {fixed}")
    return problems


def main() -> int:
    """Print what was found; return 1 if there is anything, or if nothing could be asked."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--if-reachable", action="store_true", help="succeed where the index does not tell"
    )
    lenient = parser.parse_args().if_reachable
    lines = CONSTRAINTS.read_text("utf-8").splitlines()
    pins = [line for line in lines if line and not line.startswith("#")]
    out = Console(highlight=False, soft_wrap=True)
    if find_spec("pip_audit") is None:
        out.out("NOT AUDITED: pip-audit is not installed; run make audit")
        return 1
    try:
        check_reachable(pins[0])
    except NotAuditedError as error:
        out.out(f"NOT AUDITED: the Python Package Index tells no vulnerabilities here: {error}")
        return 0 if lenient else 1
    try:
        report = audit(pins)
    except NotAuditedError as error:
        out.out(f"NOT AUDITED: {error}")
        return 1
    problems = problems_of(report)
    for problem in problems:
        out.out(problem)
    out.out(f"{len(report)} versions of constraints.txt audited, {len(problems)} problems")
    return bool(problems)


if __name__ == "__main__":
    sys.exit(main())
