"""Tagged text: gestures that begin and end with words."""

import pytest
from hypothesis import given, strategies as st

from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.speech import Word
from cubeling.characters.speech.tagged_text import MIN_SPAN_S, TaggedSpan, TaggedText


def begin(key: str, name: str) -> str:
    return f'<begin_gesture id="{key}" anim="{name}"/>'


def end(key: str) -> str:
    return f'<end_gesture id="{key}"/>'


def test_crossing_spans_are_read_and_the_text_is_left_as_it_was():
    marked = f"{begin('1', 'shake')}I have {begin('2', 'shrug')}no{end('1')}\n idea{end('2')} < 3."
    found = TaggedText.read(marked)
    assert found.text == "I have no\n idea < 3."
    assert found.spans == (TaggedSpan("shake", 0, 9), TaggedSpan("shrug", 7, 15))


@given(
    st.lists(st.text(st.characters(exclude_characters="<>"), max_size=8), min_size=2, max_size=8),
    st.data(),
)
def test_tags_anywhere_leave_the_text_and_name_its_parts(parts, data):
    first = data.draw(st.integers(0, len(parts) - 1))
    last = data.draw(st.integers(first, len(parts) - 1))
    marked = [*parts]
    marked[last] = marked[last] + end("g")
    marked[first] = begin("g", "wave") + marked[first]
    found = TaggedText.read("".join(marked))
    assert found.text == "".join(parts)
    ((span),) = found.spans
    assert found.text[span.start : span.end] == "".join(parts[first : last + 1])


@pytest.mark.parametrize(
    ("marked", "problem"),
    [
        (begin("g", "wave") + "Hello", "never ends"),
        ("Hello" + end("g"), "no gesture 'g' has begun"),
        (begin("g", "wave") + begin("g", "nod") + end("g"), "has begun"),
        ('<begin_gesture id="g"/>Hello' + end("g"), "has no anim"),
        ('<begin_gesture anim="wave"/>Hello', "has no id"),
    ],
)
def test_tags_that_do_not_fit_together_are_one_line(marked, problem):
    with pytest.raises(CharacterError, match=problem) as error:
        TaggedText.read(marked)
    assert "\n" not in str(error.value)


WORDS = (Word("Hello", 0.1, 0.5, 0), Word("there", 0.6, 1.2, 6), Word("you", 1.3, 2.0, 12))


def test_a_gesture_lasts_from_its_first_word_to_its_last():
    found = TaggedText.read(f"Hello {begin('g', 'wave')}there you{end('g')}")
    ((span),) = found.gesture_spans(WORDS, 2.1)
    assert (span.name, span.start, span.end) == ("wave", 0.6, 2.0)


@pytest.mark.parametrize(
    "marked",
    [
        f"Hello there you{begin('g', 'nod')}{end('g')}",
        f"{begin('g', 'nod')}{end('g')}Hello there you",
        f"{begin('g', 'nod')}Hello{end('g')} there you",
    ],
)
def test_a_gesture_of_a_short_word_or_none_has_time_enough(marked):
    ((span),) = TaggedText.read(marked).gesture_spans(WORDS, 2.1)
    assert span.end - span.start >= MIN_SPAN_S - 1e-9
    assert 0.0 <= span.start <= 2.1 - MIN_SPAN_S + 1e-9
