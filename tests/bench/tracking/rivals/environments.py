"""Where each tracker lives: its module, its argument, and what its environment must hold.

The environments are made on demand in `.bench/NAME` of the repository, which git ignores.
"""

import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[4]
"""Of the repository: every tracker runs there."""

ENVIRONMENTS = {
    "rapidtag": ("rapidtag==0.1.12", "numpy==2.4.6", "opencv-contrib-python-headless==5.0.0.93"),
    # aprilcube refuses OpenCV 5 and insists on the build with windows.
    "aprilcube": ("aprilcube==0.3.1", "numpy==2.4.6", "opencv-contrib-python==4.14.0.94"),
}
"""The exact packages of each environment: a newer rival deserves a new table."""


@dataclass(frozen=True)
class Entry:
    """One tracker of the benchmark."""

    title: str
    """As the tables name it."""

    module: str
    """Run by its Python, with `-m`."""

    argument: str = ""
    """To the module, or ""."""

    environment: str = ""
    """One of `ENVIRONMENTS`; "" for Cubeling's own."""

    every: int = 1
    """Asked for every so many-th frame only; a tracker with no past loses nothing by that."""


_RIVALS = "tests.bench.tracking.rivals"

ENTRIES = {
    "ours": Entry("Cubeling", "tests.bench.tracking.ours"),
    "subpix": Entry("cv2 SUBPIX", f"{_RIVALS}.opencv", "SUBPIX"),
    "apriltag": Entry("cv2 APRILTAG", f"{_RIVALS}.opencv", "APRILTAG", every=4),
    "aruco3": Entry("cv2 ArUco3", f"{_RIVALS}.opencv", "ARUCO3"),
    "rapidtag": Entry("rapidtag", f"{_RIVALS}.rapid", environment="rapidtag"),
    "aprilcube": Entry("aprilcube", f"{_RIVALS}.april", "filtered", "aprilcube"),
    "unfiltered": Entry("aprilcube raw", f"{_RIVALS}.april", "unfiltered", "aprilcube"),
}
"""All trackers, by the name that `--trackers` takes."""


class UnavailableError(Exception):
    """A tracker cannot run here; says in one line why."""


def python_of(environment: str) -> Path:
    """Return the Python of an environment, which is made first where it is not there.

    Raises
    ------
    UnavailableError
        It could not be made: no package index, or no build for this machine.
    """
    if not environment:
        return Path(sys.executable)
    folder, wanted = ROOT / ".bench" / environment, "\n".join(ENVIRONMENTS[environment])
    scripts = folder / ("Scripts" if sys.platform == "win32" else "bin")
    installed = folder / "installed.txt"
    if not installed.is_file() or installed.read_text(encoding="utf-8") != wanted:
        shutil.rmtree(folder, ignore_errors=True)
        _run(environment, sys.executable, "-m", "venv", str(folder))
        _run(environment, str(scripts / "python"), "-m", "pip", "install", "--quiet",
             "--disable-pip-version-check", *ENVIRONMENTS[environment])  # fmt: skip
        installed.write_text(wanted, encoding="utf-8")
    return scripts / "python"


def _run(environment: str, *command: str) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        said = [line for line in done.stderr.splitlines() if line.startswith("ERROR")]
        reason = (
            said[-1].removeprefix("ERROR: ")
            if said
            else f"{' '.join(command[1:4])} ended with {done.returncode}"
        )
        raise UnavailableError(f"its environment .bench/{environment} cannot be made: {reason}")
