"""`python -m tools.package_check`: build what is published, and try it as a stranger would.

Builds the source archive and from it the wheel, and looks at what is in both: the archive is a copy
of the repository. Installs the wheel into a fresh environment beside Robot Framework, whose package
is named `robot` as one of our rooms is, and, from an empty folder, examines the computer, plays a
bundled session, and plays the scenario that docs/your-own-scenario.md builds. It asks the package
index, as the tests do not.
"""

import re
import subprocess
import sys
import tarfile
import tempfile
import venv
import zipfile
from pathlib import Path

from rich.console import Console

from tools.package_links import ROOMS

ROOT = Path(__file__).parents[1]

OUT = Console(highlight=False)

PACKAGE = "cubeling"


def main() -> int:
    """Build, install and try the package; return 1 if something is not as it should be."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        archive, wheel = build(folder / "dist")
        problems = problems_of_archive(archive)
        problems += problems_of(wheel)
        problems += try_out(wheel, folder)
    for problem in problems:
        OUT.out(f"✗ {problem}")
    OUT.out(f"{wheel.name}: {'not fit to publish' if problems else 'fit to publish'}")
    return bool(problems)


def build(folder: Path) -> tuple[Path, Path]:
    """Build the source archive and from it the wheel; return both."""
    _run(sys.executable, "-m", "build", "--outdir", str(folder), str(ROOT), folder=ROOT)
    (archive,), (wheel,) = folder.glob("*.tar.gz"), folder.glob("*.whl")
    return archive, wheel


def problems_of_archive(archive: Path) -> list[str]:
    """Return what is wrong with the content of a source archive: all tracked files are in it."""
    with tarfile.open(archive) as file:
        names = {Path(*Path(each.name).parts[1:]) for each in file.getmembers() if each.isfile()}
    made = {name for name in names if name.parts[0].endswith(".egg-info")}
    made |= {Path("PKG-INFO"), Path("setup.cfg")}
    tracked = _tracked_files()
    OUT.out(f"the source archive holds {len(names & tracked)} of {len(tracked)} tracked files")
    problems = [f"the source archive leaves out {each}" for each in sorted(tracked - names)]
    beside = sorted(names - made - tracked)
    return problems + [f"the source archive holds {each}, which is not tracked" for each in beside]


def problems_of(wheel: Path) -> list[str]:
    """Return what is wrong with the content of a wheel."""
    with zipfile.ZipFile(wheel) as archive:
        names = {Path(each) for each in archive.namelist()}
    tops = {name.parts[0] for name in names}
    inside = {name.parts[1] for name in names if name.parts[0] == PACKAGE and len(name.parts) > 2}
    OUT.out(f"the wheel holds {len(names)} files in {', '.join(sorted(tops))}: {sorted(inside)}")
    beside = {each for each in tops if not each.endswith(".dist-info")} - {PACKAGE}
    problems = [f"it puts {each} beside {PACKAGE}" for each in beside]
    problems += [f"the room {each} is missing" for each in {*ROOMS} - inside]
    left_out = {PACKAGE / each for each in _tracked_files(*ROOMS)} - names
    return problems + [f"it leaves out {each}" for each in sorted(left_out) if each.suffix != ".md"]


def try_out(wheel: Path, folder: Path) -> list[str]:
    """Return what does not work in a fresh environment, beside Robot Framework."""
    environment, empty = folder / "environment", folder / "empty"
    empty.mkdir()
    venv.create(environment, with_pip=True)
    scripts = environment / ("Scripts" if sys.platform == "win32" else "bin")
    python, cubeling = str(scripts / "python"), str(scripts / "cubeling")
    pip = (python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check")
    constraints = ("--constraint", str(ROOT / "constraints.txt"))
    _run(*pip, *constraints, str(wheel), "robotframework", folder=empty)
    _run(*pip, "--no-deps", str(_greeter(folder)), folder=empty)
    session = "import cubeling.recordings as r; print(*r.__path__)"
    recordings = Path(_run(python, "-c", session, folder=empty).strip())
    replay = (cubeling, "replay", str(recordings / "companion.mcap"), "--end", "2")
    trials = {
        "the computer is examined": (cubeling, "doctor"),
        "a session is played": (*replay, "--output", "two.mp4"),
        "a scenario of somebody else is played": (*replay, "--no-pictures", "--scenario", "greet"),
        "Robot Framework starts": (python, "-c", "import robot; robot.run"),
    }
    problems = []
    for claim, command in trials.items():
        try:
            _run(*command, folder=empty)
        except subprocess.CalledProcessError as error:
            problems.append(f"{claim}: {error.stderr.strip().splitlines()[-1:]}")
        else:
            OUT.out(f"✓ {claim}")
    return problems


def _tracked_files(*folders: str) -> set[Path]:
    """Return the files of the repository, or of some folders of it."""
    listed = _run("git", "ls-files", *folders, folder=ROOT)
    return {Path(each) for each in listed.splitlines()}


def _greeter(folder: Path) -> Path:
    """Write the package that docs/your-own-scenario.md builds; return its folder."""
    page = (ROOT / "docs" / "your-own-scenario.md").read_text("utf-8")
    (toml,) = re.findall(r"```toml\n(.*?)```", page, re.DOTALL)
    (python,) = re.findall(r"```python\n(.*?)```", page, re.DOTALL)
    greeter = folder / "greet"
    greeter.mkdir()
    (greeter / "pyproject.toml").write_text(toml, "utf-8")
    (greeter / "cubeling_greet.py").write_text(python, "utf-8")
    return greeter


def _run(*command: str, folder: Path) -> str:
    """Run a command in a folder; return its output."""
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True, timeout=600)
    if run.returncode:
        Console(stderr=True).out(run.stdout + run.stderr)
        run.check_returncode()
    return run.stdout


if __name__ == "__main__":
    sys.exit(main())
