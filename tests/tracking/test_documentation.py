"""Every public name of this room is documented."""

import importlib


def test_every_public_name_is_there():
    tracking = importlib.import_module("cubeling.tracking")
    for name in tracking.__all__:
        assert getattr(tracking, name).__doc__
