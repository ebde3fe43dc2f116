"""FML: intentions and emotions, and the behaviours that show them by a lexicon."""

from cubeling.characters.behaviour.fml.lexicon import Lexicon, Shown
from cubeling.characters.behaviour.fml.planner import behaviours_of, shown_by

__all__ = ["Lexicon", "Shown", "behaviours_of", "shown_by"]
