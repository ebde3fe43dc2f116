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

from cubeling.app.errors import AppError
from cubeling.app.workshop.moods.colors import CURVE_STYLES
from cubeling.app.workshop.moods.plot import FILE_METADATA
from cubeling.app.workshop.moods.plot_layout import MATPLOTLIB_STYLE
from cubeling.app.workshop.motion_graphs.plot import plain_log_axis
from cubeling.app.workshop.motion_graphs.tables import Tables
from cubeling.files import whole_file, write_whole

TITLES = {
    "3.2": "Table 3.2: time between frames and response, by threshold [frames]",
    "3.3": "Table 3.3: from clip to clip [frames]",
    "3.4": "Table 3.4: the best split profile from clip to clip",
}

NOTES = """Thresholds depend on the clips and on the convention of angles, so ours are the printed
multiples of the threshold that first joins all clips. Durations and responses are those of the
transition of least cost, also in table 3.3, where the thesis takes the shortest of all targets."""

STYLE = """body { font: 15px/1.5 sans-serif; color: #2b3345; max-width: 64em; margin: 2em auto; }
table { border-collapse: collapse; } td, th { padding: .2em .8em; text-align: right; }
th { text-align: left; } tr { border-bottom: 1px solid #dcdfe6; } .printed { color: #6d7385; }"""


def write_page(tables: Tables, path: Path) -> Path:
    """Write an .html page and a .csv file of its name; return the path of the latter."""
    clips = "".join(f"<li>C{n}: {escape(name)}</li>" for n, name in enumerate(tables.clips, 1))
    critical = ", ".join(f"{name} {value:.3f}" for name, value in tables.critical.items())
    body = [f"<h1>Motion graphs of four clips</h1><ul>{clips}</ul><p>{NOTES}</p>"]
    body.append(f"<p>Least thresholds that join all clips: {critical}.</p>")
    body += [f"<h2>{title}</h2>{_table(tables, name)}" for name, title in TITLES.items()]
    picture = base64.b64encode(_curves(tables)).decode()
    body.append("<h2>Connectivity and cost of a transition</h2>")
    body.append(f'<img alt="curves" width="1000" src="data:image/png;base64,{picture}">')
    page = f"<!doctype html><meta charset=utf-8><title>Motion graphs</title><style>{STYLE}</style>"
    write_whole(path, page + "\n".join(body), AppError)
    table = path.with_suffix(".csv")
    with (
        whole_file(table, AppError) as partial,
        partial.open("w", newline="", encoding="utf-8") as file,
    ):
        writer = csv.writer(file)
        writer.writerow(("table", "row", "column", "printed", "ours"))
        writer.writerows(tables.rows)
    return table


def _table(tables: Tables, name: str) -> str:
    """Return a table as HTML: ours, and the printed value beside it."""
    own = [row for row in tables.rows if row[0] == name]
    columns = list(dict.fromkeys(row[2] for row in own))
    lines = [
        "<tr><th></th>" + "".join(f"<th>{escape(column)}</th>" for column in columns) + "</tr>"
    ]
    for label in dict.fromkeys(row[1] for row in own):
        cells = {row[2]: row for row in own if row[1] == label}
        line = f"<tr><th>{escape(label)}</th>"
        for column in columns:
            found = cells.get(column)
            values = "" if found is None else f"{found[4]} <span class=printed>({found[3]})</span>"
            line += f"<td>{values}</td>"
        lines.append(line + "</tr>")
    return f"<table>{''.join(lines)}</table><p class=printed>In brackets: as printed.</p>"


def _curves(tables: Tables) -> bytes:
    """Return the plot of both curves as a PNG."""
    with matplotlib.rc_context(MATPLOTLIB_STYLE):
        figure = Figure(figsize=(13.0, 4.6), layout="constrained")
        left, right = figure.subplots(1, 2)
        for axes, curves, label in (
            (left, tables.connectivity, "share of frames connected"),
            (right, tables.cost, "mean cost of a transition"),
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
