"""Reading the protocol of a study from a TOML file, and refusing what could not be run."""

import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import TypeVar

from cubeling.affect import AffectError, Personality
from cubeling.app.errors import AppError
from cubeling.app.running.option_checks import check_inputs
from cubeling.app.running.wizard.plan import WizardPlan
from cubeling.app.scenarios import check_scenario, find_scenario
from cubeling.app.session import SessionOptions
from cubeling.app.workshop.study.protocols.forms import questionnaire_of
from cubeling.app.workshop.study.protocols.orders import MAX_CONDITIONS
from cubeling.app.workshop.study.protocols.protocol import (
    Instruction,
    Phase,
    Preregistered,
    Protocol,
    Resume,
    Settings,
    StimulusSet,
    StudyTask,
)
from cubeling.app.workshop.study.protocols.questionnaires import Questionnaire
from cubeling.characters import CharacterError
from cubeling.toml_file import MAX_LONG_FILE_BYTES, TomlTable, parse, toml_kind
from cubeling.tracking import CubeModel

PROTOCOL_FILE = toml_kind(
    "protocol",
    AppError,
    "cubeling.app.workshop.study.protocols.protocol_file:read_protocol",
    MAX_LONG_FILE_BYTES,
)
"""The protocol of a study."""

BUNDLED_FOLDER = Path(__file__).parents[1] / "bundled"

MAX_STIMULI = 10_000
"""Most stimuli of a set."""

MAX_PARTS = 256
"""Most entries of a list in a protocol."""

MAX_LIMIT_S = 7200.0
"""The longest time of a task [s]."""

ORDERS = ("fixed", "latin", "random")

KEYS = (
    *("title", "about", "conditions", "design", "order", "seed", "light_patch", "printed"),
    *("condition", "phase", "instruction", "task", "questionnaire", "stimuli", "resume"),
    *("preregistered", "wizard"),
)

Named = TypeVar("Named", Instruction, StudyTask, Questionnaire, StimulusSet)


def bundled_protocols() -> tuple[str, ...]:
    """Return the names of the protocols that come with the program."""
    return tuple(sorted(path.stem for path in BUNDLED_FOLDER.glob("*.toml")))


def load_protocol(name_or_path: str) -> tuple[Protocol, Path]:
    """Return a bundled protocol or that of a file, and the file; raises AppError."""
    path = Path(name_or_path)
    if path.suffix != ".toml":
        path = BUNDLED_FOLDER / f"{name_or_path}.toml"
        if name_or_path not in bundled_protocols():
            known = ", ".join(bundled_protocols())
            raise AppError(f"no protocol is called '{name_or_path}': choose {known}, or a .toml")
    protocol = read_protocol(path)
    for name, settings in protocol.conditions.items():
        try:
            check_inputs(SessionOptions(scenario="companion", source="camera:0", **vars(settings)))
        except (AppError, AffectError, CharacterError) as error:
            raise AppError(f"{path.name}: condition {name!r}: {error}") from None
    return protocol, path


def protocol_text(like: str | None) -> str:
    """Return the text of a bundled protocol, or of the template; raises AppError."""
    path = Path(__file__).with_name("template.toml") if like is None else load_protocol(like)[1]
    return PROTOCOL_FILE.read_text(path)


def read_protocol(path: Path) -> Protocol:
    """Read a protocol; raises AppError, or AffectError, for one that could not be run."""
    text = PROTOCOL_FILE.read_text(path)
    content = parse(text, path.name, AppError)
    return _protocol(TomlTable(content, path.name, "", AppError, MAX_PARTS), path)


def _protocol(file: TomlTable, path: Path) -> Protocol:
    file.only(*KEYS)
    names = file.texts("conditions")
    if len(set(names)) < len(names):
        raise file.wrong("conditions", "two have the same name")
    settings = {name: table.fill(Settings) for name, table in file.tables("condition").items()}
    for name in settings:
        if name not in names:
            known = ", ".join(names) or "none"
            raise file.wrong("condition", f"{name!r} is none of the conditions, which are {known}")
    protocol = Protocol(
        path.stem,
        file.line("title"),
        file.text("about", ""),
        {name: settings.get(name, Settings()) for name in names},
        file.choice("design", ("within", "between"), "within"),  # type: ignore[arg-type]
        file.choice("order", ORDERS, "latin"),  # type: ignore[arg-type]
        file.whole("seed", 0, 2**32 - 1, 1),
        tuple(row.fill(Phase) for row in file.rows("phase")),
        _by_name(file, "instruction", lambda row: row.fill(Instruction)),
        _by_name(file, "task", lambda row: _task(row, path)),
        _by_name(file, "questionnaire", lambda row: questionnaire_of(row, path.parent)),
        _by_name(file, "stimuli", _stimuli),
        file.table("resume").fill(Resume),
        file.table("preregistered").fill(Preregistered),
        tuple(
            dict.fromkeys(
                (*_files(file, "questionnaire", "file"), *_files(file, "task", "scenario"))
            )
        ),
        file.truth("light_patch", False),
        file.table("wizard").fill(WizardPlan) if "wizard" in file else None,
        file.line("printed", ""),
    )
    _check_whole(protocol, file)
    return protocol


def _files(file: TomlTable, key: str, entry: str) -> Iterator[str]:
    """Yield the files that some rows name, which are beside the protocol."""
    for row in file.rows(key):
        name = row.value(entry)
        if isinstance(name, str) and name.endswith(".toml"):
            if Path(name).name != name:
                raise row.wrong(entry, "is a file beside the protocol: give its name alone")
            yield name


def _by_name(file: TomlTable, key: str, read: Callable[[TomlTable], Named]) -> dict[str, Named]:
    """Return what `read` makes of the rows of a key, by their names."""
    found: dict[str, Named] = {}
    for each in map(read, file.rows(key)):
        name = each.name
        if name in found or not name.strip() or not name.isprintable() or "/" in name:
            raise file.wrong(key, f"{name!r} is there twice, or is no name")
        found[name] = each
    return found


def _task(row: TomlTable, path: Path) -> StudyTask:
    task = row.fill(StudyTask)
    limit = row.number("limit_s", 1.0, MAX_LIMIT_S, task.limit_s)
    if task.goal.hold_s >= limit:
        raise row.wrong(
            "goal", f"cannot be reached: it holds {task.goal.hold_s:g} s of {limit:g} s"
        )
    if task.scenario.endswith(".toml"):
        task = replace(task, scenario=str(path.parent / task.scenario))
    try:
        check_scenario(task.scenario)
    except AppError as error:
        raise row.wrong("scenario", str(error)) from None
    return task


def _stimuli(row: TomlTable) -> StimulusSet:
    row.only("name", "ask", "of", "each", "pair", "file", "cross")
    stimuli: list[dict[str, str]] = []
    for cross in row.rows("cross"):
        levels = {name: cross.texts(name) for name in cross.names()}
        if len(stimuli) + math.prod(map(len, levels.values())) > MAX_STIMULI:
            raise row.wrong("cross", f"makes more than {MAX_STIMULI} stimuli")
        crossed = itertools.product(*levels.values())
        stimuli += [dict(zip(levels, chosen, strict=True)) for chosen in crossed]
    if not stimuli:
        raise row.wrong("cross", "a set of stimuli needs at least one")
    if len({tuple(sorted(each.items())) for each in stimuli}) < len(stimuli):
        raise row.wrong("cross", "makes the same stimulus twice")
    found = StimulusSet(
        row.line("name"),
        row.line("ask"),
        tuple(stimuli),
        row.texts("of"),
        row.whole("each", 0, MAX_STIMULI, 0),
        row.line("pair", ""),
        row.line("file", ""),
    )
    for name in filter(None, (*found.of, found.pair)):
        if any(name not in stimulus for stimulus in stimuli):
            raise row.wrong("", f"not every stimulus has the factor {name!r}")
    for key in ("ask", "file"):
        try:
            for stimulus in stimuli:
                getattr(found, key).format_map({**stimulus, "member": ""})
        except (KeyError, ValueError, IndexError, AttributeError):
            raise row.wrong(key, "names a factor that a stimulus lacks") from None
    for cell, group in found.groups().items():
        if found.each > len(group):
            words = ", ".join(cell) or "the set"
            raise row.wrong("each", f"{words} has {len(group)} stimuli, not {found.each}")
    return found


def _check_whole(protocol: Protocol, file: TomlTable) -> None:
    """Refuse what names something that is not there, and what cannot be reached."""
    if len(protocol.conditions) > MAX_CONDITIONS:
        raise file.wrong("conditions", f"there may be {MAX_CONDITIONS} at most")
    if not protocol.phases:
        raise file.wrong("phase", "a study needs at least one")
    kinds = (protocol.instructions, protocol.tasks, protocol.questionnaires, protocol.stimuli)
    known = [name for kind in kinds for name in kind]
    for name in known:
        if known.count(name) > 1:
            raise file.wrong("", f"two things are called {name!r}")
    if len({phase.name for phase in protocol.phases}) < len(protocol.phases):
        raise file.wrong("phase", "two have the same name")
    for phase in protocol.phases:
        _check_names(file, f"phase {phase.name!r}", phase.parts, known)
        if phase.order == "latin" and len(phase.parts) > MAX_CONDITIONS:
            raise file.wrong("phase", f"a Latin square has {MAX_CONDITIONS} parts at most")
        if len(set(phase.parts)) < len(phase.parts):
            raise file.wrong("phase", f"{phase.name!r} has a part twice")
    for task in protocol.tasks.values():
        _check_names(file, f"task {task.name!r}", task.then, list(protocol.questionnaires))
        for name, settings in protocol.conditions.items() or (("", Settings()),):
            _check_goal(file, task, name, settings)
    for each in protocol.stimuli.values():
        asked = dict.fromkeys(each.ask.format_map(stimulus) for stimulus in each.stimuli)
        _check_names(file, f"stimuli {each.name!r}", tuple(asked), list(protocol.questionnaires))


def _check_names(file: TomlTable, place: str, names: tuple[str, ...], known: list[str]) -> None:
    for name in names:
        if name not in known:
            raise file.wrong(
                "",
                f"{place} names {name!r}, which there is not; there are "
                f"{', '.join(known) or 'none'}",
            )


def _check_goal(file: TomlTable, task: StudyTask, condition: str, settings: Settings) -> None:
    """Refuse a goal that a scenario never reaches, whatever the participant does."""
    scenario, goal = find_scenario(task.scenario), task.goal
    reachable: tuple[str, ...] | None = None
    if goal.value == "mood":
        own = settings.personality or scenario.personality
        try:
            reachable = tuple(Personality.load(own).label_set.places)
        except AffectError as error:
            raise file.wrong("condition", f"{condition!r}: {error}") from None
    elif goal.value == "action" and scenario.roles:
        reachable = scenario.roles
    elif goal.value == "face":
        reachable = tuple(face.side for face in CubeModel.load(scenario.cube).faces)
    if reachable is not None and goal.equals not in reachable:
        under = f" under the condition {condition!r}" if condition else ""
        raise file.wrong(
            "task",
            f"the goal of {task.name!r} cannot be reached in {task.scenario}{under}: its "
            f"{goal.value} is one of {', '.join(dict.fromkeys(reachable))}, never {goal.equals!r}",
        )
