"""Vleo talks about dinosaurs and feelings, in English and Spanish."""

from cubeling.app.scenarios.dialogue.scenario import BUNDLED_SCRIPT, dialogue_scenario

Talk = dialogue_scenario(BUNDLED_SCRIPT, "talk")
"""The bundled script; any other one is played by the path of its file."""
