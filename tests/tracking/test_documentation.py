"""The examples in the docstrings of this room are true."""

import doctest
import importlib
import pkgutil

import pytest

import tracking

MODULES = [module.name for module in pkgutil.walk_packages(tracking.__path__, "tracking.")]


@pytest.mark.parametrize("name", MODULES)
def test_examples_in_docstrings_are_true(name):
    results = doctest.testmod(importlib.import_module(name))
    assert results.failed == 0


def test_every_public_name_is_there():
    for name in tracking.__all__:
        assert getattr(tracking, name).__doc__
