"""The BML of others: drafts and dialects, read as BML 1.0 with a note for each line changed."""

from cubeling.characters.behaviour.bml.dialects.front import parse_dialect

__all__ = ["parse_dialect"]
