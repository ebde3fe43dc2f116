"""What a person writes in TOML: read whatever it is, and refused in one line that says where."""

import time
from dataclasses import dataclass
from typing import Literal

import pytest
from hypothesis import given, strategies as st

from cubeling.toml_file import MAX_ENTRIES, MAX_FILE_BYTES, TomlTable, parse, read, toml_kind

NOTES = toml_kind("note", ValueError, "none:none")


def outcome(do, *what) -> str | None:
    """Return the line with which something is refused; None if it is not."""
    try:
        do(*what)
    except ValueError as error:
        line = str(error)
    else:
        return None
    assert line.isprintable()
    assert len(line) < 400
    return line


def refusal(do, *what) -> str:
    line = outcome(do, *what)
    assert line is not None
    return line


def table(**values) -> TomlTable:
    return TomlTable({"moods": values}, "my.toml").table("moods")


# --- The file -------------------------------------------------------------------------------------


def test_a_file_is_read_as_an_editor_of_any_system_saves_it(tmp_path):
    path = tmp_path / "mine.toml"
    for text in (b'a = "\xc3\xa9"\nb = 1\n', b'\xef\xbb\xbfa = "\xc3\xa9"\r\nb = 1\r\n'):
        path.write_bytes(text)
        assert read(path, NOTES) == {"a": "é", "b": 1}


def test_what_is_not_there_or_is_no_file_is_refused(tmp_path):
    for name in ("none.toml", ".", "a\0b", "a\nb"):
        assert refusal(read, tmp_path / name, NOTES).startswith("cannot read ")


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"a = = 1", "not TOML: Invalid value (at line 1, column 5)"),
        (b"a = 1\na = 2", "not TOML: Cannot overwrite a value"),
        (b"a = \xff", "not UTF-8 (byte 4)"),
        (b"\xff\xfea\0", "not UTF-8 (byte 0)"),
        (b"# \n" * MAX_FILE_BYTES, "of at most 65.5 kB"),
        (b"a = " + b"9" * 1990 + b"\nb = [" + b"9" * 3000 + b"]", "more than 2000 characters"),
        (b"a = " + b"[" * 1900, "too deeply nested"),
    ],
)
def test_what_is_no_toml_is_refused_with_its_place(tmp_path, content, says):
    (tmp_path / "x.toml").write_bytes(content)
    line = refusal(read, tmp_path / "x.toml", NOTES)
    assert str(tmp_path / "x.toml") in line
    assert says in line


@pytest.mark.parametrize(
    "text", ["a." * (MAX_FILE_BYTES // 2 - 3) + "a = 1", "a = " + "9" * 60_000]
)
def test_a_file_made_to_keep_us_busy_is_refused_at_once(text):
    begun = time.process_time()
    refusal(parse, text, "x.toml")
    assert time.process_time() - begun < 1.0


@given(st.one_of(st.text(), st.text("[]{}=.\"'\\#ab1-_:\n\r\t \0", max_size=60)))
def test_any_text_is_toml_or_is_refused_in_one_line(text):
    line = outcome(parse, text, "x.toml")
    assert line is None or line.startswith("x.toml: ")


# --- The table ------------------------------------------------------------------------------------

READER_OF_KIND = {
    "text": lambda one: one.text("key"),
    "texts": lambda one: one.texts("key"),
    "number": lambda one: one.number("key", -1, 1),
    "any number": lambda one: one.number("key"),
    "whole": lambda one: one.whole("key", 0, 100),
    "truth": lambda one: one.truth("key", default=True),
    "list": lambda one: one.list("key", "pairs"),
    "table": lambda one: one.table("key", "valence", "arousal"),
    "tables": lambda one: one.tables("key", "valence", "arousal"),
}


@pytest.mark.parametrize(
    ("kind", "value", "says"),
    [
        ("text", 3, "must be a text, not 3"),
        ("texts", "a", f"must be a list of at most {MAX_ENTRIES} texts, not 'a'"),
        ("texts", ["a"] * 65, "must be a list of at most"),
        ("texts", ["a", 3], "must be texts that can be printed, none of them empty, not 3"),
        ("texts", [" "], "none of them empty, not ' '"),
        ("texts", ["a\n"], "can be printed"),
        ("number", 1.5, "must be a number from -1 to 1, not 1.5"),
        ("number", True, "must be a number from -1 to 1, not True"),
        ("number", "1", "must be a number from -1 to 1, not '1'"),
        ("number", float("nan"), "must be a number from -1 to 1, not nan"),
        ("any number", float("nan"), "must be a number, not nan"),
        ("any number", 10**400, "must be a number, not 1000"),
        pytest.param("any number", 10**5000, "not something so long", id="any number of digits"),
        ("whole", 101, "must be a whole number from 0 to 100, not 101"),
        ("whole", 1.0, "must be a whole number from 0 to 100, not 1.0"),
        ("whole", True, "must be a whole number from 0 to 100, not True"),
        ("truth", 1, "must be true or false, not 1"),
        ("list", 1, f"must be a list of at most {MAX_ENTRIES} pairs, not 1"),
        ("table", 1, "must be a table of valence, arousal, not 1"),
        ("table", {"v": 1}, ".v means nothing here; there are valence, arousal"),
        ("tables", {"": {}}, ": a name has 1 to 64 bytes, all of them printable"),
        ("tables", {"a\nb": {}}, ".'a\\nb': a name has"),
        ("tables", {"ж" * 33: {}}, ": a name has 1 to 64 bytes"),
        ("tables", {"kiss": 0.1}, ".kiss must be a table of valence, arousal, not 0.1"),
        ("tables", {"kiss": {"v": 1}}, ".kiss.v means nothing here"),
        ("tables", {str(n): {} for n in range(65)}, " must have at most 64 entries, not 65"),
    ],
)
def test_a_value_of_another_kind_is_refused_with_file_key_and_what_is_allowed(kind, value, says):
    line = refusal(READER_OF_KIND[kind], table(key=value))
    assert line.startswith("my.toml: moods.key")
    assert says in line


def test_values_of_the_right_kind_are_given():
    one = table(a="t", b=["t"], c=1, d=-0.5, e=3, f=False, g=[[1]], h={"x": {"v": 1}})
    assert (one.text("a"), one.texts("b"), one.number("c"), one.number("d", -1, 1)) == (
        "t", ("t",), 1.0, -0.5,
    )  # fmt: skip
    assert (one.whole("e", 0, 9), one.truth("f", default=True), one.list("g", "")) == (
        3, False, [[1]],
    )  # fmt: skip
    assert one.tables("h", "v")["x"].whole("v", 0, 9) == 1
    assert isinstance(one.number("c"), float)
    one.only(*"abcdefgh")
    assert "a" in one
    assert "z" not in one


def test_what_is_left_out_is_the_default_or_is_missed():
    one = table()
    assert (one.text("a", "x"), one.texts("a", ("y",)), one.number("a", 0, 1, 0.5)) == (
        "x", ("y",), 0.5,
    )  # fmt: skip
    assert (one.whole("a", 0, 9, 3), one.truth("a", True), one.list("a", "pairs")) == (3, True, [])
    assert one.table("a", "b").names() == []
    for kind in ("text", "number", "whole"):
        assert "moods.key is missing; it must be a" in refusal(READER_OF_KIND[kind], one)


def test_a_key_that_means_nothing_is_refused_with_those_that_do():
    assert refusal(table(colour=1).only, "posture", "sound") == (
        "my.toml: moods.colour means nothing here; there are posture, sound"
    )


values = st.recursive(
    st.one_of(st.text(), st.integers(), st.floats(), st.booleans(), st.dates()),
    lambda one: st.one_of(st.lists(one, max_size=3), st.dictionaries(st.text(), one, max_size=3)),
)


@given(st.sampled_from(sorted(READER_OF_KIND)), values)
def test_a_value_of_any_kind_is_given_or_refused_in_one_short_line(kind, value):
    line = outcome(READER_OF_KIND[kind], table(key=value))
    assert line is None or line.startswith("my.toml: moods.key")


def test_a_message_is_one_line_whatever_keys_lead_to_its_place():
    inner = table(**{"a\nb": {"c": {}}}).table("a\nb").table("c")
    assert refusal(inner.number, "d").startswith("my.toml: moods.'a\\nb'.c.d is missing")


def test_lists_of_tables_of_numbers_and_choices_are_given_or_refused_with_their_place():
    one = table(rows=[{"at": [1, 2.5], "mode": "slow"}, {"at": [], "mode": "slo"}, {"mod": 1}])
    first, second, third = one.rows("rows")
    assert (first.numbers("at", 2), first.choice("mode", ("slow", "fast"))) == ((1.0, 2.5), "slow")
    assert third.numbers("at", 2, default=(0.0, 1.0)) == (0.0, 1.0)
    for do, says in (
        (lambda: second.numbers("at", 2), "[1].at must be a list of 2 numbers, not []"),
        (lambda: first.numbers("at", 2, 0, 2), "[0].at must be a number from 0 to 2, not 2.5"),
        (
            lambda: second.choice("mode", ("slow", "fast")),
            "[1].mode is 'slo', which is not known; did you mean 'slow'?",
        ),
        (lambda: first.choice("mode", ("a", "b")), "[0].mode must be one of a, b, not 'slow'"),
        (lambda: one.rows("rows", "at", "mode"), "[2].mod means nothing here; did you mean 'mode'"),
    ):
        assert refusal(do).startswith(f"my.toml: moods.rows{says}")


@dataclass(frozen=True)
class Inner:
    side: Literal["left", "right"] = "left"
    size: tuple[int, int] | None = None


@dataclass(frozen=True)
class Outer:
    name: str
    share: float = 0.5
    loud: bool = False
    words: tuple[str, ...] = ()
    inner: Inner = Inner()
    many: tuple[Inner, ...] = ()

    def __post_init__(self) -> None:
        if self.share > 1:
            raise ValueError(f"share {self.share:g}: give 0 to 1")


def test_a_dataclass_is_filled_by_its_types():
    one = table(name="n", share=1, inner={"side": "right"}, many=[{"size": [1, 2]}, {}])
    assert one.fill(Outer) == Outer(
        "n", 1.0, inner=Inner("right"), many=(Inner(size=(1, 2)), Inner())
    )


@pytest.mark.parametrize(
    ("values", "says"),
    [
        ({}, "moods.name is missing; it must be a text"),
        ({"name": "n", "shre": 1}, "moods.shre means nothing here; did you mean 'share'?"),
        ({"name": "n", "share": "1"}, "moods.share must be a number, not '1'"),
        ({"name": "n", "share": 2}, "moods: share 2: give 0 to 1"),
        ({"name": "n", "words": [1]}, "moods.words must be a text, not 1"),
        ({"name": "n", "inner": {"side": "up"}}, "moods.inner.side must be one of left, right"),
        ({"name": "n", "many": [{"size": [1]}]}, "moods.many[0].size must be a list of 2"),
        ({"name": "n", "many": [{"size": [1, 2.0]}]}, "size must be a whole number, not 2.0"),
    ],
)
def test_a_dataclass_of_wrong_values_is_refused_with_file_and_key(values, says):
    line = refusal(table(**values).fill, Outer)
    assert line.startswith("my.toml: moods")
    assert says in line
