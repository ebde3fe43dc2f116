"""Opening what asks a language model in a session."""

from functools import cache

from cubeling.app.errors import AppError
from cubeling.app.pipeline.scenario import ConversingScenario
from cubeling.app.scenarios import find_scenario
from cubeling.app.session import SessionOptions
from cubeling.app.speaking.model.answerer import Answerer
from cubeling.app.speaking.model.protocol import LanguageModel


def open_answerer(options: SessionOptions, *, replays: bool, waits: bool) -> Answerer:
    """Return what asks the model that the user has named, for each scenario that talks.

    The caller closes it. A replay has the answers, and asks nobody.

    Raises
    ------
    AppError
        The address or the key cannot be used, or nothing that is played ever asks.
    """
    if options.model is None or replays:
        return Answerer()
    from cubeling.app.speaking.model.chat import ChatModel, checked_url  # loads what TLS needs

    address = options.model

    @cache
    def model_of(name: str) -> LanguageModel | None:
        scenario: object = find_scenario(name)
        if not isinstance(scenario, ConversingScenario) or scenario.conversation is None:
            return None
        return ChatModel(address, options.model_name, scenario.conversation, scenario.gestures)

    checked_url(address)
    if model_of(options.scenario) is None and not options.windowed:
        raise AppError(f"nobody answers in '{options.scenario}': --model is for a talk")
    return Answerer(model_of, waits=waits)
