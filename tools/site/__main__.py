"""`python -m tools.site`: make the site in `build/docs`, and check every link in it.

It ends with 1 if a link leads nowhere, or if a public name is missing from the reference.
"""

import shutil
import sys
from pathlib import Path

from rich.console import Console

from tools.site.guides import Guides
from tools.site.links import broken_links
from tools.site.reference import make_reference

ROOT = Path(__file__).parents[2]


def main() -> int:
    """Make the site, and return the exit code."""
    folder = ROOT / "build" / "docs"
    shutil.rmtree(folder, ignore_errors=True)
    pages = Guides(ROOT, folder).make()
    names, missing = make_reference(folder / "api")
    broken = broken_links(folder)
    console = Console(highlight=False, markup=False, soft_wrap=True)
    for problem in (*(f"{name} is not in the reference" for name in missing), *broken):
        console.print(problem)
    shown = (folder / "index.html").relative_to(ROOT)
    console.print(f"{shown}: {pages} pages, {names} public names, {len(broken)} broken links")
    return 1 if broken or missing else 0


if __name__ == "__main__":
    sys.exit(main())
