"""Beat gestures that follow the accents of speech: their analysis, rules, graph and planning.

Source: Fernández-Baena, PhD thesis, La Salle – URL, 2015, chapter 4 (M4, M6, M7 and M9).
"""
