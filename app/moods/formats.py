"""A drawing as a file: .svg and .pdf hold its lines, .png its pixels."""

from collections.abc import Callable
from datetime import UTC, datetime
from io import BytesIO
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
from fpdf import FPDF
from PIL import Image, ImageDraw, ImageFont

from app.errors import AppError
from app.moods.drawing import Area, Array, Disc, Drawing, Line, Text

FONTS = "Inter, 'Segoe UI', 'DejaVu Sans', Helvetica, Arial, sans-serif"

DENSITY = 2
"""Pixels of a .png a point."""

FINER = 2
"""A .png is drawn so many times larger and then made smaller, for smooth edges."""


def save(drawing: Drawing, path: Path) -> None:
    """Write a drawing as its suffix says.

    Raises
    ------
    AppError
        The suffix is none of `FORMATS`, or the file cannot be written.
    """
    checked(path)
    content = FORMATS[path.suffix.lower()](drawing)
    try:
        path.write_bytes(content)
    except OSError as error:
        raise AppError(f"cannot write '{path}' ({error.strerror}): check the folder") from None


def checked(path: Path) -> Path:
    """Return a path that a drawing can be written to, by its suffix."""
    if path.suffix.lower() not in FORMATS:
        raise AppError(f"moods are drawn as {', '.join(FORMATS)}, not as '{path}'")
    return path


def svg(drawing: Drawing) -> bytes:
    """Return a drawing as an SVG."""
    root = ElementTree.Element(
        "svg",
        {
            "xmlns": "http://www.w3.org/2000/svg",
            "viewBox": f"0 0 {drawing.width:g} {drawing.height:g}",
            "width": f"{drawing.width:g}",
            "height": f"{drawing.height:g}",
            "font-family": FONTS,
        },
    )
    ElementTree.SubElement(root, "title").text = drawing.title
    ElementTree.SubElement(root, "rect", width="100%", height="100%", fill="#ffffff")
    for shape in drawing.shapes:
        _svg_shape(root, shape)
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True))


def _svg_shape(root: ElementTree.Element, shape: object) -> None:
    match shape:
        case Area():
            ElementTree.SubElement(root, "path", d=f"M{_places(shape.points)}z", fill=shape.fill)
        case Line():
            style = {"stroke-width": f"{shape.width:g}", "stroke-linejoin": "round"}
            if shape.dashes:
                style["stroke-dasharray"] = " ".join(f"{dash:g}" for dash in shape.dashes)
            way = f"M{_places(shape.points)}"
            ElementTree.SubElement(
                root, "path", {"d": way, "fill": "none", "stroke": shape.colour, **style}
            )
        case Disc():
            place = {"cx": _short(shape.x), "cy": _short(shape.y), "r": _short(shape.radius)}
            style = {"fill": shape.fill, "stroke": shape.outline}
            ElementTree.SubElement(root, "circle", {**place, **style})
        case Text():
            anchor = {0.0: "start", 0.5: "middle", 1.0: "end"}[shape.align]
            style = {
                "x": _short(shape.x),
                "y": _short(shape.y),
                "fill": shape.colour,
                "font-size": f"{shape.size:g}",
                "text-anchor": anchor,
            }
            if shape.bold:
                style["font-weight"] = "600"
            if shape.upright:
                style["transform"] = f"rotate(-90 {_short(shape.x)} {_short(shape.y)})"
            ElementTree.SubElement(root, "text", style).text = shape.words


def _places(points: Array) -> str:
    return " ".join(f"{_short(x)} {_short(y)}" for x, y in points)


def _short(value: float) -> str:
    return f"{value:.2f}".rstrip("0").rstrip(".")


def pdf(drawing: Drawing) -> bytes:
    """Return a drawing as one page of a PDF; letters outside Latin-1 become "?"."""
    page = FPDF(unit="pt", format=(drawing.width, drawing.height))
    page.set_creation_date(datetime(2026, 1, 1, tzinfo=UTC))  # the same session, the same bytes
    page.set_title(drawing.title)
    page.set_creator("cubeling")
    page.set_auto_page_break(False)
    page.add_page()
    for shape in drawing.shapes:
        _pdf_shape(page, shape)
    return bytes(page.output())


def _pdf_shape(page: FPDF, shape: object) -> None:
    match shape:
        case Area():
            page.set_fill_color(shape.fill)
            page.polygon([(float(x), float(y)) for x, y in shape.points], style="F")
        case Line():
            page.set_draw_color(shape.colour)
            page.set_line_width(shape.width)
            page.set_dash_pattern(*shape.dashes[:2])
            page.polyline([(float(x), float(y)) for x, y in shape.points])
            page.set_dash_pattern()
        case Disc():
            page.set_fill_color(shape.fill)
            page.set_draw_color(shape.outline)
            page.set_line_width(1.0)
            page.circle(shape.x, shape.y, shape.radius, style="DF")
        case Text():
            words = shape.words.replace("−", "-").encode("latin-1", "replace").decode("latin-1")
            page.set_font("Helvetica", "B" if shape.bold else "", shape.size)
            page.set_text_color(shape.colour)
            back = shape.align * page.get_string_width(words)
            with page.rotation(90 if shape.upright else 0, shape.x, shape.y):
                page.text(shape.x - back, shape.y, words)


def png(drawing: Drawing) -> bytes:
    """Return a drawing as pixels."""
    scale = DENSITY * FINER
    size = (round(drawing.width * scale), round(drawing.height * scale))
    image = Image.new("RGB", size, "#ffffff")
    pen = ImageDraw.Draw(image)
    for shape in drawing.shapes:
        _png_shape(image, pen, shape, scale)
    small = image.resize((size[0] // FINER, size[1] // FINER), Image.Resampling.LANCZOS)
    file = BytesIO()
    small.save(file, "PNG")
    return file.getvalue()


def _png_shape(image: Image.Image, pen: ImageDraw.ImageDraw, shape: object, scale: int) -> None:
    match shape:
        case Area():
            pen.polygon([(x, y) for x, y in (shape.points * scale).tolist()], shape.fill)
        case Line():
            width = max(1, round(shape.width * scale))
            for piece in dashed(shape.points, shape.dashes):
                way = [(x, y) for x, y in (piece * scale).tolist()]
                pen.line(way, shape.colour, width, joint="curve")
        case Disc():
            x, y, radius = shape.x * scale, shape.y * scale, shape.radius * scale
            box = (x - radius, y - radius, x + radius, y + radius)
            pen.ellipse(box, shape.fill, shape.outline, scale)
        case Text():
            _png_text(image, pen, shape, scale)


def _png_text(image: Image.Image, pen: ImageDraw.ImageDraw, shape: Text, scale: int) -> None:
    font = ImageFont.load_default(shape.size * scale)
    thick = shape.size * scale / 55 if shape.bold else 0
    x, y = shape.x * scale, shape.y * scale
    words = shape.words.replace("−", "-")  # Pillow's own font has no minus sign
    if not shape.upright:
        anchor = {0.0: "ls", 0.5: "ms", 1.0: "rs"}[shape.align]
        pen.text((x, y), words, shape.colour, font, anchor, stroke_width=thick)
        return
    length, height = round(font.getlength(words)), round(1.4 * shape.size * scale)
    mask = Image.new("L", (length, height))
    ImageDraw.Draw(mask).text((0, height / 1.4), words, 255, font, "ls", stroke_width=thick)
    mask = mask.rotate(90, expand=True)
    corner = (round(x - height / 1.4), round(y - (1 - shape.align) * length))
    image.paste(shape.colour, (*corner, corner[0] + mask.width, corner[1] + mask.height), mask)


def dashed(points: Array, dashes: tuple[float, ...]) -> list[Array]:
    """Return the dashes of a line; the whole line where it is solid."""
    if not dashes:
        return [points]
    lengths = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    pieces, period = [], dashes[0] + dashes[1]
    for start in np.arange(0.0, lengths[-1], period):
        end = min(start + dashes[0], lengths[-1])
        inside = lengths[(lengths > start) & (lengths < end)]
        at = np.concatenate([[start], inside, [end]])
        pieces.append(np.stack([np.interp(at, lengths, axis) for axis in points.T], axis=1))
    return pieces


FORMATS: dict[str, Callable[[Drawing], bytes]] = {".svg": svg, ".pdf": pdf, ".png": png}
"""What writes each kind of file."""
