"""Errors in code that plays, in one line that names the place: of a scenario, of the tracker."""

import inspect
import traceback
from collections.abc import Iterator
from contextlib import contextmanager

from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import Outcome, Scenario


@contextmanager
def scenario_errors(scenario: type[Scenario]) -> Iterator[None]:
    """Name the scenario and the line of code in every error but an `AppError`, and raise that.

    A bundled scenario's error is one of this program, and is left as it is.
    """
    try:
        yield
    except AppError:
        raise
    except Exception as error:
        if scenario.__module__.startswith("cubeling."):
            raise
        reason = _reason(error)
        raise AppError(
            f"the scenario '{scenario.name}' failed in {_place(scenario, error)}: {reason} "
            "(cubeling --debug shows the traceback)"
        ) from error


def check_outcome(outcome: object, scenario: type[Scenario]) -> Outcome:
    """Return what a scenario decided; raise AppError if it is no `Outcome`."""
    if not isinstance(outcome, Outcome):
        raise AppError(
            f"the scenario '{scenario.name}' failed in {inspect.getsourcefile(scenario)}: "
            f"its update returned {outcome!r:.60}, and not an Outcome"
        )
    return outcome


def described_error(error: Exception) -> str:
    """Return an error of this program with the module and line that raised it, in one line."""
    calls = list(traceback.walk_tb(error.__traceback__))
    own = [call for call in calls if call[0].f_globals.get("__name__", "").startswith("cubeling.")]
    frame, line = (own or calls)[-1]
    module = frame.f_globals.get("__name__", frame.f_code.co_filename)
    return f"{_reason(error)} in {module}, line {line}"


def _reason(error: Exception) -> str:
    first = str(error).strip().partition("\n")[0]  # OpenCV's have several lines
    return f"{type(error).__name__}: {first}".removesuffix(": ")


def _place(scenario: type[Scenario], error: Exception) -> str:
    """Return file and line of an error: the innermost ones in the package of the scenario."""
    package = scenario.__module__.split(".")[0]
    calls = list(traceback.walk_tb(error.__traceback__))
    own = [call for call in calls if call[0].f_globals.get("__name__", "").split(".")[0] == package]
    frame, line = (own or calls)[-1]
    return f"{frame.f_code.co_filename}, line {line}"
