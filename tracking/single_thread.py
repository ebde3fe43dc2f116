"""Small equations are solved on one thread, whatever a program that uses the tracker has chosen.

The package asks OpenBLAS for one thread as it is imported, which comes too late where numpy was
imported before. On our small matrices its threads only wait for each other.
"""

from collections.abc import Callable
from functools import cache, wraps
from typing import ParamSpec, TypeVar

from threadpoolctl import ThreadpoolController

Given = ParamSpec("Given")
Result = TypeVar("Result")


@cache
def _thread_controller() -> ThreadpoolController | None:
    """Return what limits the threads of linear algebra; None where there is one thread anyway."""
    libraries = ThreadpoolController().select(user_api="blas")
    several = any(each["num_threads"] > 1 for each in libraries.info())
    return libraries if several else None


def on_one_thread(work: Callable[Given, Result]) -> Callable[Given, Result]:
    """Let a function do its linear algebra on one thread, and give the others back after it."""

    @wraps(work)
    def run_limited(*given: Given.args, **named: Given.kwargs) -> Result:
        threaded = _thread_controller()
        if threaded is None:
            return work(*given, **named)
        with threaded.limit(limits=1):
            return work(*given, **named)

    return run_limited
