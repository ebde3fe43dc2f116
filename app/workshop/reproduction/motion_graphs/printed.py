"""Tables 3.2, 3.3 and 3.4 as the thesis prints them (Fernández-Baena 2015, chapter 3.5)."""

CRITICAL = {"SMG": 0.165, "BPMG": 0.105}
"""The least printed threshold at which all four clips are joined."""

TABLE_3_2 = {
    0.06: ((19.99, 14.24), (17.24, 4.34)),
    0.075: ((19.65, 13.61), (17.28, 4.42)),
    0.09: ((18.95, 13.30), (17.27, 4.41)),
    0.105: ((18.43, 12.92), (17.30, 4.40)),
    0.12: ((18.18, 12.74), (17.30, 4.37)),
    0.165: ((18.20, 12.53), (17.30, 4.37)),
}
"""By threshold: TBF and response of SMG, then of BPMG [frames at 60 Hz].

Its colours are lost, but for the first threshold at which all four clips are joined."""

TABLE_3_3 = {
    "SMG": {
        (0, 1): (10.71, 6.35), (0, 2): (3.68, 0.43), (0, 3): (3.40, 0.63),
        (1, 0): (4.26, 0.84), (1, 2): (5.26, 0.84), (1, 3): (7.26, 0.84),
        (2, 0): (5.71, 2.52), (2, 1): (15.86, 11.50), (2, 3): (5.23, 2.91),
        (3, 0): (3.73, 0.01), (3, 1): (25.00, 18.23), (3, 2): (2.86, 0.00),
    },
    "BPMG": {
        (0, 1): (5.91, 0.00), (0, 2): (3.90, 0.00), (0, 3): (2.61, 0.02),
        (1, 0): (2.41, 0.00), (1, 2): (4.97, 0.00), (1, 3): (3.29, 0.00),
        (2, 0): (5.11, 0.06), (2, 1): (9.54, 1.53), (2, 3): (3.95, 0.15),
        (3, 0): (3.40, 0.00), (3, 1): (9.40, 0.01), (3, 2): (3.10, 0.00),
    },
}  # fmt: skip
"""LM and LM response from clip to clip [frames]."""

SHORTER_AND_SOONER = 10, 11
"""In how many of its 12 pairs parts are shorter, and sooner, than the whole body."""

TABLE_3_4 = (
    ("SP4b", "SP4b", "SP4b", "SP4b"),
    ("SP3a", "SP3a", "SP3a", "SP3a"),
    ("SP4b", "SP3a", "SP2", "SP2"),
    ("SP4b", "SP3a", "SP2", "SP2"),
)
"""The best split profile from clip (down) to clip (across); the diagonal is inside a clip."""
