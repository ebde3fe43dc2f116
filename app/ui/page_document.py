"""A page as one document: its styles and scripts in it, and a policy that lets nothing else run."""

import base64
import hashlib
import re
from collections.abc import Iterable
from importlib.resources.abc import Traversable

FOR_PEOPLE = re.compile(r"^\s+|^(//.*|/\*.*\*/)\n", re.MULTILINE)
"""What a browser does not need: indents, and lines that are comments."""


def assembled(
    folder: Traversable, name: str, styles: Iterable[str], scripts: Iterable[str], *, loads: str
) -> tuple[str, str]:
    """Return a document made of files of a folder, and the content security policy to send with it.

    In the HTML file `name`, the styles go where it says /*STYLE*/, the scripts where /*SCRIPT*/.
    `loads` is the part of the policy that says which pictures and sounds it may load.
    """

    def joined(names: Iterable[str]) -> str:
        text = "".join((folder / each).read_text("utf-8") for each in names)
        return FOR_PEOPLE.sub("", text)

    style, script = joined(styles), joined(scripts)
    document = joined([name]).replace("/*STYLE*/", style).replace("/*SCRIPT*/", script)
    policy = (
        f"default-src 'none'; connect-src 'self'; {loads}; style-src {_hash(style)}; "
        f"script-src {_hash(script)}; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
    )
    return document, policy


def _hash(text: str) -> str:
    digest = hashlib.sha256(text.encode()).digest()
    return f"'sha256-{base64.b64encode(digest).decode()}'"
