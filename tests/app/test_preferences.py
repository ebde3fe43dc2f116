"""What a player left is there the next time, and nothing else is ever touched."""

import pytest
from hypothesis import given, strategies as st

from cubeling.app.errors import AppError
from cubeling.app.preferences import FILE_COMMENT, Preferences, PreferenceStore

SIZES = st.none() | st.tuples(st.integers(320, 9999), st.integers(180, 9999))
PREFERENCES = st.builds(
    Preferences,
    panels=st.lists(st.text(max_size=9)).map(tuple),
    panels_shown=st.booleans(),
    window_size=SIZES,
    full_screen=st.booleans(),
)


@given(PREFERENCES)
def test_what_is_kept_is_read_again(tmp_path_factory, preferences):
    path = tmp_path_factory.mktemp("kept") / "preferences.toml"
    store = PreferenceStore(path)
    store.change(**vars(preferences))
    store.save()
    assert store.problem is None
    assert PreferenceStore(path).now == preferences


def test_what_is_given_overrides_the_file_and_is_not_kept(tmp_path):
    path = tmp_path / "a" / "preferences.toml"
    first = PreferenceStore(path)
    first.change(full_screen=True)
    first.save()
    second = PreferenceStore(path, {"full_screen": False, "window_size": (640, 360)})
    assert second.now == Preferences(full_screen=False, window_size=(640, 360))
    second.change(panels_shown=True)
    second.save()
    assert PreferenceStore(path).now == Preferences(full_screen=True, panels_shown=True)
    assert list(path.parent.iterdir()) == [path], "the draft was left behind"


def test_what_another_session_kept_meanwhile_stays(tmp_path):
    path = tmp_path / "preferences.toml"
    one, other = PreferenceStore(path), PreferenceStore(path)
    one.change(full_screen=True)
    one.save()
    other.change(panels_shown=True)
    other.save()
    assert PreferenceStore(path).now == Preferences(full_screen=True, panels_shown=True)


def test_without_a_change_or_a_file_nothing_is_written(tmp_path):
    path = tmp_path / "preferences.toml"
    PreferenceStore(path, {"full_screen": True}).save()
    memory = PreferenceStore(None)
    memory.change(full_screen=True)
    memory.save()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (b"# Cubeling\n\x00\xff", "not UTF-8 (byte 12)"),
        (b"panels = [", "Invalid value"),
        (b'[project]\nname = "mine"\n', 'it has no line program = "cubeling"'),
        (b'program = "cubeling"\nfull_screen = "perhaps"\n', "full_screen"),
        (b'program = "cubeling"\nwindow_size = [3, 2]\n', "at least 320x180, not 3x2"),
    ],
)
def test_a_broken_or_foreign_file_is_ignored_and_left_as_it_is(tmp_path, content, reason):
    path = tmp_path / "some.toml"
    path.write_bytes(content)
    store = PreferenceStore(path)
    assert store.now == Preferences()
    assert store.problem is not None
    assert str(path) in store.problem
    assert reason in store.problem
    assert "\n" not in store.problem
    store.change(full_screen=True)
    store.save()
    assert path.read_bytes() == content


def test_keys_of_a_newer_program_are_skipped(tmp_path):
    path = tmp_path / "preferences.toml"
    path.write_text('program = "cubeling"\nsmell = "roses"\nfull_screen = true\n')
    assert PreferenceStore(path).now == Preferences(full_screen=True)


def test_a_file_that_cannot_be_written_is_reported(tmp_path):
    (tmp_path / "file").write_text("")
    store = PreferenceStore(tmp_path / "file" / "preferences.toml")
    store.change(full_screen=True)
    store.save()
    assert store.problem is not None


def test_a_linked_file_stays_a_link(tmp_path):
    target, link = tmp_path / "target.toml", tmp_path / "link.toml"
    target.write_text("")
    try:
        link.symlink_to(target)
    except OSError:
        pytest.skip("this system makes no links")
    store = PreferenceStore(link)
    store.change(full_screen=True)
    store.save()
    assert link.is_symlink()
    assert target.read_text().startswith(FILE_COMMENT)


def test_a_window_that_is_too_small_is_refused():
    with pytest.raises(AppError, match="at least 320x180"):
        PreferenceStore(None, {"window_size": (100, 100)})
