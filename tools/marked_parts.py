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
    begin, end = f"<!-- {name}: generated from the code -->\n", f"\n<!-- end of {name} -->"
    if document.count(begin) != 1 or document.count(end) != 1:
        raise ValueError(f"the document must have one part marked {name!r}")
    head, _, rest = document.partition(begin)
    return head + begin + content + end + rest.partition(end)[2]
