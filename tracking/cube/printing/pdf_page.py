"""A PDF page with filled outlines, lines and text, in millimetres from the top left."""

from collections.abc import Iterable, Sequence
from datetime import UTC, datetime

import numpy as np
from numpy.typing import ArrayLike

Colour = tuple[int, int, int]


class PdfPage:
    """One page of a PDF with vector graphics.

    The same calls give the same bytes on every machine: a fixed date, and no compression.
    """

    def __init__(self, width: float, height: float, title: str) -> None:
        # Imported late: the PDF library slows the start of every command that prints nothing.
        from fpdf import FPDF, ViewerPreferences

        self._pdf = FPDF(unit="mm", format=(width, height))
        self._pdf.set_compression(False)
        self._pdf.set_creation_date(datetime(2026, 1, 1, tzinfo=UTC))
        self._pdf.set_title(title)
        self._pdf.set_creator("cubeling")
        # Print dialogues then suggest "actual size".
        self._pdf.viewer_preferences = ViewerPreferences(print_scaling="None")
        self._pdf.set_auto_page_break(False)
        self._pdf.add_page()

    def fill(self, loops: Iterable[ArrayLike], colour: Colour) -> None:
        """Fill loops as one path by the nonzero rule."""
        self._path(loops, fill=colour)

    def stroke(
        self, points: ArrayLike, width: float, colour: Colour, *, closed: bool = False
    ) -> None:
        """Draw a solid line through points, with round corners and ends."""
        self._path([points], stroke=colour, width=width, closed=closed)

    def dashes(self, start: ArrayLike, end: ArrayLike, width: float, colour: Colour) -> None:
        """Draw a dashed line that begins and ends with half a dash, so corners are marked."""
        one, other = np.asarray(start, float), np.asarray(end, float)
        length = float(np.linalg.norm(other - one))
        count = max(2, round(length / 3.2))
        marks = (np.arange(count + 1)[:, None] + np.array([-0.3, 0.3])) / count
        for a, b in np.clip(marks, 0, 1):
            self.stroke([one + a * (other - one), one + b * (other - one)], width, colour)

    def text(
        self,
        words: str,
        x: float,
        y: float,
        size: float,
        colour: Colour,
        *,
        bold: bool = False,
        align: float = 0.0,
        turn: float = 0.0,
    ) -> None:
        """Write a line in a font of a height [mm].

        (x, y) is on the baseline, at the share `align` of the length of the line, and the line is
        turned by `turn` degrees counter-clockwise about it. Characters outside Latin-1 become "?":
        the built-in fonts of PDF have no others.
        """
        self._font(size, bold)
        self._pdf.set_text_color(*colour)
        words = _latin_1(words)
        start = x - align * self._pdf.get_string_width(words)
        with self._pdf.rotation(turn, x, y):
            self._pdf.text(start, y, words)

    def text_width(self, words: str, size: float, *, bold: bool = False) -> float:
        """Length of a line [mm]."""
        self._font(size, bold)
        return float(self._pdf.get_string_width(_latin_1(words)))

    def lines(self, words: str, width: float, size: float) -> list[str]:
        """Break words into lines no longer than `width`; a single longer word stays whole."""
        lines: list[str] = []
        for word in words.split():
            longer = f"{lines[-1]} {word}" if lines else word
            if lines and self.text_width(longer, size) <= width:
                lines[-1] = longer
            else:
                lines.append(word)
        return lines

    def to_bytes(self) -> bytes:
        """Return the PDF file."""
        return bytes(self._pdf.output())

    def _font(self, size: float, bold: bool) -> None:
        self._pdf.set_font("Helvetica", "B" if bold else "", size * 72 / 25.4)

    def _path(
        self,
        loops: Iterable[ArrayLike],
        fill: Colour | None = None,
        stroke: Colour | None = None,
        width: float = 0.0,
        closed: bool = True,
    ) -> None:
        from fpdf.enums import PathPaintRule

        with self._pdf.new_path() as path:
            path.style.fill_color = None if fill is None else _hex(fill)
            path.style.stroke_color = None if stroke is None else _hex(stroke)
            path.style.stroke_width = width
            path.style.stroke_cap_style = "round"
            path.style.stroke_join_style = "round"
            path.style.paint_rule = PathPaintRule.FILL_NONZERO if fill else PathPaintRule.STROKE
            for loop in loops:
                points: Sequence[Sequence[float]] = np.asarray(loop, float).tolist()
                path.move_to(*points[0])
                for point in points[1:]:
                    path.line_to(*point)
                if closed:
                    path.close()


def _hex(colour: Colour) -> str:
    return "#" + "".join(f"{channel:02x}" for channel in colour)


def _latin_1(words: str) -> str:
    return words.encode("latin-1", "replace").decode("latin-1")
