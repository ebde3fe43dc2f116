"""Colours of code, for light and dark screens."""

from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.lexers import get_lexer_by_name, get_lexer_for_filename
from pygments.util import ClassNotFound

LIGHT, DARK = "friendly", "github-dark"
"""Styles of Pygments."""

_FORMATTER = HtmlFormatter(nowrap=True)


def colour_code(code: str, language: str = "", file: str = "") -> str | None:
    """Return code as HTML with a class for each token; None for a language that is not known."""
    try:
        lexer = get_lexer_for_filename(file) if file else get_lexer_by_name(language)
    except ClassNotFound:
        return None
    return str(highlight(code, lexer, _FORMATTER))


def code_colours(selector: str) -> str:
    """Return the style sheet of what `colour_code` returns, inside a selector."""
    light, dark = (_token_colours(style, selector) for style in (LIGHT, DARK))
    return f"{light}\n@media (prefers-color-scheme: dark) {{\n{dark}\n}}\n"


def _token_colours(style: str, selector: str) -> str:
    """Return the rules for tokens; the background is the page's."""
    rules = HtmlFormatter(style=style).get_style_defs(selector).splitlines()
    return "\n".join(rule for rule in rules if rule.startswith(f"{selector} ."))
