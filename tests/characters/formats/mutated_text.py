"""Random changes of the words of a text, for tests that readers refuse what they cannot read."""

from hypothesis import strategies as st

ODD_WORDS = ["", "nan", "1e9", "-1e9", "1e-300", "9" * 20, "\n", "é"]


def mutated(data, text, odd_words):
    """Return a text with one to four words dropped, doubled, swapped, replaced or cut off."""
    words = text.replace("\n", " \n ").split(" ")
    for _ in range(data.draw(st.integers(1, 4))):
        at, other = (data.draw(st.integers(0, len(words) - 1)) for _ in range(2))
        change = data.draw(st.sampled_from(["drop", "double", "swap", "odd", "cut"]))
        if change == "drop" and len(words) > 1:
            del words[at]
        elif change == "double":
            words.insert(at, words[at])
        elif change == "swap":
            words[at], words[other] = words[other], words[at]
        elif change == "odd":
            words[at] = data.draw(st.sampled_from(ODD_WORDS + odd_words))
        elif len(words) > 1:
            del words[max(at, 1) :]
    return " ".join(words)
