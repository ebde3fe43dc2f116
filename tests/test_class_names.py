"""A name of a public class means one class, in whichever room a reader meets it."""

import re
from collections import defaultdict
from pathlib import Path

from tools.package_links import ROOMS

ROOT = Path(__file__).parent.parent


def test_no_two_public_classes_have_one_name():
    places = defaultdict(list)
    for room in ROOMS:
        for path in (ROOT / room).rglob("*.py"):
            for name in re.findall(r"^class ([A-Za-z]\w*)[(:]", path.read_text(), re.MULTILINE):
                places[name].append(str(path.relative_to(ROOT)))
    assert {name: paths for name, paths in places.items() if len(paths) > 1} == {}
