"""Opening the instruments that a user asks for; a library is loaded for those that need it."""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from cubeling.app.bridges.addresses import VMC_PORT, UdpAddress
from cubeling.app.errors import AppError

if TYPE_CHECKING:
    from cubeling.app.running.instrument import Instrument
    from cubeling.app.running.wizard.plan import WizardPlan
    from cubeling.app.ui.web.server import WebServer

LSL_SCOPES = ("machine", "link", "site")
"""Who finds our streams and whose streams we find, in LSL's words: this computer, its network, its
site."""

OSC_REMEDY = "pip install python-osc"
"""What brings the library of OSC and VMC."""

LSL_REMEDY = "pip install pylsl"
"""What brings the library of LSL."""

LIBLSL_REMEDY = (
    "pip install --upgrade pylsl (its wheels for glibc 2.35 and newer hold liblsl), or set "
    "PYLSL_LIB to a liblsl.so 1.17.7 or newer, as of conda's liblsl or the wheel of mne-lsl"
)
"""What brings LSL's own library where pylsl's wheel has none."""

LSL_CONFIG = "LSLAPICFG"
"""The variable that names LSL's own settings; who sets it says the scope there."""


@dataclass(frozen=True)
class InstrumentOptions:
    """Which instruments a user asks for; raises AppError for an address that is none."""

    osc: str | None = None
    """Where to send every channel by OSC: a port, or HOST:PORT."""

    osc_in: str | None = None
    """Where to take acts by OSC."""

    vmc: str | None = None
    """Where to send the cast by the VMC protocol: an address, or one for each, between commas."""

    lsl: bool = False
    """Whether to offer streams by LSL."""

    lsl_in: str | None = None
    """Name of the LSL stream whose markers are marks."""

    lsl_scope: str = LSL_SCOPES[0]
    """One of `LSL_SCOPES`."""

    wizard: bool = False
    """Whether to open a wizard's desk."""

    wizard_file: Path | None = None
    """The buttons of that desk; None for all that there are."""

    def __post_init__(self) -> None:
        if self.wizard_file is not None and not self.wizard:
            raise AppError("--wizard-file has the buttons of --wizard: give that too")
        for option, text in (("--osc", self.osc), ("--osc-in", self.osc_in)):
            if text is not None:
                UdpAddress.of(text, option)
        self.vmc_addresses()
        if self.lsl_scope not in LSL_SCOPES:
            raise AppError(f"--lsl-scope is one of {', '.join(LSL_SCOPES)}, not {self.lsl_scope}")

    def vmc_addresses(self) -> list[UdpAddress]:
        """Return where the cast is sent; raises AppError for an address that is none."""
        texts = [] if self.vmc is None else self.vmc.split(",")
        return [UdpAddress.of(text, "--vmc", VMC_PORT) for text in texts]


@contextmanager
def open_instruments(
    options: InstrumentOptions,
    say: Callable[[str], None],
    plan: WizardPlan | None = None,
    server: WebServer | None = None,
) -> Iterator[tuple[Instrument, ...]]:
    """Open the instruments that are asked for, and close them at the end.

    `plan` has the buttons of a wizard's desk, unless the options name a file; `server` serves it,
    else one of its own. `say` is called with lines about them. Raises AppError if a library
    is missing, or an address cannot be used.
    """
    with ExitStack() as closing:
        opened: list[Instrument] = []
        if options.osc or options.osc_in or options.vmc:
            check_osc()
        if options.osc is not None:
            from cubeling.app.bridges.osc import OscOut

            opened.append(closing.enter_context(OscOut(UdpAddress.of(options.osc, "--osc"))))
        if options.osc_in is not None:
            from cubeling.app.bridges.osc import OscIn

            address = UdpAddress.of(options.osc_in, "--osc-in")
            taken = closing.enter_context(OscIn(address, say))
            say(f"OSC is taken at {UdpAddress(address.host, taken.port)}")
            opened.append(taken)
        if options.vmc is not None:
            from cubeling.app.bridges.vmc import VmcOut

            opened.append(closing.enter_context(VmcOut(*options.vmc_addresses())))
        if options.lsl or options.lsl_in is not None:
            configure_lsl(options.lsl_scope)
            from cubeling.app.bridges.lsl import LslIn, LslOut

            if options.lsl:
                opened.append(closing.enter_context(LslOut()))
            if options.lsl_in is not None:
                opened.append(closing.enter_context(LslIn(options.lsl_in, say)))
        if options.wizard:
            server = server or _own_server(closing)
            from cubeling.app.running.wizard.desk import WizardDesk
            from cubeling.app.running.wizard.plan import read_wizard_plan

            if options.wizard_file is not None:
                plan = read_wizard_plan(options.wizard_file)
            desk = WizardDesk(server, plan)
            say(f"The wizard's desk: {' or '.join(desk.addresses)}")
            opened.append(desk)
        yield tuple(opened)


def _own_server(closing: ExitStack) -> WebServer:
    """Open a server for the desk alone; the stack closes it."""
    from cubeling.app.running.pages import open_pages

    server = open_pages()
    closing.callback(server.close)
    return server


def check_osc() -> None:
    """Raise AppError if the library of OSC is missing."""
    try:
        import pythonosc  # noqa: F401
    except ImportError:
        raise AppError(f"OSC needs a library: {OSC_REMEDY}") from None


def lsl_problem() -> tuple[str, str] | None:
    """Return why there is no LSL here, and what installs it; None if there is."""
    try:
        import pylsl  # noqa: F401
    except ImportError:
        return "no pylsl", LSL_REMEDY
    except (RuntimeError, OSError):  # it looks for the library while it is imported
        return "pylsl has no liblsl", LIBLSL_REMEDY
    return None


def configure_lsl(scope: str) -> None:
    """Let LSL find and be found within a scope only, and write nothing to the terminal.

    It counts from the first stream on. Raises AppError if LSL is missing or too old for it.
    """
    problem = lsl_problem()
    if problem is not None:
        raise AppError(f"LSL is missing, {problem[0]}: {problem[1]}")
    if LSL_CONFIG in os.environ:
        return
    import pylsl

    try:
        pylsl.set_config_content(f"[multicast]\nResolveScope = {scope}\n[log]\nlevel = -3\n")
    except (AttributeError, NotImplementedError):
        raise AppError(f"this liblsl is too old: {LIBLSL_REMEDY}") from None
