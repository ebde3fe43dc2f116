"""The options of the commands that play: what other programs follow, and what they may ask for."""

from __future__ import annotations

import functools
import inspect
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer
from rich.console import Console

from cubeling.app.bridges.opening import LSL_SCOPES, InstrumentOptions
from cubeling.app.commands.access import (
    Broker,
    Ca,
    PasswordFile,
    PlayerName,
    Site,
    check_publisher,
    publisher,
)
from cubeling.app.ui.literal_text import literal_text
from cubeling.robot.network import DEFAULT_SITE

if TYPE_CHECKING:
    from cubeling.app.running.instrument import Instrument
    from cubeling.app.running.wizard.plan import WizardPlan
    from cubeling.app.ui.web.server import WebServer

INSTRUMENT_GROUP = "Other programs and instruments (see docs/instruments.md)"
"""Heading of these options in a help."""


def _option(kind: Any, name: str, words: str) -> Any:
    """Return the annotation of an option, as typer reads it."""
    return Annotated[kind, typer.Option(name, help=words, rich_help_panel=INSTRUMENT_GROUP)]


INSTRUMENTS: Mapping[str, tuple[Any, Any]] = {
    "osc": (
        _option(str | None, "--osc", "Send every channel by OSC to PORT, or to HOST:PORT."),
        None,
    ),
    "osc_in": (
        _option(
            str | None,
            "--osc-in",
            "Let OSC at PORT make characters act, speak and feel, and set marks; with HOST:PORT "
            "from other computers too.",
        ),
        None,
    ),
    "vmc": (
        _option(
            str | None,
            "--vmc",
            "Show the character in Unity, Blender, VSeeFace …, by the VMC protocol, at HOST, PORT "
            "or HOST:PORT; others of a cast at the next ports, or after commas.",
        ),
        None,
    ),
    "lsl": (
        _option(bool, "--lsl", "Offer cube, actions, emotion and marks to Lab Streaming Layer."),
        False,
    ),
    "lsl_in": (
        _option(
            str | None, "--lsl-in", "Take the markers of the LSL stream of this name as marks."
        ),
        None,
    ),
    "lsl_scope": (
        _option(str, "--lsl-scope", f"How far LSL reaches: {', '.join(LSL_SCOPES)}."),
        LSL_SCOPES[0],
    ),
    "wizard": (
        _option(
            bool,
            "--wizard",
            "Serve a page by which an experimenter drives character and robot.",
        ),
        False,
    ),
    "wizard_file": (
        _option(Path | None, "--wizard-file", "The buttons of that page, in a .toml file."),
        None,
    ),
}
"""The annotation and the default of each option, by the fields of `InstrumentOptions`."""

NETWORK: Mapping[str, tuple[Any, Any]] = {
    "mqtt": (Broker, None),
    "player": (PlayerName, None),
    "site": (Site, DEFAULT_SITE),
    "password_file": (PasswordFile, None),
    "ca": (Ca, None),
}
"""The same of players and robots on other computers."""


@dataclass(frozen=True)
class GivenInstruments:
    """What the command line says of instruments and players."""

    options: InstrumentOptions

    network: Mapping[str, Any]
    """The values of `NETWORK`."""

    @property
    def asked(self) -> bool:
        """Whether any is asked for."""
        return self.options != InstrumentOptions() or self.network["mqtt"] is not None

    @contextmanager
    def open(
        self, plan: WizardPlan | None = None, server: WebServer | None = None
    ) -> Iterator[tuple[Instrument, ...]]:
        """Open what is asked for, and close it at the end; the errors are one line each.

        A plan has the buttons of a wizard's desk, which it opens; `server` serves it, or its own.
        """
        from cubeling.app.bridges.opening import open_instruments

        options = replace(self.options, wizard=self.options.wizard or plan is not None)
        with (
            publisher(*self.network.values()) as players,
            open_instruments(options, say, plan, server) as others,
        ):
            yield (*players, *others)


def say(line: str) -> None:
    """Print a line about an instrument on standard error, beside the progress."""
    Console(stderr=True, soft_wrap=True, highlight=False).print(literal_text(line))


def with_instruments(command: Callable[..., None]) -> Callable[..., None]:
    """Give a command the options of all instruments; it gets them as `instruments`."""
    signature = inspect.signature(command, eval_str=True)
    own = [each for each in signature.parameters.values() if each.name != "instruments"]
    added = [
        inspect.Parameter(
            name, inspect.Parameter.KEYWORD_ONLY, default=default, annotation=annotation
        )
        for name, (annotation, default) in {**INSTRUMENTS, **NETWORK}.items()
    ]
    # What the outer decorators add comes last.
    ordered = sorted([*own, *added], key=lambda each: each.kind)

    @functools.wraps(command)
    def run_command(**arguments: Any) -> None:
        network = {name: arguments.pop(name) for name in NETWORK}
        options = InstrumentOptions(**{name: arguments.pop(name) for name in INSTRUMENTS})
        check_publisher(network["mqtt"], network["player"])
        command(**arguments, instruments=GivenInstruments(options, network))

    run_command.__signature__ = signature.replace(parameters=ordered)  # type: ignore[attr-defined]
    run_command.__annotations__ = {each.name: each.annotation for each in ordered}
    return run_command
