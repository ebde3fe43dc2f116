"""Lets shared checks show their values when they fail."""

import pytest

pytest.register_assert_rewrite("tests.tools.authoring.clip_checks")
