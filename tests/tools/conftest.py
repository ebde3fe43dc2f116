"""Makes property tests use the same examples everywhere, and shared checks show their values."""

import pytest
from hypothesis import settings

pytest.register_assert_rewrite("tests.tools.authoring.clip_checks")

settings.register_profile("suite", derandomize=True, deadline=None)
settings.load_profile("suite")
