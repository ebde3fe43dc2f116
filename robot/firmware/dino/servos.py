"""The robot that you have built: the one file to edit. docs/build-a-robot.md explains it."""

NAME = "Dino"
"""What the robot is called; at most 16 bytes."""

PORT: tuple[int, ...] | None = None
"""Where the host is: None for the board's USB socket, or (number, tx pin, rx pin) of a UART."""

DRIVER: tuple[int, int, int, int] | None = None
"""None: each servo is on a pin of the board. Or a PCA9685: (I2C number, sda, scl, address)."""

BUZZER: int | None = 22
"""Pin of a piezo buzzer, or None: then the robot has no sounds."""

BATTERY: tuple[int, float, float, float] | None = None
"""None: mains, always full. Or (ADC pin, volts when empty, when full, volts for one on the pin)."""

DEVELOPER_PIN = 13
"""Held to ground while the board starts, it does not start the robot. Never a servo's pin."""

REST_AFTER = 60
"""Without a host for this long [s] the robot stands still and lets its servos go."""

SERVOS = (
    # joint, pin, lowest ° and highest ° of the joint, where the servo stands when the joint is at
    # 0 [° of the servo's 0 … 180], direction +1 or -1, trim [°], top speed [°/s], pulse at the
    # servo's 0° and at its 180° [µs]
    ("neck sideways", 16, -55, 55, 90, 1, 0, 50, 500, 2500),
    ("neck up", 17, -40, 40, 90, 1, 0, 40, 500, 2500),
    ("tail sideways", 18, -60, 60, 90, 1, 0, 200, 500, 2500),
    ("tail up", 19, -20, 60, 70, 1, 0, 200, 500, 2500),
    ("eyes and mouth", 21, -80, 85, 90, 1, 0, 220, 500, 2500),
)
"""Every servo, in the order of the catalogue; the joints' names are those of `motions`."""
