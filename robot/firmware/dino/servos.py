"""The configuration of your robot: the only file to edit; see docs/build-a-robot.md."""

NAME = "Dino"
"""Name of the robot; at most 16 bytes."""

PORT: tuple[int, ...] | None = None
"""Port of the host: None for USB, or (number, tx pin, rx pin) of a UART."""

DRIVER: tuple[int, int, int, int] | None = None
"""Servo driver: None for servos on pins, or (I2C number, sda, scl, address) of a PCA9685."""

BUZZER: int | None = 22
"""Pin of a piezo buzzer; None for a robot without sounds."""

BATTERY: tuple[int, float, float, float] | None = None
"""None for mains, or (ADC pin, volts when empty, volts when full, voltage divider's ratio)."""

DEVELOPER_PIN = 13
"""If this pin is held to ground at boot, the robot does not start. Not a servo's pin."""

REST_AFTER = 60
"""Time without a host after which the robot rests and its servos lose power [s]."""

SERVOS = (
    # joint, pin, lowest and highest angle of the joint [°], position of the servo when the joint
    # is at 0 [° of the servo's 0 … 180], direction +1 or -1, trim [°], top speed [°/s], pulse
    # width at the servo's 0° and at its 180° [µs]
    ("neck sideways", 16, -55, 55, 90, 1, 0, 50, 500, 2500),
    ("neck up", 17, -40, 40, 90, 1, 0, 40, 500, 2500),
    ("tail sideways", 18, -60, 60, 90, 1, 0, 200, 500, 2500),
    ("tail up", 19, -20, 60, 70, 1, 0, 200, 500, 2500),
    ("eyes and mouth", 21, -80, 85, 90, 1, 0, 220, 500, 2500),
)
"""Every servo, in the order of the catalogue; the joints' names are those of `motions`."""
