"""What `cubeling scenario new` writes: a file of rules, or a package with its test."""

import keyword
from pathlib import Path

from cubeling.app.errors import AppError
from cubeling.app.scenarios import scenario_names
from cubeling.files import write_whole

RULES = """\
# A scenario of rules: docs/rules.md, or cubeling scenario words.
summary = "it waves when you lift the cube, and cheers when you shake it"
character = "human"
cube = "companion"
hint = "Lift the cube, or shake it"

[[rule]]
when = "shaken"
do = "cheer"
say = "Hooray!"

[[rule]]
when = "lifted"
do = "wave"
say = "Hello!"
hint = "Now shake me"

[[rule]]
while = "far 30"
go = "cube"
"""
"""A file of rules to begin with."""

PROJECT = """\
[build-system]
requires = ["setuptools>=77"]
build-backend = "setuptools.build_meta"

[project]
name = "cubeling-{dashed}"
version = "0.1.0"

[project.entry-points."cubeling.scenarios"]
{name} = "cubeling_{name}:{class_name}"

[tool.setuptools]
py-modules = ["cubeling_{name}"]
"""

SCENARIO = '''\
"""Lift the cube, and the character waves."""

from cubeling.affect import Personality
from cubeling.app.scenarios import (
    Inputs,
    MoodController,
    Outcome,
    Presence,
    ScenarioSettings,
    Situation,
)
from cubeling.characters import ActionIntent, CharacterCommand, RootDelta
from cubeling.tracking import CubeControls, CubeModel

WAVE_S = 3.0
"""How long it waves [s]."""


class {class_name}:
    """Waves when the cube is lifted."""

    name = "{name}"
    summary = "lift the cube, and the character waves"
    cube = "companion"
    roles: tuple[str, ...] = ()
    character = "human"
    personality = "lively"
    start = RootDelta(-0.12, 0.0, 0.0)
    has_intensity = False

    def __init__(self, cube: CubeModel, settings: ScenarioSettings) -> None:
        self._mood = MoodController(settings.personality or Personality.load(self.personality))
        self._presence = Presence()
        self._until = 0.0

    def update(self, controls: CubeControls, situation: Situation, inputs: Inputs) -> Outcome:
        """Decide on one frame."""
        now = controls.timestamp
        if inputs.clear:
            self._mood.reset()
            self._until = 0.0
        if controls.lifted:
            self._until = now + WAVE_S
        action = "wave" if now < self._until else "idle"
        visible = self._presence.update(controls)
        command = CharacterCommand(now, action=ActionIntent(action, 1.0), visible=visible)
        emotion = self._mood.update(controls, action if visible else "idle")
        return Outcome(command, emotion, "Lift the cube", icon=action)
'''

TEST = '''\
"""It waves when the cube is lifted, and for a while after."""

from cubeling.app.scenarios import Inputs, ScenarioSettings, Situation
from cubeling.tracking import CubeControls, CubeModel
from cubeling_{name} import WAVE_S, {class_name}


def test_it_waves_while_the_cube_is_lifted_and_for_a_while_after():
    scenario = {class_name}(CubeModel.load("companion"), ScenarioSettings())

    def action(timestamp, lifted):
        controls = CubeControls(
            visible=True,
            top_face="top",
            heading=0.0,
            camera_angle=0.0,
            turns=0.0,
            resting=not lifted,
            placed=False,
            lifted=lifted,
            position=None,
            timestamp=timestamp,
        )
        return scenario.update(controls, Situation(), Inputs()).command.activity

    assert action(0.0, False) == "idle"
    assert action(1.0, True) == "wave"
    assert action(1.5, False) == "wave"
    assert action(1.1 + WAVE_S, False) == "idle"
'''


def write_package(name: str) -> Path:
    """Write a package with a scenario and its test to a folder of its name; return the folder.

    Raises
    ------
    AppError
        The name is none for a module, or a scenario or a folder has it, or the folder cannot be
        written.
    """
    if not (name.isidentifier() and name.isascii() and name.islower()) or keyword.iskeyword(name):
        raise AppError(
            f"'{name}' cannot be a scenario's name: take lower-case letters, digits and _, "
            "or end it in .toml for a file of rules"
        )
    if name in scenario_names():
        raise AppError(f"there is a scenario '{name}' already: choose another name")
    folder = Path(name)
    try:
        folder.mkdir()
    except OSError as error:
        raise AppError(f"cannot make the folder '{folder}': {error.strerror}") from error
    words = {
        "name": name,
        "dashed": name.replace("_", "-"),
        "class_name": "".join(part.capitalize() for part in name.split("_")),
    }
    for file, text in (
        ("pyproject.toml", PROJECT),
        (f"cubeling_{name}.py", SCENARIO),
        (f"test_{name}.py", TEST),
    ):
        write_whole(folder / file, text.format(**words), AppError)
    return folder
