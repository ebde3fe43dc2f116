"""Children talk with a dialogue for 10⁵ turns: `python -m tests.campaigns.talk [--turns 1e5]`.

They say what the script knows, with typing errors, in both languages; nonsense, signs and long
lines; the same thing again and again; nothing at all; they interrupt, shake the cube, and kiss.
Only the dialogue runs, on virtual time, with emotions that come and go.

Exits with 1 if something typed is not answered, if silence is not broken in a minute, if a line is
said three times running, if a reply is in another language than the one that is spoken, is no
tagged text or holds an empty slot, if an answer takes longer than `MAX_ANSWER_S`, or if the state
grows after the first tenth.
"""

import argparse
import pickle
import sys
import time
from collections import Counter
from dataclasses import dataclass, field

import numpy as np
from rich.console import Console
from rich.table import Table

from cubeling.affect import OCC_FACES
from cubeling.app.scenarios.dialogue.scenario import BUNDLED_SCRIPT
from cubeling.app.scenarios.dialogue.vocabulary import TALK_VOCABULARY
from cubeling.characters.behaviour import Dialogue, DialogueScript, estimate, read_script
from cubeling.characters.dialogue.patterns import WordPattern
from cubeling.characters.dialogue.script import Localized
from cubeling.characters.dialogue.spelling import WordSet
from cubeling.characters.speech import TaggedText

TURNS_PER_CHILD = 200
"""Turns of one child, who then has a name and has been told things."""

STEP_S = 0.1
"""Time between two updates while nobody says anything [s]."""

MAX_SILENCE_S = 60.0
"""A character that says nothing for so long, while nobody else does either, is silent for ever."""

MAX_ANSWER_S = 0.2
"""Longest time of one answer, on the processor [s]."""

MAX_STATE_BYTES = 40_000
"""Largest state of a dialogue [B]."""

CUBE = (
    "the cube was shaken", "the cube was lifted", "the cube was put down", "face up: heart",
    "kiss", "kiss, strongly", "shout", "shout, softly",
)  # fmt: skip
NAMES = ("Ana", "Bob", "Zoë", "João", "x", "O'Neill", "李", "<b>", "a" * 80)
LETTERS = "abcdefghijklmnopqrstuvwxyzñéü "


@dataclass
class Score:
    """What was counted, and what went wrong."""

    counts: Counter[str] = field(default_factory=Counter)
    failures: list[str] = field(default_factory=list)
    slowest_s: float = 0.0
    state_bytes: list[int] = field(default_factory=list)

    def fail(self, why: str) -> None:
        """Note a failure."""
        self.counts["failures"] += 1
        self.failures.append(why)


def sentences_of(script: DialogueScript) -> list[str]:
    """Return texts that a script's patterns match."""
    found = []
    for transition in script.transitions:
        for item in transition.conditions:
            if isinstance(item.argument, Localized):
                for _, each in item.argument:
                    if isinstance(each, WordPattern):
                        found.append(each.text)
                    elif isinstance(each, WordSet):
                        found += sorted(each.words)
    return found


class Child:
    """Says things at random."""

    def __init__(self, sentences: list[str], rng: np.random.Generator) -> None:
        self._sentences, self._rng, self._last = sentences, rng, "hello"

    def says(self) -> tuple[str, str]:
        """Return what it does, and the text: typed, the cube, silence."""
        kind = self._rng.choice(
            ["known", "typos", "nonsense", "odd", "again", "cube", "silence"],
            p=[0.4, 0.2, 0.12, 0.05, 0.08, 0.08, 0.07],
        )
        text = getattr(self, f"_{kind}")()
        if kind not in ("cube", "silence"):
            self._last = text
        return str(kind), text

    def _pick(self, choices: object) -> str:
        return str(choices[int(self._rng.integers(len(choices)))])  # type: ignore[index,arg-type]

    def _known(self) -> str:
        words = []
        for word in self._pick(self._sentences).split():
            if word == "*":
                words += [self._pick(LETTERS[:26]) * 2] * int(self._rng.integers(2))
            else:
                words.append(self._pick(NAMES) if word.startswith("{") else word)
        return " ".join(words) or "hello"

    def _typos(self) -> str:
        letters = list(self._known())
        for _ in range(1 + len(letters) // 12):
            at = int(self._rng.integers(len(letters)))
            edit = self._rng.integers(4)
            if edit == 0:
                letters[at] = self._pick(LETTERS)
            elif edit == 1:
                letters.insert(at, self._pick(LETTERS))
            elif edit == 2 and len(letters) > 2:
                del letters[at]
            elif at + 1 < len(letters):
                letters[at : at + 2] = letters[at + 1], letters[at]
        return "".join(letters).strip() or "hi"

    def _nonsense(self) -> str:
        count = int(self._rng.integers(1, 30))
        return "".join(self._pick(LETTERS) for _ in range(count)).strip() or "x"

    def _odd(self) -> str:
        return self._pick(
            ("?", "!!!", "❤️❤️", "…", "a " * 300, "{name}", "<begin_gesture>", "*", "| |", "1", "¿¿",
             "\x07", "no " * 90, "ß" * 399, "null", "../../etc")
        )  # fmt: skip

    def _again(self) -> str:
        return self._last

    def _cube(self) -> str:
        return self._pick(CUBE)

    def _silence(self) -> str:
        return ""


class Talk:
    """One dialogue with one child, checked turn by turn."""

    def __init__(self, script: DialogueScript, child: Child, seed: int, score: Score) -> None:
        self._dialogue = Dialogue(script, seed=seed, vocabulary=TALK_VOCABULARY)
        self._script, self._child, self._score = script, child, score
        self._rng = np.random.default_rng([seed, 1])
        self._feelings = dict.fromkeys(OCC_FACES, 0.0)
        self._now, self._speaks_until = 0.0, 0.0
        self._said = ["", ""]

    def turn(self) -> None:
        """Let the child say something, or nothing."""
        kind, text = self._child.says()
        self._score.counts[kind] += 1
        if self._rng.random() < 0.7 and self._now < self._speaks_until:  # it listens to the end
            self._now = self._speaks_until + float(self._rng.exponential(1.5))
        if kind == "silence":
            self._wait()
            return
        self._dialogue.hear(text, typed=kind != "cube")
        if not self._update(text) and kind != "cube":
            self._score.fail(f"no answer to {text!r:.60}")
        self._now += float(self._rng.exponential(2.0))

    def _wait(self) -> None:
        end = max(self._now, self._speaks_until) + MAX_SILENCE_S
        while self._now < end:
            self._now += STEP_S
            if self._update(""):
                return
        self._score.fail("silence for ever")

    def _update(self, text: str) -> bool:
        """Advance the dialogue, check what it does, and return whether it said something."""
        began = time.process_time() if text else 0.0
        turn = self._dialogue.update(
            self._now, busy=self._now < self._speaks_until, feelings=self._feelings
        )
        if text:
            took = time.process_time() - began  # of this process: others may be busy, too
            self._score.slowest_s = max(self._score.slowest_s, took)
            if took > MAX_ANSWER_S:
                self._score.counts["slow"] += 1
        if turn is None:
            return False
        for word in self._feelings:
            self._feelings[word] *= 0.9
        for word, value in turn.influences:
            self._feelings[word] = min(1.0, self._feelings[word] + value)
        if not turn.text:
            return False
        plain = TaggedText.read(turn.text).text
        if not plain.strip() or "{" in plain:
            self._score.fail(f"to {text!r:.40} it says {plain!r:.80}")
        if turn.language != self._dialogue.state.language:
            self._score.fail(f"{turn.language} while {self._dialogue.state.language} is spoken")
        if self._said == [turn.text, turn.text]:
            self._score.fail(f"three times running: {plain!r:.80}")
        self._said = [self._said[1], turn.text]
        self._score.counts[f"replies in {turn.language}"] += 1
        self._speaks_until = self._now + estimate(plain).duration
        self._dialogue.remember_said(plain[: int(self._rng.integers(1, len(plain) + 1))])
        return True

    @property
    def state_bytes(self) -> int:
        """Size of the state that a checkpoint copies [B]."""
        return len(pickle.dumps(self._dialogue.state))


def run(turns: int, seed: int, script: DialogueScript | None = None) -> Score:
    """Let children talk for so many turns, with the bundled script or another one."""
    script = script or read_script(BUNDLED_SCRIPT, TALK_VOCABULARY)
    sentences, score = sentences_of(script), Score()
    for number in range(-(-turns // TURNS_PER_CHILD)):
        child = Child(sentences, np.random.default_rng([seed, number]))
        # Most children go on where others stopped, so that growth would show.
        if number % 10 == 0:
            talk = Talk(script, child, seed + number, score)
        for _ in range(min(TURNS_PER_CHILD, turns - number * TURNS_PER_CHILD)):
            talk.turn()
        score.state_bytes.append(talk.state_bytes)
    if max(score.state_bytes) > MAX_STATE_BYTES:
        score.fail(f"a state of {max(score.state_bytes)} bytes")
    if score.counts["slow"]:
        score.fail(f"{score.counts['slow']} answers took longer than {MAX_ANSWER_S:g} s")
    return score


def main() -> int:
    """Run the campaign."""
    parser = argparse.ArgumentParser(description="Let simulated children talk with Vleo.")
    parser.add_argument("--turns", type=lambda text: int(float(text)), default=100_000)
    parser.add_argument("--seed", type=int, default=1)
    wanted = parser.parse_args()
    began = time.perf_counter()
    score = run(wanted.turns, wanted.seed)
    table = Table("what", "number", title="turns with the bundled Vleo")
    for what, number in sorted(score.counts.items()):
        table.add_row(what, f"{number:,}")
    table.add_row("largest state", f"{max(score.state_bytes):,} B")
    table.add_row("slowest answer", f"{1e3 * score.slowest_s:.0f} ms")
    table.add_row("seconds", f"{time.perf_counter() - began:.0f}")
    Console().print(table, *score.failures[:20], markup=False)
    return 1 if score.failures else 0


if __name__ == "__main__":
    sys.exit(main())
