"""The intentions of others' FML: Greta's types and references, by their words."""

from dataclasses import replace

from cubeling.characters.behaviour.bml.document import Behaviour
from cubeling.characters.behaviour.fml.lexicon import Lexicon
from cubeling.characters.behaviour.gesticon import Gesticon, words_of

KINDS = {
    "turntaking": "turn",
    "turnallocation": "turn",
    "affect": "emotion",
    "backchannel": "performative",
    "belief-relation": "relation",
    "rhetorical": "relation",
}
"""Our names of the intentions of others."""

STRENGTHS = {"strong": 1.0, "big": 1.0, "high": 1.0, "medium": 0.6, "small": 0.3, "weak": 0.3}
"""How strong an intention is by a word of its type."""


def in_lexicon(intention: Behaviour, lexicon: Lexicon) -> Behaviour | None:
    """Return an intention as the lexicon calls it; None if it has none of its words."""
    kind = KINDS.get(intention.kind.lower(), intention.kind)
    given = dict(intention.attributes)
    named, about = given.get("type", ""), given.get("ref_type", "")
    words = [*words_of(named), *words_of(given.get("ref_id", "")), *words_of(about)]
    for word in (named.lower(), *words):
        if (kind, word) in lexicon:
            strong = next((STRENGTHS[each] for each in words if each in STRENGTHS), None)
            if strong is not None and word not in STRENGTHS:
                given.setdefault("intensity", f"{strong:g}")
            given["type"] = word
            if given.get("ref_id"):
                given.setdefault("target", given["ref_id"])
            return replace(intention, kind=kind, attributes=given)
    return None


def by_gesticon(intention: Behaviour) -> Behaviour | None:
    """Return the gesture to which the words of an intention lead; None if there is none.

    >>> by_gesticon(Behaviour("d1", "deictic", attributes={"type": "you"})).get("lexeme")
    'POINT_YOU'
    """
    given = intention.attributes
    words = f"{intention.kind} {given.get('type', '')} {given.get('ref_id', '')}"
    meaning = Gesticon.bundled().nearest(words)
    if meaning is None:
        return None
    start = {key: at for key, at in intention.syncs.items() if key == "start"}
    syncs = dict(intention.syncs) if meaning.kind in ("face", "posture") else start
    return replace(intention, kind="gesture", attributes={"lexeme": meaning.name}, syncs=syncs)
