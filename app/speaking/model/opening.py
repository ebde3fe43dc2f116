"""Opening what asks a language model in a session."""

from cubeling.app.pipeline.scenario import ConversingScenario
from cubeling.app.session import SessionOptions
from cubeling.app.speaking.model.answerer import Answerer


def open_answerer(options: SessionOptions, scenario: object, *, waits: bool) -> Answerer:
    """Return what asks the model that the user has named, if a scenario talks; else it asks nobody.

    The caller closes it. A replay has the answers: there the scenario is None.

    Raises
    ------
    AppError
        The address or the key cannot be used.
    """
    if options.model is None or not isinstance(scenario, ConversingScenario):
        return Answerer()
    from cubeling.app.speaking.model.chat import ChatModel  # loads what TLS needs

    model = ChatModel(options.model, options.model_name, scenario.script, scenario.gestures)
    return Answerer(model, waits=waits)
