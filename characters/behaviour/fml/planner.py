"""From FML to BML: what is meant becomes what is done.

Source: the two levels of SAIBA (Kopp et al. 2006). FML has no standard; the elements are those of
FML-APML (Mancini and Pelachaud 2008): performative, emotion, certainty, emphasis, world …

    <fml id="f1">
      <speech id="s"><text>Hello! <sync id="a"/>Look at the <sync id="b"/>cube.</text></speech>
      <performative type="greet" start="s:start" end="s:a"/>
      <world type="object" target="cube" start="s:b"/>
      <emotion type="joy" intensity="0.7"/>
    </fml>

What is not an intention, speech above all, is BML and stays as it is. An element `fml-apml` with
`bml` and `fml` inside is read too.
"""

from dataclasses import replace
from functools import cache

from cubeling.characters.behaviour.bml import parser
from cubeling.characters.behaviour.bml.document import BML, SYNCS, Behaviour, Block, SyncReference
from cubeling.characters.behaviour.fml.dialects import by_gesticon, in_lexicon
from cubeling.characters.behaviour.fml.lexicon import Lexicon, Shown
from cubeling.characters.errors import CharacterError

FML = "urn:cubeling:fml"
"""Namespace of intentions that a lexicon does not have: realizers warn of them."""

ROOTS = ("fml", "fml-apml", "bml")
"""Elements that contain intentions and behaviours."""

STRENGTHS = ("intensity", "importance")
"""Attributes that say how strong an intention is, 0…1; without them it is 1."""


def behaviours_of(fml: str | bytes, lexicon: Lexicon | None = None) -> Block:
    """Return the block of behaviours that shows what an FML document means.

    Intentions that the lexicon does not have stay in the block as behaviours that nobody knows,
    so that its realizer sends the standard's warning.

    Raises
    ------
    CharacterError
        If the document cannot be read, or a number in it is none.
    """
    return shown_by(parser.parse_as(fml, ROOTS), lexicon)


def shown_by(block: Block, lexicon: Lexicon | None = None) -> Block:
    """Return a block with behaviours instead of the intentions that the lexicon has.

    In a block that was read as a dialect, a type that the lexicon lacks is looked for by its words.

    Raises
    ------
    CharacterError
        If an intention has a strength that is none.
    """
    lexicon = lexicon or _bundled_lexicon()
    speech = next((b for b in block.behaviours if b.kind == "speech"), None)
    behaviours = list[Behaviour]()
    for behaviour in block.behaviours:
        if behaviour.namespace != BML or behaviour.kind in SYNCS:
            behaviours.append(behaviour)
        elif (behaviour.kind, behaviour.get("type")) in lexicon:
            behaviours += _behaviours_of(behaviour, lexicon, speech)
        elif behaviour.yielding and (known := in_lexicon(behaviour, lexicon)) is not None:
            behaviours += _behaviours_of(known, lexicon, speech)
        elif behaviour.yielding and (named := by_gesticon(behaviour)) is not None:
            behaviours.append(named)
        else:
            behaviours.append(replace(behaviour, namespace=FML, syncs={}))
    if len(behaviours) > parser.MAX_BEHAVIOURS:
        raise CharacterError(
            f"FML: more than {parser.MAX_BEHAVIOURS} behaviours; send several documents"
        )
    return replace(block, behaviours=tuple(behaviours))


@cache
def _bundled_lexicon() -> Lexicon:
    return Lexicon.load()


def _behaviours_of(
    intention: Behaviour, lexicon: Lexicon, speech: Behaviour | None
) -> list[Behaviour]:
    """Return the behaviours that show an intention."""
    strength, target = _strength(intention), intention.get("target")
    syncs = dict(intention.syncs)
    if not syncs and speech is not None:
        syncs = {sync: SyncReference(speech.id, sync) for sync in ("start", "end")}
    syncs.setdefault("start", SyncReference())
    shown = [
        each
        for each in lexicon.entries[intention.kind, intention.get("type")]
        if strength >= each.least and (target or "{target}" not in each.attributes.values())
    ]
    return [
        Behaviour(
            id=f"{intention.id}-{number}",
            kind=each.behaviour,
            syncs=_syncs(each, syncs),
            attributes={
                key: _attribute(value, strength if key in each.scaled else 1.0, target)
                for key, value in each.attributes.items()
            },
            required=intention.required,
            line=intention.line,
            yielding=intention.yielding,
        )
        for number, each in enumerate(shown, 1)
    ]


def _syncs(shown: Shown, syncs: dict[str, SyncReference]) -> dict[str, SyncReference]:
    """Return when sync points are; those at an end that is not known are free."""
    return {
        sync: replace(syncs[end], offset=syncs[end].offset + offset)
        for sync, (end, offset) in shown.syncs.items()
        if end in syncs
    }


def _attribute(value: str | float, scale: float, target: str) -> str:
    if isinstance(value, str):
        return value.replace("{target}", target)
    return f"{value * scale:g}"


def _strength(intention: Behaviour) -> float:
    """Return how strong an intention is, 0…1."""
    text = next((intention.get(name) for name in STRENGTHS if intention.get(name)), "1")
    try:
        strength = float(text)
    except ValueError:
        strength = -1.0
    if intention.yielding:
        return min(max(strength, 0.0), 1.0) if strength == strength else 1.0
    if not 0.0 <= strength <= 1.0:
        raise CharacterError(f'FML: {intention.id} is "{text}" strong; give 0 to 1')
    return strength
