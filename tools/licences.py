"""`python -m tools.licences`: write the table of docs/licences.md; `--check` compares it.

The packages are those that pip installs for `cubeling` and its extras on Linux with Python 3.11,
at the versions of constraints.txt. Licences are read from the metadata of what is installed, and
the libraries inside wheels from their files.

To write the table, all extras must be installed (`make licences` does it, in an environment of its
own). To check it, they need not be: what a machine cannot see is compared by its version only, as
are the contents of wheels on other machines than x86_64 with Linux.
"""

import argparse
import ctypes
import platform
import re
import sys
from collections import deque
from dataclasses import dataclass
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name
from rich.console import Console

from tools.bundled_libraries import FFMPEG, LIBRARIES, LICENCES, LINKED
from tools.marked_parts import part_of, replace_part

ROOT = Path(__file__).parents[1]

PAGE = ROOT / "docs" / "licences.md"
"""The document."""

EXTRAS = ("align", "fbx", "lab", "listen", "osc", "plots", "reachy", "sound", "voice", "web")
"""What a user may add; the extra `dev` is for those who change the program."""

HEADER = "| package | for | licence | its wheel holds |\n|---|---|---|---|"

# What pip sees there, wherever this runs.
_ENVIRONMENT = {
    "implementation_name": "cpython",
    "os_name": "posix",
    "platform_machine": "x86_64",
    "platform_python_implementation": "CPython",
    "platform_system": "Linux",
    "python_full_version": "3.11.0",
    "python_version": "3.11",
    "sys_platform": "linux",
}

SEES_WHEELS = (sys.platform, platform.machine()) == ("linux", "x86_64")
"""Whether the wheels of this machine hold what the page lists."""


class LicenceError(Exception):
    """Something whose licence is not known, or a package that is not pinned."""


@dataclass(frozen=True)
class PackageRow:
    """A line of the table."""

    package: str
    """The package and its version."""

    used_by: str
    """"always", or the extras that need it."""

    licence: str
    """An SPDX expression, or words where there is none."""

    holds: str
    """The libraries in its wheel with their licences; "–" for none."""

    def __str__(self) -> str:
        return f"| {self.package} | {self.used_by} | {self.licence} | {self.holds} |"


def required_packages() -> tuple[dict[str, set[str]], set[str]]:
    """Return the names of all packages with what needs them, and those that are not installed.

    What needs a package is "" for `cubeling` itself, else an extra of it.
    """
    needed: dict[str, set[str]] = {}
    missing = set()
    waiting = deque(("cubeling", extra, extra) for extra in ("", *EXTRAS))
    seen = set()
    while waiting:
        step = waiting.popleft()
        if step in seen:
            continue
        seen.add(step)
        name, extra, user = step
        if name != "cubeling":
            needed.setdefault(name, set()).add(user)
        try:
            requirements = distribution(name).requires or []
        except PackageNotFoundError:
            missing.add(name)
            continue
        for text in requirements:
            requirement = Requirement(text)
            marker = requirement.marker
            applies = marker is None or marker.evaluate({**_ENVIRONMENT, "extra": extra})
            only_by_extra = marker is not None and "extra" in str(marker)
            if applies and (name != "cubeling" or only_by_extra == bool(extra)):
                child = canonicalize_name(requirement.name)
                waiting.extend((child, each, user) for each in ("", *requirement.extras))
    return needed, missing


def table_rows(pins: dict[str, str]) -> tuple[dict[str, PackageRow], set[str]]:
    """Return a row for every package by its name, and the names of those not installed.

    A package that is not installed has no row, unless no version of it is pinned.

    Raises
    ------
    LicenceError
        A licence is not known, or a package is neither pinned nor a direct requirement.
    """
    needed, missing = required_packages()
    direct = {canonicalize_name(Requirement(each).name) for each in _own_requirements()}
    rows = {}
    for name, users in sorted(needed.items()):
        used_by = "always" if "" in users else ", ".join(f"`[{each}]`" for each in sorted(users))
        if name not in pins:
            if name not in direct or "" in users:
                raise LicenceError(f"{name} is not pinned in constraints.txt")
            licence = LICENCES.get(name)
            if licence is None:
                raise LicenceError(f"LICENCES does not name {name}, which is not pinned")
            rows[name] = PackageRow(f"`{name}`, not pinned", used_by, licence, "not examined")
            missing.discard(name)
        elif name not in missing:
            found = distribution(name)
            rows[name] = PackageRow(
                f"`{name}` {pins[name]}", used_by, licence_of(name, found), holds(name, found)
            )
    return rows, missing


def licence_of(name: str, found: Distribution) -> str:
    """Return the licence of a package: as written down here, or as its metadata says."""
    metadata = found.metadata
    fields = [metadata[each] for each in ("License-Expression", "License") if each in metadata]
    stated = next(filter(None, fields), "")
    if not stated and "License :: OSI Approved :: MIT License" in metadata.get_all(
        "Classifier", []
    ):
        stated = "MIT"
    licence = LICENCES.get(name, stated)
    if not licence or "\n" in licence:
        raise LicenceError(f"the metadata of {name} names no licence: add it to LICENCES")
    return mark_copyleft(licence)


def holds(name: str, found: Distribution) -> str:
    """Return the libraries in a wheel with their licences, as words.

    Python's own modules are not libraries: their names tell the interpreter.
    """
    libraries: dict[str, str] = {}
    for file in sorted(found.files or [], key=str):
        if not re.search(r"\.so(\.|$)", file.name) or re.search(r"\.(cpython-\d|abi3)", file.name):
            continue
        stem = library_stem(file.name)
        if stem not in LIBRARIES:
            raise LicenceError(f"the wheel of {name} holds {file.name}: add {stem} to LIBRARIES")
        library, licence = LIBRARIES[stem]
        if library == FFMPEG and stem == "libavcodec":
            licence = ffmpeg_licence(Path(str(found.locate_file(file))))
        libraries[library] = libraries.get(library) or licence
    parts = [f"{each} ({mark_copyleft(libraries[each])})" for each in sorted(libraries)]
    parts += [f"{each} ({licence})" for each, licence in LINKED.get(name, {}).items()]
    return "; ".join(parts) or "–"


def library_stem(file: str) -> str:
    """Return the name of a shared library without its version and the hash of auditwheel.

    >>> library_stem("libx264-d6533a8d.so.165"), library_stem("libglfw.so")
    ('libx264', 'libglfw')
    >>> library_stem("libopenblasp-r0-59ffcd50.3.15.so")
    'libopenblasp'
    >>> library_stem("libscipy_openblas64_-32a4b2a6.so"), library_stem("libssl-81259c47.so.1.1.1k")
    ('libscipy_openblas64', 'libssl')
    """
    return re.sub(r"(-r\d+)?_?(-[0-9a-f]{8})*[0-9.]*\.so.*$", "", file)


def ffmpeg_licence(library: Path) -> str:
    """Return the licence that an FFmpeg library says it was built under, in SPDX's words."""
    ask = ctypes.CDLL(str(library)).avcodec_license
    ask.restype = ctypes.c_char_p
    said = ask().decode()
    match = re.fullmatch(r"(L?GPL) version ([\d.]+) or later", said)
    if match is None:
        raise LicenceError(f"{library.name} says of its licence: {said}")
    kind, version = match.groups()
    return f"{kind}-{version if '.' in version else version + '.0'}-or-later"


def mark_copyleft(licence: str) -> str:
    """Return a licence in bold where all of what it applies to is under the GPL.

    >>> mark_copyleft("GPL-2.0-or-later"), mark_copyleft("LGPL-3.0-or-later OR GPL-2.0-or-later")
    ('**GPL-2.0-or-later**', 'LGPL-3.0-or-later OR GPL-2.0-or-later')
    """
    return f"**{licence}**" if re.fullmatch(r"GPL-[\d.]+-(only|or-later)", licence) else licence


def pinned_versions() -> dict[str, str]:
    """Return the version of each package in constraints.txt."""
    lines = (ROOT / "constraints.txt").read_text("utf-8").splitlines()
    pins = [Requirement(line) for line in lines if line and not line.startswith("#")]
    return {canonicalize_name(pin.name): str(pin.specifier).removeprefix("==") for pin in pins}


def problems_of(page: str, pins: dict[str, str]) -> list[str]:
    """Return where the page differs from what is installed, and from the versions of `pins`."""
    rows, missing = table_rows(pins)
    written = {}
    for line in part_of(page, "packages").splitlines()[2:]:
        row = PackageRow(*(cell.strip() for cell in line.strip("|").split("|")))
        written[row.package.split("`")[1]] = row
    problems = []
    for name in sorted({*rows, *missing, *written}):
        here, there = rows.get(name), written.get(name)
        if there is None:
            problems.append(f"{name} is missing")
        elif f"`{name}` {pins.get(name)}" != there.package and name in pins:
            problems.append(f"{name} is pinned at {pins[name]}, not {there.package}")
        elif here is None:
            if not missing:
                problems.append(f"{name} is not needed any more")
        elif here.licence != there.licence or (SEES_WHEELS and here.holds != there.holds):
            problems.append(f"{name} differs: {here}")
    return problems


def _own_requirements() -> list[str]:
    return distribution("cubeling").requires or []


def main() -> int:
    """Write the page or check it; return 1 if it is out of date."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--check", action="store_true", help="compare only")
    check = parser.parse_args().check
    out, pins = Console(highlight=False, soft_wrap=True), pinned_versions()
    page = PAGE.read_text("utf-8")
    try:
        if check:
            problems = problems_of(page, pins)
            for problem in problems:
                out.out(f"{PAGE.name}: {problem}")
            if problems:
                out.out("write it again: make licences")
            return bool(problems)
        rows, missing = table_rows(pins)
    except LicenceError as error:
        out.out(f"{PAGE.name}: {error}")
        return 1
    if missing:
        out.out(f"not installed: {', '.join(sorted(missing))}; run make licences")
        return 1
    table = "\n".join([HEADER, *map(str, rows.values())])
    PAGE.write_text(replace_part(page, "packages", table), "utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
