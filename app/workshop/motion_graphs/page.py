"""The tables and curves of chapter 3.5 as a page, and as CSV.

Needs matplotlib, the extra `[plots]`; only `cubeling motions tables` imports this module.
"""

import base64
import csv
import io
from html import escape
from pathlib import Path

import matplotlib
from matplotlib.figure import Figure

from cubeling.app.counted import quantity
from cubeling.app.errors import AppError
from cubeling.app.workshop.moods.colors import CURVE_STYLES
from cubeling.app.workshop.moods.plot import FILE_METADATA
from cubeling.app.workshop.moods.plot_layout import MATPLOTLIB_STYLE
from cubeling.app.workshop.motion_graphs.plot import plain_log_axis
from cubeling.app.workshop.motion_graphs.summary import (
    TITLES,
    Estimate,
    TablesSummary,
    printed_value,
)
from cubeling.app.workshop.motion_graphs.tables import Measurement
from cubeling.files import whole_file, write_whole

NOTES = """Thresholds depend on the clips and on the convention of angles, so ours are the printed
multiples of the threshold that first joins all clips. "As printed" searches as the thesis does: a
jump joins the look-alikes themselves, no part leaves or arrives before the legs, only the cheapest
path between two frames is looked at, and table 3.3 has the shortest duration over all frames of the
target (eq. 3.4). "Ours" has windows on both sides, paths whose lengths fit, and the cheapest
transition. "No answer" is the share of requests for which the parts found no way in the windows;
table 3.3 compares the others."""

COLORS = {0: "#ffffff", 1: "#ffffff", 2: "#f6d5c3", 3: "#f5ecbe", 4: "#cfe8d5"}
"""Colour of a cell of table 3.2 by the number of clips that are joined."""

STYLE = """body { font: 15px/1.5 sans-serif; color: #2b3345; max-width: 84em; margin: 2em auto; }
table { border-collapse: collapse; } td, th { padding: .2em .6em; text-align: right; }
th { text-align: left; } tr { border-bottom: 1px solid #dcdfe6; } .printed { color: #6d7385; }
thead th { vertical-align: bottom; font-weight: 600; } small { display: block; color: #6d7385; }
td.printed { border-left: 1px solid #dcdfe6; } .wide { overflow-x: auto; }
""" + "\n".join(f".joined{count} {{ background: {color}; }}" for count, color in COLORS.items())


def write_page(summary: TablesSummary, path: Path) -> Path:
    """Write an .html page and a .csv file of its name; return the path of the latter."""
    first = summary.choices[0]
    body = [f"<h1>Motion graphs of {quantity(len(summary.choices), 'choice')} of four clips</h1>"]
    body.append("".join(_clips(choice) for choice in summary.choices))
    body.append(f"<p>{NOTES}</p>")
    if len(summary.choices) > 1:
        body.append(
            "<p>Means over the choices; below, 95 % of the mean by the bootstrap, or how many "
            "choices agree. Curves are those of the first choice.</p>"
        )
    body += [f"<h2>{title}</h2>{_table(summary, name)}" for name, title in TITLES.items()]
    body += [f"<p>{escape(summary.order(way).capitalize())}.</p>" for way in summary.ways]
    if first.connectivity:
        picture = base64.b64encode(_curves(first)).decode()
        body.append("<h2>Connectivity and cost of a transition</h2>")
        body.append(f'<img alt="curves" width="1000" src="data:image/png;base64,{picture}">')
    page = f"<!doctype html><meta charset=utf-8><title>Motion graphs</title><style>{STYLE}</style>"
    write_whole(path, page + "\n".join(body), AppError)
    return _write_csv(summary, path.with_suffix(".csv"))


def _clips(choice: Measurement) -> str:
    names = ", ".join(f"C{n} {escape(name)}" for n, name in enumerate(choice.clips, 1))
    critical = ", ".join(f"{name} {value:.3f}" for name, value in choice.critical.items())
    return f"<p>{names}.<small>Least thresholds that join all clips: {critical}.</small></p>"


def _table(summary: TablesSummary, name: str) -> str:
    """Return a table as HTML: in each column the printed value, then that of each way."""
    keys = [key for key in summary.cells if key[0] == name]
    columns = list(dict.fromkeys(column for _, _, column in keys))
    rows = list(dict.fromkeys(row for _, row, _ in keys))
    ways = summary.ways
    head = "".join(f"<th colspan={1 + len(ways)}>{escape(column)}</th>" for column in columns)
    below = "<th class=printed>thesis</th>" + "".join(f"<th>{escape(way)}</th>" for way in ways)
    lines = [f"<thead><tr><th></th>{head}</tr><tr><th></th>{below * len(columns)}</tr></thead>"]
    for row in sorted(rows) if name == "3.4" else rows:
        line = f"<tr><th>{escape(row)}</th>"
        for column in sorted(columns) if name == "3.4" else columns:
            key = name, row, column
            line += f"<td class=printed>{escape(printed_value(key))}</td>"
            line += "".join(_cell(summary.cells[key][way]) for way in ways)
        lines.append(line + "</tr>")
    legend = "".join(f" <span class=joined{n}>&nbsp;{n} clips&nbsp;</span>" for n in (2, 3, 4))
    note = f"<p>Joined:{legend}</p>" if name == "3.2" else ""
    return f"<div class=wide><table>{''.join(lines)}</table></div>{note}"


def _cell(estimate: Estimate) -> str:
    spread = f"<small>{escape(estimate.spread)}</small>" if estimate.spread else ""
    color = "" if estimate.joined is None else f" class=joined{estimate.joined}"
    return f"<td{color}>{escape(estimate.text)}{spread}</td>"


def _write_csv(summary: TablesSummary, path: Path) -> Path:
    """Write all values as CSV, and return the path."""
    ways = summary.ways
    heads = [f"{way}{end}" for way in ways for end in ("", " low", " high")]
    with (
        whole_file(path, AppError) as partial,
        partial.open("w", newline="", encoding="utf-8") as file,
    ):
        writer = csv.writer(file)
        writer.writerow(("table", "row", "column", "printed", *heads))
        for key, cells in summary.cells.items():
            values: list[str] = []
            for estimate in (cells[way] for way in ways):
                ends = (estimate.low, estimate.high)
                values += [estimate.text, *("" if end is None else f"{end:.2f}" for end in ends)]
            writer.writerow((*key, printed_value(key), *values))
        for name in ("connectivity", "cost"):
            for profile, curve in getattr(summary.choices[0], name).items():
                for threshold, value in zip(*curve, strict=True):
                    row = [""] * len(heads)
                    row[-3] = f"{value:.4f}"
                    writer.writerow((name, f"{threshold:.4f}", profile, "", *row))
    return path


def _curves(measured: Measurement) -> bytes:
    """Return the plot of both curves as a PNG."""
    with matplotlib.rc_context(MATPLOTLIB_STYLE):
        figure = Figure(figsize=(13.0, 4.6), layout="constrained")
        left, right = figure.subplots(1, 2)
        for axes, curves, label in (
            (left, measured.connectivity, "share of frames connected"),
            (right, measured.cost, "mean cost of a transition"),
        ):
            for number, (name, (thresholds, values)) in enumerate(curves.items()):
                color, dashes = CURVE_STYLES[number % len(CURVE_STYLES)]
                marker = "o" if number < len(CURVE_STYLES) else "s"
                style = {"color": color, "linestyle": (0, dashes or None), "marker": marker}
                axes.plot(thresholds, values, label=name, markersize=3.5, **style)
            plain_log_axis(axes)
            axes.set_xlabel("threshold")
            axes.set_ylabel(label)
            axes.grid(True, color="#dcdfe6", linewidth=0.7)
        left.legend()
        buffer = io.BytesIO()
        figure.savefig(buffer, format="png", dpi=110, metadata=FILE_METADATA[".png"])
    return buffer.getvalue()
