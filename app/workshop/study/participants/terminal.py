"""A participant at a terminal: questions are asked and answered in it, tasks open a window."""

from pathlib import Path

from rich.console import Console
from rich.panel import Panel
from rich.text import Text

from cubeling.app.errors import AppError
from cubeling.app.workshop.study.participants.live_task import LiveDesk, TaskSetup
from cubeling.app.workshop.study.participants.stimulus_files import names_of
from cubeling.app.workshop.study.protocols.plan import PlannedStep
from cubeling.app.workshop.study.protocols.protocol import Protocol, StimulusSet, pair_members
from cubeling.app.workshop.study.protocols.questionnaires import Answer, Item, Questionnaire


class TerminalDesk(LiveDesk):
    """Asks in a terminal; a `StudyDesk`.

    Ctrl-D ends the study for now, as Ctrl-C does: what was answered is kept.
    """

    def __init__(self, protocol: Protocol, setup: TaskSetup, console: Console) -> None:
        super().__init__(protocol, setup, Path())
        self._console = console
        self._about: tuple[str, int] | None = None

    def tell(self, title: str, text: str) -> None:
        """Show a text until Enter is pressed."""
        self._console.print()
        self._console.print(
            Panel(Text(text), title=Text(title) if title else None, title_align="left")
        )
        self._read("Enter goes on ")

    def ask(self, step: PlannedStep, questionnaire: Questionnaire, item: Item) -> Answer:
        """Show what the question is about and the question, until there is an answer."""
        place = (step.key.rpartition("/")[0], step.place)
        if place != self._about:
            self._about = place
            self._console.rule(Text(questionnaire.title))
            if step.stimulus:
                self._console.print(Text(shown(self._protocol.stimuli[step.part], step)))
        self._console.print(Text(item.words, "bold"))
        for line in choices(item):
            self._console.print(Text(line))
        while True:
            try:
                return item.parse(self._read("> "))
            except AppError as error:
                self._console.print(Text(str(error), "yellow"))

    def thank(self) -> None:
        """Say nothing: the command thanks."""

    def _read(self, prompt: str) -> str:
        try:
            return self._console.input(prompt)
        except EOFError:
            raise KeyboardInterrupt from None


def shown(stimuli: StimulusSet, step: PlannedStep) -> str:
    """Return the words for a stimulus: where it is, or what the experimenter is to show."""
    where = ", ".join(names_of(stimuli, step))
    others = {name: level for name, level in step.stimulus.items() if name != stimuli.pair}
    words = where or f"{step.place}. " + ", ".join(others.values())
    if not stimuli.pair:
        return words
    left, right = pair_members(step.stimulus[stimuli.pair], step.first_left)
    # Who answers is not to know which is which; who shows them is.
    return words if where else f"{words} [experimenter: left {left}, right {right}]"


def choices(item: Item) -> list[str]:
    """Return the lines that say what can be answered."""
    if item.kind == "choice":
        return [f"  {number}  {text}" for number, text in enumerate(item.options, 1)]
    if item.kind == "text":
        return ["  (a text, or Enter for none)"]
    if item.kind == "scale" and len(item.anchors) == len(item.answers) > 2:
        points = zip(item.answers, item.anchors, strict=True)
        return [f"  {point:g}  {word}" for point, word in points]
    low, high = item.anchors or ("", "")
    return [f"  {item.low:g} {low} … {item.high:g} {high}".rstrip()]
