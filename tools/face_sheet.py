"""Draws the talking faces for the documentation: `python -m tools.face_sheet [human|vleo]`.

For each character a sheet of its visemes from the front and from the side, the vowels in their low,
neutral and high versions, and what it says frame by frame. The words need a voice.
"""

import sys
from collections.abc import Iterator, Sequence
from contextlib import ExitStack
from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console

from cubeling.app.ui.contact_sheets import save
from cubeling.characters import Animator, Character, CharacterCommand, Pose
from cubeling.characters.control.command import SpeechIntent
from cubeling.characters.face.visemes.coarticulation import EMPHASIS_LEVELS
from cubeling.characters.face.visemes.mouth_morphs import MouthMorphs
from cubeling.characters.face.visemes.sets import MOUTH_SHAPES, VOWEL_SHAPES
from cubeling.characters.rendering import create_context, standing_pose
from cubeling.characters.rendering.portrait import PortraitRenderer, side_by_side
from cubeling.characters.speech.speech import Utterance
from cubeling.characters.speech.voices import espeak
from tools.captions import underlined

FOLDER = Path(__file__).parent.parent / "docs" / "pictures"

SAID = ("mama", "fifty-five", "oo-ee", "Barcelona")
FRAME_RATE = 30.0

FOCUS = {"human": ((0.0, 1.36, 0.13), 0.125), "vleo": ((0.0, 0.224, 0.150), 0.044)}
"""Centre of the mouth and radius of what is shown around it, at rest [m]."""

MAX_BYTES = 300_000
COLUMNS, CAPTION_PX = 10, 16
LEAD_S, TAIL_S = 0.06, 0.15

Image = NDArray[np.uint8]


class FaceSheets:
    """Draws the sheets of one character; it does not release the context of the renderer."""

    def __init__(self, renderer: PortraitRenderer, character: Character) -> None:
        self._renderer, self._character = renderer, character
        self._mouth = MouthMorphs.of(character.morphs)
        centre, radius = FOCUS[character.name]
        head = character.skeleton.names.index("head")
        place = character.skeleton.rest.globals(character.skeleton)[head]
        self._from_head = np.linalg.inv(place) @ [*centre, 1.0]
        self._head, self._radius = head, radius

    def draw(self, pose: Pose, caption: str, azimuth: float = 0.2) -> Image:
        """Return a picture of the mouth with a caption."""
        place = pose.globals(self._character.skeleton)[self._head]
        centre = (place @ self._from_head)[:3]
        picture = self._renderer.portrait(
            self._character, pose, azimuth=azimuth, elevation=0.03, focus=(centre, self._radius)
        )
        return underlined(picture, caption, CAPTION_PX, 0.42)

    def shaped(self, shape: str, level: int = 1) -> Pose:
        """Return the character standing with a shape of the mouth."""
        shapes = np.zeros((len(EMPHASIS_LEVELS), len(MOUTH_SHAPES)))
        shapes[level, MOUTH_SHAPES.index(shape)] = 1.0
        morphs = np.zeros(len(self._character.morphs))
        morphs[self._mouth.numbers] = self._mouth.of_shapes(shapes)
        return replace(standing_pose(self._character), morphs=morphs)

    def visemes(self) -> Image:
        """Return all visemes from the front and from the side, and the levels of the vowels."""
        pictures = [
            self.draw(self.shaped(shape), shape, azimuth)
            for shape in MOUTH_SHAPES
            for azimuth in (0.0, 0.8)
        ]
        vowels = [shape for shape in MOUTH_SHAPES if shape in VOWEL_SHAPES]
        for level, name in enumerate(EMPHASIS_LEVELS):
            for shape in vowels:
                shown = self.shaped(shape, level)
                pictures += [self.draw(shown, f"{shape} {name}", a) for a in (0.0, 0.8)]
        return side_by_side(pictures, COLUMNS)

    def spoken(self, utterance: Utterance) -> Image:
        """Return an utterance frame by frame, each captioned with its time and phone."""
        animator, still = Animator(self._character), standing_pose(self._character)
        pictures = []
        for now in np.arange(-LEAD_S, utterance.duration + TAIL_S, 1 / FRAME_RATE).tolist():
            said = SpeechIntent(utterance, 0.0)
            posed = animator.update(CharacterCommand(now, speech=said))
            letters = [p.symbol for p in utterance.phones if p.start <= now < p.end]
            plain = (letters or [""])[0].translate(_ASCII).encode("ascii", "ignore").decode()
            shown = replace(still, morphs=posed.pose.morphs)
            pictures.append(self.draw(shown, f"{1000 * now:4.0f} ms {plain}"))
        return side_by_side(pictures, COLUMNS)


_ASCII = str.maketrans({"ɐ": "a", "ɑ": "a", "ə": "e", "ɪ": "i", "ʊ": "u", "ː": "", "ɛ": "e"})


def utterances(texts: Sequence[str]) -> Iterator[Utterance]:
    """Yield what a voice makes of texts."""
    with espeak() as voice:
        for text in texts:
            said = voice.say(text, "en")
            yield Utterance(said.text, "en", said.duration, said.words, said.phones)


def main(names: Sequence[str]) -> int:
    """Draw the sheets of the named characters, or of all."""
    said = list(utterances(SAID))
    with ExitStack() as closing:
        context = create_context()
        closing.callback(context.release)
        renderer = PortraitRenderer(context, (150, 104))
        closing.callback(renderer.release)
        for name in names or FOCUS:
            sheets = FaceSheets(renderer, Character.load(name))
            spoken = np.vstack([sheets.spoken(utterance) for utterance in said])
            for kind, picture in (("visemes", sheets.visemes()), ("words", spoken)):
                path = FOLDER / f"face-{name}-{kind}.jpg"
                save(picture, path, MAX_BYTES)
                Console().print(f"{path.name}: {path.stat().st_size / 1e3:.0f} kB")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
