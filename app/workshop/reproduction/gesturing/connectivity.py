"""Table 4.2 of Fernández-Baena 2015: how well a gesture graph is connected, by threshold."""

import numpy as np

from cubeling.app.workshop.pages.report_table import ReportTable
from cubeling.app.workshop.reproduction.gesturing.spoken import LIBRARY, bundled_library
from cubeling.app.workshop.reproduction.result import Reproduction, ReproductionRequest
from cubeling.characters.motion import sweep

PRINTED_ROWS = {
    0.3: (0.92, 18, 1.22),
    0.4: (1.40, 74, 1.68),
    0.5: (2.71, 160, 2.88),
    0.6: (5.47, 226, 5.46),
    0.7: (9.71, 247, 9.87),
    0.8: (16.24, 252, 16.37),
    0.9: (25.09, 259, 25.27),
    1.0: (36.20, 261, 36.20),
}
"""By threshold: branching factor, size of the largest component, its branching factor."""

PRINTED_PHRASES = 261
"""Gesture phrases of the thesis's library."""


_FINE_THRESHOLDS = tuple(np.geomspace(1e-3, 10.0, 241).tolist())
"""Among which the least is looked for that joins all phrases."""


def reproduce(request: ReproductionRequest) -> Reproduction:
    """Return the table of the bundled library beside the printed one."""
    library = bundled_library()
    count = len(library.phrases)
    joined = next(
        (row.threshold for row in sweep(library, _FINE_THRESHOLDS) if row.component == count), 1.0
    )
    rows = []
    for printed, found in zip(
        PRINTED_ROWS, sweep(library, [joined * each for each in PRINTED_ROWS]), strict=True
    ):
        branching, size, within = PRINTED_ROWS[printed]
        rows.append(
            (
                f"{printed:g}",
                f"{branching / PRINTED_PHRASES:.1%}",
                f"{found.branching / count:.1%}",
                f"{size / PRINTED_PHRASES:.0%}",
                f"{found.component / count:.0%}",
                f"{branching:.2f}",
                f"{found.branching:.2f}",
                f"{within:.2f}",
                f"{found.component_branching:.2f}",
            )
        )
    columns = (
        "threshold",
        *("printed share of all edges", "ours"),
        *("printed share in one component", "ours"),
        *("printed edges per node", "ours"),
        *("printed edges per node in it", "ours"),
    )
    caption = f"{PRINTED_PHRASES} phrases (printed) and {count} (ours)"
    return Reproduction(
        (ReportTable(caption, columns, tuple(rows)),),
        f"the bundled library '{LIBRARY}': {count} phrases by our own generator",
        "Thresholds depend on the library and on the convention of angles: ours are the printed "
        f"multiples of the least that joins all phrases, {joined:.2g} (printed: 1). With {count} "
        f"phrases instead of {PRINTED_PHRASES} a node has fewer edges, but as large a share.",
    )
