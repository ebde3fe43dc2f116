"""A whole Pleo: fourteen joints on a PCA9685. Copy it over `dino/servos.py`, which explains it.

Limits are Pleo's, reduced where a servo of 180° cannot follow. Top speeds are Pleo's, or lower for
a servo that carries a leg.
"""

NAME = "Pleo of ours"
PORT = None
DRIVER = (0, 20, 21, 0x40)
BUZZER = 22
BATTERY = None
DEVELOPER_PIN = 13
REST_AFTER = 60
SERVOS = (
    ("right shoulder", 0, -30, 55, 90, 1, 0, 30, 500, 2500),
    ("right elbow", 1, 0, 90, 45, 1, 0, 70, 500, 2500),
    ("left shoulder", 2, -30, 55, 90, -1, 0, 30, 500, 2500),
    ("left elbow", 3, 0, 90, 135, -1, 0, 70, 500, 2500),
    ("left hip", 4, -45, 40, 90, -1, 0, 50, 500, 2500),
    ("left knee", 5, -70, 0, 55, -1, 0, 50, 500, 2500),
    ("right hip", 6, -45, 40, 90, 1, 0, 50, 500, 2500),
    ("right knee", 7, -70, 0, 125, 1, 0, 50, 500, 2500),
    ("torso", 8, -15, 15, 90, 1, 0, 20, 500, 2500),
    ("tail sideways", 9, -90, 90, 90, 1, 0, 200, 500, 2500),
    ("tail up", 10, -90, 90, 90, 1, 0, 200, 500, 2500),
    ("neck sideways", 11, -65, 55, 90, 1, 0, 50, 500, 2500),
    ("neck up", 12, -75, 75, 90, 1, 0, 40, 500, 2500),
    ("eyes and mouth", 13, -80, 85, 90, 1, 0, 220, 500, 2500),
)
