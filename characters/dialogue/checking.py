"""What is refused of a script that can be read: what could never happen, or would never end."""

from collections.abc import Iterator

from cubeling.characters.dialogue.patterns import FILLED, WordPattern
from cubeling.characters.dialogue.script import (
    ANY_LANGUAGE,
    DialogueScript,
    Localized,
    ScriptItem,
    Unit,
    UnitTransition,
)
from cubeling.characters.errors import CharacterError
from cubeling.toml_file import printable


def check_script(script: DialogueScript, line: int) -> None:
    """Refuse a script that cannot be played; `line` is that of its root.

    Raises
    ------
    CharacterError
        In one line: what is wrong, at which line of it.
    """
    if not script.units:
        raise _error(script, line, "a dialogue without a unit")
    lines: dict[str, int] = {}
    remembered = _remembered(script)
    for name, slot in script.slots.items():
        _check_texts(script, slot, remembered)
        if name not in remembered:
            raise _error(script, slot.line, f"no pattern has the slot {{{name}}}")
    for unit in script.units:
        if unit.name in lines:
            raise _error(
                script,
                unit.line,
                f"a second unit '{unit.name}'; the first is at line {lines[unit.name]}",
            )
        lines[unit.name] = unit.line
        _check_states(script, unit)
        _check_loops(script, unit)
        for state in unit.states.values():
            for transition in state.transitions:
                _check_fallback(script, transition)
                for item in (*transition.conditions, *transition.actions):
                    _check_texts(script, item, remembered)


def _check_states(script: DialogueScript, unit: Unit) -> None:
    """Refuse states that are not there, cannot be reached or cannot be left."""
    reached, found = {unit.start}, [unit.start]
    while found:
        for transition in unit.states[found.pop()].transitions:
            if transition.target not in unit.states:
                known = ", ".join(unit.states)
                raise _error(
                    script,
                    transition.line,
                    f"there is no state '{transition.target}' in the unit '{unit.name}': {known}",
                )
            if transition.target not in reached:
                reached.add(transition.target)
                found.append(transition.target)
    for state in unit.states.values():
        if state.name not in reached:
            why = f"the state '{state.name}' of the unit '{unit.name}' is never reached"
            raise _error(script, state.line, why)
        if not state.transitions and not state.accepting:
            why = (
                f"the state '{state.name}' of the unit '{unit.name}' leads nowhere: give it a "
                'transition, or accepting="yes"'
            )
            raise _error(script, state.line, why)


def _check_loops(script: DialogueScript, unit: Unit) -> None:
    """Refuse a circle of transitions that wait for nothing: it would never end."""
    done: set[str] = set()
    for first in unit.states:
        on_way: dict[str, Iterator[UnitTransition]] = {first: _unwaiting(unit, first)}
        while on_way:
            state = next(reversed(on_way))
            transition = next(on_way[state], None)
            if transition is None:
                done.add(state)
                del on_way[state]
                continue
            target = unit.after(transition.target)
            if target in on_way:
                why = (
                    f"an endless loop in the unit '{unit.name}', as nothing is waited for between "
                    f"'{target}' and '{target}': give a transition an input_match or a silence"
                )
                raise _error(script, transition.line, why)
            if target not in done:
                on_way[target] = _unwaiting(unit, target)


def _unwaiting(unit: Unit, state: str) -> Iterator[UnitTransition]:
    return iter([each for each in unit.states[state].transitions if not each.waits])


def _check_fallback(script: DialogueScript, transition: UnitTransition) -> None:
    """Refuse an answer to everything that is always the same."""
    for action in transition.actions:
        if not transition.is_open or action.kind != "say":
            continue
        for language in script.languages:
            if len(set(action.argument.of(language))) < 2:
                why = f"one text answers everything in '{language}': give it two or more"
                raise _error(script, action.line, why)


def _check_texts(script: DialogueScript, item: ScriptItem, remembered: set[str]) -> None:
    """Refuse texts in languages that the script lacks, missing ones, and slots nobody fills."""
    if not isinstance(item.argument, Localized):
        return
    for code, text in item.argument:
        if code not in (*script.languages, ANY_LANGUAGE):
            known = ", ".join(script.languages)
            raise _error(script, item.line, f"lang='{code:.20}' is none of the languages {known}")
        if item.kind != "say":
            continue
        for slot in FILLED.finditer(text):
            if slot[1].lower() not in remembered and slot[2] is None:
                why = f"nothing fills {slot[0]}; write {{{slot[1]}|something else}}"
                raise _error(script, item.line, why)
    for language in script.languages:
        if item.kind == "say" and not item.argument.of(language):
            raise _error(script, item.line, f"there is no text in '{language}'")


SAID_SLOT = "said"
"""The slot of what was heard of the last reply."""


def _remembered(script: DialogueScript) -> set[str]:
    """Return the slots that something fills."""
    found = {SAID_SLOT, *(action.argument[0] for action in script.actions("remember"))}
    for transition in script.transitions:
        for condition in transition.conditions:
            if isinstance(condition.argument, Localized):
                patterns = (each for _, each in condition.argument if isinstance(each, WordPattern))
                found.update(slot for pattern in patterns for slot in pattern.slots)
    return found


def _error(script: DialogueScript, line: int, why: str) -> CharacterError:
    return CharacterError(printable(f"{script.place(line)}: {why}"))
