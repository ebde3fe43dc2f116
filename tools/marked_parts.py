"""Generated parts of documents, between marks like `<!-- topics: generated from the code -->`."""


def replace_part(document: str, name: str, content: str) -> str:
    r"""Return a document with new content between the marks of a part.

    >>> replace_part("<!-- a: generated from the code -->\n1\n<!-- end of a -->", "a", "2")
    '<!-- a: generated from the code -->\n2\n<!-- end of a -->'

    Raises
    ------
    ValueError
        If the document does not have exactly one part of this name.
    """
    head, _, rest = _split(document, name)
    return head + content + rest


def part_of(document: str, name: str) -> str:
    """Return the content between the marks of a part; ValueError as in `replace_part`."""
    return _split(document, name)[1]


def _split(document: str, name: str) -> tuple[str, str, str]:
    """Return what stands up to the first mark, between the marks, and from the last one on."""
    begin, end = f"<!-- {name}: generated from the code -->\n", f"\n<!-- end of {name} -->"
    if document.count(begin) != 1 or document.count(end) != 1:
        raise ValueError(f"the document must have one part marked {name!r}")
    head, _, rest = document.partition(begin)
    content, _, tail = rest.partition(end)
    return head + begin, content, end + tail
