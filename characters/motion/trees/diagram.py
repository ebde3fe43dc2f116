"""A plan as a picture: trees from left to right, states below each other with arrows between."""

from xml.etree import ElementTree

from characters.motion.trees.layout import HIGH, SMALL, Box, boxes_of, place
from characters.motion.trees.plan import Machine, Plan

_INK, _FAINT, _PAPER = "#26323c", "#8794a0", "#ffffff"
_FILLS = {
    "clip": "#eef1f4",
    "mix": "#d8efe4",
    "layer": "#e9def6",
    "change": "#dbe9fb",
    "state": "#fde7c8",
}
_LEGEND = {
    "state": "state",
    "mix": "mix of motions",
    "layer": "layer",
    "change": "changed motion",
    "clip": "clip",
}
_MARGIN = 28.0  # [px]


def draw(plan: Plan, title: str = "") -> str:
    """Return a plan as an SVG.

    A motion that is used twice is drawn whole where it comes first, and as a dashed box later.

    Parameters
    ----------
    plan
        What is drawn.
    title
        Above it.
    """
    machine, roots = plan.machine, boxes_of(plan)
    left = _MARGIN if machine is None else _MARGIN + _room_for_arrows(machine)
    bottom = place(roots, left, _MARGIN + (44 if title else 0))
    boxes = [box for root in roots for box in root.everyone()]
    width = max([box.x + box.width for box in boxes] + [_MARGIN + 620]) + _MARGIN
    svg = ElementTree.Element(
        "svg",
        {
            "xmlns": "http://www.w3.org/2000/svg",
            "viewBox": f"0 0 {width:.0f} {bottom + 52:.0f}",
            "width": f"{width:.0f}",
            "height": f"{bottom + 52:.0f}",
            "font-family": "Inter, 'Segoe UI', 'DejaVu Sans', Arial, sans-serif",
        },
    )
    _shape(svg, "rect", width="100%", height="100%", fill=_PAPER)
    if title:
        _text(svg, _MARGIN, _MARGIN + 16, title, 20, weight="600")
    links = [(box, child) for box in boxes for child in box.children]
    for box, child in links:
        _link(svg, box, child)
    for _, child in links:
        _text(svg, child.x - 6, child.y + HIGH / 2 - 5, child.label, 11.5, _INK, "end")
    if machine is not None:
        _arrows(svg, machine, dict(zip(machine.states, roots, strict=True)))
    for box in boxes:
        _draw_box(svg, box)
    _legend(svg, bottom + 26, machine is not None)
    return ElementTree.tostring(svg, encoding="unicode")


def _room_for_arrows(machine: Machine) -> float:
    longest = max((len(change.when.text) for change in machine.changes), default=0)
    return 40 + 22 * len(machine.changes) + min(SMALL * longest, 220)


def _arrows(svg: ElementTree.Element, machine: Machine, states: dict[str, Box]) -> None:
    """Draw the changes as brackets to the left of the states, each with its condition."""
    marker = _shape(
        _shape(svg, "defs"),
        "marker",
        id="tip",
        viewBox="0 0 8 8",
        refX="7",
        refY="4",
        markerWidth="8",
        markerHeight="8",
        orient="auto",
    )
    _shape(marker, "path", d="M0 0 8 4 0 8z", fill=_INK)
    ends, labels = dict.fromkeys(states, 0), []
    for number, change in enumerate(machine.changes):
        end = states[change.end]
        starts = [states[change.start]] if change.start in states else [end]
        away = states[change.end].x - 26 - 20 * number
        ends[change.end] += 1
        y_end = end.y + 8 + 9 * (ends[change.end] % 4)
        for start in starts:
            y = start.y + HIGH - 8 if start is not end else y_end + 18
            path = f"M{start.x:.0f} {y:.0f} H{away + 8:.0f} Q{away:.0f} {y:.0f} "
            bend = 8 if y_end > y else -8
            path += f"{away:.0f} {y + bend:.0f} V{y_end - bend:.0f} Q{away:.0f} {y_end:.0f} "
            path += f"{away + 8:.0f} {y_end:.0f} H{end.x - 1:.0f}"
            _shape(
                svg,
                "path",
                d=path,
                fill="none",
                stroke=_INK if change.start in states else _FAINT,
                **{"stroke-width": "1.4", "marker-end": "url(#tip)"},
            )
        middle = (starts[0].y + end.y + HIGH) / 2 - 14 + 14 * (number % 3)
        prefix = "" if change.start in states else "from any: "
        labels.append((away - 5, middle, prefix + change.when.text))
    for x, y, text in labels:
        _text(svg, x, y, text, 11.5, _INK, "end")


def _link(svg: ElementTree.Element, box: Box, child: Box) -> None:
    x, y = box.x + box.width, box.y + HIGH / 2
    x2, y2 = child.x, child.y + HIGH / 2
    bend = (x2 - x) * 0.45
    path = f"M{x:.0f} {y:.0f} C{x + bend:.0f} {y:.0f} {x2 - bend:.0f} {y2:.0f} {x2:.0f} {y2:.0f}"
    _shape(svg, "path", d=path, fill="none", stroke=_FAINT, **{"stroke-width": "1.4"})


def _draw_box(svg: ElementTree.Element, box: Box) -> None:
    style = {"stroke-dasharray": "4 3"} if box.seen else {}
    _shape(
        svg,
        "rect",
        x=f"{box.x:.0f}",
        y=f"{box.y:.0f}",
        width=f"{box.width:.0f}",
        height=f"{HIGH:.0f}",
        rx="10",
        fill=_FILLS[box.group],
        stroke=_INK,
        **{"stroke-width": "1.2", **style},
    )
    _text(svg, box.x + 12, box.y + 17, box.title, 14, weight="600")
    _text(svg, box.x + 12, box.y + 32, "as above" if box.seen else box.note, 11.5, "#4f5d69")


def _legend(svg: ElementTree.Element, y: float, states: bool) -> None:
    x = _MARGIN
    for key, text in _LEGEND.items():
        if key == "state" and not states:
            continue
        _shape(
            svg,
            "rect",
            x=f"{x:.0f}",
            y=f"{y - 10:.0f}",
            width="14",
            height="14",
            rx="4",
            fill=_FILLS[key],
            stroke=_INK,
        )
        _text(svg, x + 20, y + 2, text, 11.5, "#4f5d69")
        x += 40 + SMALL * len(text)


def _shape(parent: ElementTree.Element, tag: str, **attributes: str) -> ElementTree.Element:
    return ElementTree.SubElement(parent, tag, attributes)


def _text(
    svg: ElementTree.Element,
    x: float,
    y: float,
    text: str,
    size: float,
    fill: str = _INK,
    anchor: str = "start",
    weight: str = "400",
) -> None:
    element = _shape(
        svg,
        "text",
        x=f"{x:.0f}",
        y=f"{y:.0f}",
        fill=fill,
        stroke=_PAPER if anchor == "end" else "none",
        **{
            "font-size": f"{size:g}",
            "text-anchor": anchor,
            "font-weight": weight,
            # Labels lie on lines: a border in the paper's colour keeps them legible.
            "paint-order": "stroke",
            "stroke-width": "5",
            "stroke-linejoin": "round",
        },
    )
    element.text = text
