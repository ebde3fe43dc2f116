"""Table 5.2 of Egges 2006: which of Ekman's six faces shows each of 24 emotions."""

from cubeling.affect import OCC_FACES
from cubeling.app.workshop.pages.report_table import ReportTable
from cubeling.app.workshop.reproduction.result import Reproduction, ReproductionRequest

PRINTED_FACES = {
    "happy": (
        "happy-for",
        "gloating",
        "joy",
        "pride",
        "admiration",
        "love",
        "hope",
        "satisfaction",
        "relief",
        "gratification",
        "gratitude",
    ),
    "sad": ("resentment", "pity", "distress", "shame", "remorse", "disappointment"),
    "angry": ("anger", "reproach", "hate"),
    "surprised": ("surprise",),
    "afraid": ("fear", "fear-confirmed"),
    "disgusted": ("disgust",),
}
"""The emotions of each face, as printed."""


def reproduce(request: ReproductionRequest) -> Reproduction:
    """Return the table beside the faces that characters show."""
    rows = []
    for face, emotions in PRINTED_FACES.items():
        ours = [word for word, shown in OCC_FACES.items() if shown == face]
        rows.append((face, ", ".join(sorted(emotions)), ", ".join(sorted(ours))))
    same = all(printed == ours for _, printed, ours in rows)
    return Reproduction(
        (ReportTable("Emotions of each face", ("face", "printed", "ours"), tuple(rows)),),
        "the table of words in cubeling.affect",
        "nothing." if same else "Our table has other faces for some emotions.",
    )
