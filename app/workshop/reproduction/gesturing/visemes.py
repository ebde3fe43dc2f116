"""Table 4.5 of Fernández-Baena 2015: speech sounds that share a shape of the mouth."""

from cubeling.app.workshop.pages.report_table import ReportTable
from cubeling.app.workshop.reproduction.result import Reproduction, ReproductionRequest
from cubeling.characters.speech import viseme_sets

PRINTED_CLASSES = (
    "pau",
    "r",
    "k g ng",
    "ae ax ah aa",
    "f v",
    "ch sh jh",
    "ao y iy ih ay aw",
    "ow oy",
    "n d t l",
    "ey eh el em en er",
    "th dh",
    "s z zh",
    "b p m",
    "hh",
    "w uw uh",
)
"""The symbols of each class."""


def reproduce(request: ReproductionRequest) -> Reproduction:
    """Return the printed classes, our set of the same, and the set in use."""
    sets = viseme_sets()
    rows = []
    for printed, viseme in zip(PRINTED_CLASSES, sets["thesis"].visemes, strict=True):
        names = {
            phone: " ".join(each.viseme.name for each in sets["oculus"].of(phone))
            for phone in viseme.phones
        }
        used = ", ".join(dict.fromkeys(names.values())) or sets["oculus"].silence.name
        rows.append((printed, " ".join(viseme.phones) or "–", used))
    columns = ("printed", "ours: set 'thesis', in the IPA", "shapes of the set in use, 'oculus'")
    return Reproduction(
        (ReportTable(f"{len(rows)} classes", columns, tuple(rows)),),
        "the sets of visemes in cubeling.characters.speech",
        "The printed symbols are called MRPA but are like ARPAbet. Its class of ao to aw mixes "
        "rounded and spread vowels (erratum 12): the set 'thesis' keeps it, 'thesis-corrected' "
        "divides it, and the one in use has other classes, in which diphthongs are two shapes.",
    )
