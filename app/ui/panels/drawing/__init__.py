"""Panels drawn with Dear ImGui, in the look of the cards."""
