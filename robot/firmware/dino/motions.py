"""The motions, generated from the simulated robot by tools.firmware_tables."""

# Do not edit: a test compares.
# fmt: off
TURN = 1024
MOODS = 3
HAPPY_ABOVE = 3300
ANGRY_BELOW = -3300
HYSTERESIS = 500

# (name, ms of one round, sound of a mood or None, (joint, offset and amplitude in
# 1/100 degree, cycles in a round, start in 1/1024 cycle)); the moods' loops come first.
MOTIONS: tuple[
    tuple[str, int, str | None, tuple[tuple[str, int, int, int, int], ...]], ...
] = (
    ("neutral", 4000, "breath", (
        ("torso", 0, 200, 1, 0),
        ("neck up", 500, 400, 1, 256),
        ("neck sideways", 0, 1000, 1, 0),
        ("tail sideways", 0, 1200, 1, 512),
        ("eyes and mouth", 5000, 800, 2, 0),
    )),
    ("happy", 3200, "purr", (
        ("right shoulder", 800, 600, 1, 0),
        ("left shoulder", 800, 600, 1, 512),
        ("torso", 0, 600, 1, 0),
        ("neck up", 2500, 800, 2, 0),
        ("neck sideways", 0, 2000, 1, 256),
        ("tail up", 3000, 800, 2, 0),
        ("tail sideways", 0, 4500, 2, 0),
        ("eyes and mouth", 6500, 1500, 2, 0),
    )),
    ("angry", 2400, "growl", (
        ("right shoulder", -1500, 0, 1, 0),
        ("left shoulder", -1500, 0, 1, 0),
        ("right elbow", 3500, 800, 2, 0),
        ("left elbow", 3500, 800, 2, 512),
        ("torso", -600, 350, 2, 0),
        ("neck up", -3000, 500, 2, 0),
        ("neck sideways", 0, 1500, 1, 0),
        ("tail up", 4500, 1000, 3, 0),
        ("tail sideways", 0, 2500, 3, 0),
        ("eyes and mouth", -5500, 2000, 2, 0),
    )),
    ("nod", 2000, None, (
        ("neck up", 0, 600, 2, 0),
        ("eyes and mouth", 5000, 0, 1, 0),
    )),
    ("shake head", 2000, None, (
        ("neck sideways", 0, 700, 2, 0),
        ("eyes and mouth", 5000, 0, 1, 0),
    )),
    ("wag tail", 2000, None, (
        ("tail sideways", 0, 3000, 2, 0),
        ("tail up", 2000, 0, 1, 0),
    )),
    ("bow", 4000, None, (
        ("right shoulder", 1800, 1800, 1, 768),
        ("left shoulder", 1800, 1800, 1, 768),
        ("right elbow", 3000, 3000, 1, 768),
        ("left elbow", 3000, 3000, 1, 768),
        ("neck up", -2000, 2000, 1, 256),
    )),
    ("kiss", 2400, None, (
        ("neck up", 1200, 800, 1, 768),
        ("eyes and mouth", -5000, 3000, 2, 768),
    )),
    ("shout", 2000, None, (
        ("neck up", -1200, 1000, 1, 768),
        ("neck sideways", 0, 600, 2, 0),
        ("tail up", 4000, 1000, 2, 0),
        ("eyes and mouth", -4000, 2000, 3, 768),
    )),
)
