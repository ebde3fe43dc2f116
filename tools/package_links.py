"""`python -m tools.package_links`: link the rooms into one folder, as they are when installed.

Type checkers and import-linter read files and know nothing of the mapping that an editable install
makes in Python (mypy #13392). With `build/packages` on their path they find `cubeling.tracking` and
the others. The links are not committed, as Git on Windows makes text files of links.
"""

from pathlib import Path

ROOT = Path(__file__).parents[1]

ROOMS = ("affect", "tracking", "characters", "robot", "app", "recordings")

LINKED = (*ROOMS, *(f"cubeling/{path.name}" for path in (ROOT / "cubeling").glob("*.py*")))


def main() -> None:
    """Make `build/packages/cubeling` with a link to each room."""
    package = ROOT / "build" / "packages" / "cubeling"
    package.mkdir(parents=True, exist_ok=True)
    for name in LINKED:
        source = ROOT / name
        link = package / source.name
        if not link.exists():
            link.symlink_to(Path("../../..") / name)


if __name__ == "__main__":
    main()
