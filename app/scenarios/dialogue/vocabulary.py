"""What a script may name in play: the words of files of rules, besides those of every script."""

from cubeling.app.errors import AppError
from cubeling.app.scenarios.rules.vocabulary import ACTIONS, MOMENTARY_CONDITIONS, Term
from cubeling.characters import CharacterError
from cubeling.characters.behaviour import CORE_VOCABULARY, ConditionKind, act, only_text


def _term(text: str) -> Term:
    try:
        return Term.parse(text)
    except AppError as error:
        raise CharacterError(str(error)) from None


TALK_VOCABULARY = CORE_VOCABULARY.extended(
    {
        "cube": ConditionKind(
            "a condition of docs/rules.md holds, such as: not lifted",
            lambda element: _term(only_text(element)),
            lambda now, term: {} if now.world is not None and term.holds(now.world) else None,
            lambda term: term.name in MOMENTARY_CONDITIONS and not term.negated,
        )
    },
    {name: act(name, action.meaning, action.choices) for name, action in ACTIONS.items()},
)
"""The conditions and actions of a script that is played; `world` is the `Moment` of rules."""
