"""Every public name of this room is documented."""

from cubeling import tracking


def test_every_public_name_is_there():
    for name in tracking.__all__:
        assert getattr(tracking, name).__doc__
