"""What is performed of the BML of others: `python -m tests.bench.dialects FOLDER`.

Every `.xml`, `.bml` and `.fml` file below the folder is read as `cubeling behave` does, and played
on a character without a voice, whose times are estimated. For every behaviour in it:

visible
    Some joint turns by more than 1°, the face changes by more than 0.05, or something is said, on
    against off: two bodies of the same seed, one of which is asked for this behaviour alone.
by itself
    Messages, mouth shapes, darting eyes and the like, which are left out with a warning: voice and
    body do that by themselves, or it is nothing that is seen. They do not count as behaviours.
warned
    It is left out, or nothing of it is visible, and a warning names its line.
silent
    Neither: what the body does anyway, such as a look at the viewer, or a fault; see `--lines`.

"strict" tells how many files BML 1.0's own reader takes. A file is performed if at least half of
its behaviours are visible. Exits with 1 if fewer than 80 % of the files are performed.
"""

import argparse
import re
import sys
from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.app.behaving.player import BehaviourPlayer
from cubeling.app.behaving.voice import SilentSource
from cubeling.app.show.blocks import BehaviourOptions, block_of, command_of, place_unknown
from cubeling.characters import Animator, Character, CharacterError, PosedCharacter, RootDelta
from cubeling.characters.behaviour import Block, BmlWarning, CharacterRealizer, RealizedFrame
from cubeling.characters.behaviour.bml import BMLA
from cubeling.characters.behaviour.bml.dialects import parse_dialect
from cubeling.characters.behaviour.bml.timing import Scheduled
from cubeling.characters.skeleton import rotations

RATE = 15.0
"""Frames a second."""

MOST_S = 4.0
"""So much of one behaviour is looked at, from its start [s]."""

SETTLE_S = 0.6
"""How long both bodies stand before it [s]."""

MIN_TURN_DEG, MIN_FACE = 1.0, 0.05
"""What counts as visible."""

BAR = 0.8
"""Least share of files that are performed."""

_LINE = re.compile(r"^line (\d+): (.*)")
_DROPPED = re.compile(r"<\w+> is left out(?:, (\d+) times)?")


@dataclass
class Report:
    """What was performed of one file."""

    name: str
    strict: str = "read"
    refused: str = ""
    there: int = 0
    dropped: int = 0
    visible: int = 0
    warned: int = 0
    silent: list[str] = field(default_factory=list)
    warnings: Counter[str] = field(default_factory=Counter)

    @property
    def performed(self) -> bool:
        """Whether at least half of its behaviours can be seen."""
        return not self.refused and self.there > 0 and 2 * self.visible >= self.there


def report_of(path: Path, body: Character) -> Report:
    """Return what is performed of a file."""
    document, report = path.read_bytes(), Report(path.name)
    try:
        block_of(document, strict=True)
    except CharacterError as error:
        report.strict = str(error)
    try:
        meant = parse_dialect(document)
    except CharacterError as error:
        report.refused = str(error)
        return report
    player = BehaviourPlayer(body, SilentSource("no voice"), BehaviourOptions())
    player.director.realizer.accept(_at_once(document, player))
    frame = player.update(0.0)
    warnings = [each for each in frame.feedback if isinstance(each, BmlWarning)]
    lines: dict[int, list[str]] = {}
    dropped = 0
    for each in warnings:
        found = _LINE.match(each.description)
        report.warnings[each.type] += 1
        if found:
            lines.setdefault(int(found[1]), []).append(found[2])
            left_out = _DROPPED.match(found[2])
            dropped += int(left_out[1] or 1) if left_out else 0
    scheduled = player.director.realizer.scheduled
    shown = {each.behaviour.line for each in scheduled if _is_visible(each, player, body)}
    meant = replace(meant, behaviours=tuple(b for b in meant.behaviours if b.namespace != BMLA))
    wanted = [each.line for each in meant.behaviours]
    report.there, report.dropped = len(wanted), dropped
    report.visible = sum(line in shown for line in wanted)
    report.warned = sum(line not in shown and line in lines for line in wanted)
    report.silent = [
        f"line {each.line}: <{each.kind}> {dict(each.attributes)}"
        for each in meant.behaviours
        if each.line not in shown and each.line not in lines
    ]
    return report


def _at_once(document: bytes, player: BehaviourPlayer) -> Block:
    """Return a block as a player reads it, which does not wait to be activated."""
    block = block_of(document)
    notes = (*block.notes, *place_unknown(block, player.director.who.surroundings))
    return replace(block, notes=notes, preplan=False)


def _is_visible(scheduled: Scheduled, player: BehaviourPlayer, body: Character) -> bool:
    """Return whether a behaviour alone changes what is seen, on against off."""
    if scheduled.behaviour.kind == "speech":
        return bool(scheduled.behaviour.text.strip())
    realizer = CharacterRealizer(player.director.who)
    on, off = (Animator(body, place=RootDelta()) for _ in range(2))
    end = min(scheduled.end, scheduled.start + MOST_S)
    now = scheduled.start - SETTLE_S
    while now < end + 0.2:
        active = [scheduled] if scheduled.start <= now < scheduled.end else []
        shown = realizer.frame_of(active, now)
        with_it = on.update(command_of(shown, None, player.director.who))
        without = off.update(command_of(RealizedFrame(now), None, player.director.who))
        if _differ(with_it, without):
            return True
        now += 1.0 / RATE
    return False


def _differ(one: PosedCharacter, other: PosedCharacter) -> bool:
    a, b = one.pose, other.pose
    apart = rotations.to_rotation_vector(
        rotations.multiply(rotations.conjugate(a.rotations), b.rotations)
    )
    turned = float(np.degrees(np.linalg.norm(apart, axis=-1)).max())
    moved = float(np.abs(one.table_from_character - other.table_from_character).max())
    shown, quiet = (np.zeros(1) if pose.morphs is None else pose.morphs for pose in (a, b))
    face = float(np.abs(shown - quiet).max(initial=0.0))
    return turned > MIN_TURN_DEG or face > MIN_FACE or moved > 1e-3


def main() -> int:
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("--character", default="human")
    parser.add_argument("--lines", action="store_true", help="print every behaviour that is silent")
    asked = parser.parse_args()
    body = Character.load(asked.character)
    suffixes = (".xml", ".bml", ".fml")
    files = sorted(path for path in asked.folder.rglob("*") if path.suffix.lower() in suffixes)
    reports = [report_of(path, body) for path in files]
    empty = [each for each in reports if not each.refused and not each.there]
    reports = [each for each in reports if each not in empty]
    console, table = (
        Console(width=120),
        Table("file", "strict", "now", "there", "visible", "warned", "silent", "by itself"),
    )
    for each in reports:
        now = "refused" if each.refused else "performed" if each.performed else "hardly"
        strict = "read" if each.strict == "read" else "refused"
        counts = (each.there, each.visible, each.warned, len(each.silent), each.dropped)
        table.add_row(each.name[-60:], strict, now, *map(str, counts))
    console.print(table)
    warnings = sum((each.warnings for each in reports), Counter[str]())
    there, visible = (sum(getattr(r, key) for r in reports) for key in ("there", "visible"))
    silent = sum(len(each.silent) for each in reports)
    performed, read = sum(r.performed for r in reports), sum(r.strict == "read" for r in reports)
    refused = [each for each in reports if each.refused]
    console.print(
        f"{len(reports)} files: {read} read strictly; {performed} performed, "
        f"{len(reports) - performed - len(refused)} hardly, {len(refused)} refused\n"
        f"{there} behaviours: {visible} visible, {sum(r.warned for r in reports)} warned about, "
        f"{silent} silent; {sum(r.dropped for r in reports)} more come by themselves\nwarnings: "
        + ", ".join(f"{kind} {count}" for kind, count in warnings.most_common())
    )
    if empty:
        console.print(
            f"{len(empty)} more files have no behaviours: {', '.join(e.name for e in empty)}"
        )
    for each in refused:
        console.print(f"{each.name}: {each.refused}", markup=False)
    if asked.lines:
        for each in reports:
            for line in each.silent:
                console.print(f"{each.name}: {line}", markup=False)
    return 1 if not reports or performed < BAR * len(reports) else 0


if __name__ == "__main__":
    sys.exit(main())
