"""The audit of constraints.txt: what pip-audit reports becomes lines, and silence is no success."""

from typing import Any

import pytest

from tools.audit import NotAuditedError, check_reachable, problems_of

KNOWN: dict[str, Any] = {"name": "numpy", "version": "2.4.6", "vulns": []}
UNKNOWN: dict[str, Any] = {"name": "pillow", "skip_reason": "Dependency not found on PyPI"}
FAULTY: dict[str, Any] = {
    "name": "pillow",
    "version": "13.0.0",
    "vulns": [
        {
            "id": "PYSEC-2026-1",
            "aliases": ["CVE-2026-1"],
            "fix_versions": ["13.0.1"],
            "description": "An image that overruns a buffer",
        }
    ],
}


def test_each_vulnerability_is_a_line_with_the_version_that_fixes_it():
    assert problems_of([KNOWN, FAULTY]) == [
        "pillow 13.0.0: PYSEC-2026-1, CVE-2026-1; fixed in 13.0.1"
    ]
    unfixed = {**FAULTY, "vulns": [{**FAULTY["vulns"][0], "fix_versions": []}]}
    assert problems_of([unfixed])[0].endswith("fixed in no version yet")


def test_a_package_that_the_index_does_not_know_is_a_problem():
    assert problems_of([KNOWN, UNKNOWN]) == ["pillow: Dependency not found on PyPI"]


def test_an_index_that_knows_no_package_has_audited_nothing():
    check_reachable("numpy==2.4.6", lambda pins: [KNOWN])
    with pytest.raises(NotAuditedError, match="not found"):
        check_reachable("pillow==13.0.0", lambda pins: [UNKNOWN])
