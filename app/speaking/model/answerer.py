"""Asks a language model in a session, on a thread of its own."""

import queue
import threading
from collections.abc import Callable

from cubeling.affect import Emotion
from cubeling.app.pipeline.scenario import ModelAnswer, ModelQuestion
from cubeling.app.pipeline.step import Step
from cubeling.app.speaking.model.protocol import TIMEOUT_S, LanguageModel, ModelError
from cubeling.app.thread_turns import taken
from cubeling.characters.speech import TaggedText

WAIT_S = TIMEOUT_S + 2.0
"""How long a session that is not in real time waits for an answer [s]."""

CLOSE_TIMEOUT_S = 0.5
"""How long a session waits at its end for a model that does not answer [s]."""


ModelOf = Callable[[str], LanguageModel | None]
"""Returns the model that answers in a scenario, by its name; None where nobody does."""


class Answerer:
    """Asks a model what scenarios want to know; no frame of a live session waits for it.

    Whoever makes it closes it; a second `close` does nothing.

    Parameters
    ----------
    model_of
        Returns the model that answers in a scenario, by its name; None where nobody does.
    waits
        Whether the session is not in real time, so that the next frame waits for an answer.
    """

    def __init__(self, model_of: ModelOf | None = None, *, waits: bool = False) -> None:
        self._model_of, self._waits = model_of, waits
        self._questions: queue.Queue[
            tuple[LanguageModel, tuple[ModelQuestion, Emotion] | str] | None
        ] = queue.Queue()
        self._answers: queue.Queue[ModelAnswer] = queue.Queue()
        self._notices: queue.Queue[str] = queue.Queue()
        self._asked = 0
        self._newest = 0
        self._thread = threading.Thread(target=self._run, name="model", daemon=True)
        if model_of is not None:
            self._thread.start()

    def hear(self, step: Step) -> None:
        """Ask what the scenario of a step wants to know."""
        scenario = step.cast[0].scenario
        model = None if self._model_of is None else self._model_of(scenario)
        if model is None:
            return
        outcome = step.outcome
        if outcome.question is not None:
            self._asked += 1
            self._newest = outcome.question.number
            self._questions.put((model, (outcome.question, step.emotion.emotion)))
        elif outcome.reply is not None and not outcome.reply.is_answer:
            said, _ = TaggedText.read_or_plain(outcome.reply.text)
            self._questions.put((model, said.text))

    def answer(self) -> ModelAnswer | None:
        """Return the next answer that has come; None for none."""
        try:
            if self._waits and self._asked:
                return self._answers.get(timeout=WAIT_S)
            return self._answers.get_nowait()
        except queue.Empty:
            return None
        finally:
            self._asked = 0

    def notice(self) -> str:
        """Return what the player should know, in one line, once; "" for nothing."""
        return taken(self._notices, "")

    def close(self) -> None:
        """End; an answer that is still awaited is not used any more."""
        self._questions.put(None)
        if self._thread.is_alive():
            self._thread.join(CLOSE_TIMEOUT_S)

    def _run(self) -> None:
        while (waiting := self._questions.get()) is not None:
            model, asked = waiting
            if isinstance(asked, str):
                model.remember(asked)
                continue
            question, emotion = asked
            if question.number != self._newest:
                continue  # the player has said something else since
            text, told = "", ""
            try:
                text = model.reply(question.text, emotion)
                told = model.note
            except ModelError as error:
                told = f"{error}; the script answers"
            if told:
                self._notices.put(told)
            self._answers.put(ModelAnswer(question.number, text))
