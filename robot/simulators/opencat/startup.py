"""What a board says while it starts, and when."""

from typing import NamedTuple

import numpy as np

QUESTION = "- Reset the joints' calibration offsets? (Y/n): "
"""What a new board asks its owner; it waits for a byte, and a "Y" erases."""


class Spoken(NamedTuple):
    """Something that is said while a board starts."""

    after: float
    """Time since what was said before it [s]."""

    text: str
    """What is said, with its end."""


def startup(random: np.random.Generator, model: str, version: str, new_board: bool) -> list[Spoken]:
    """Return what a board says while it starts, in order.

    Like a real one, it begins with bytes at another baud rate and a "k" that echoes nothing, and
    ends with the rest that it orders itself.
    """
    noise = "".join(chr(code) for code in random.integers(128, 255, 9).tolist())
    lines = [
        f"{noise}\r\nrst:0x1 (POWERON_RESET),boot:0x13 (SPI_FAST_FLASH_BOOT)",
        "k",
        "Flush the serial buffer...",
        "",
        "* Start *",
        model,
        f"Software version: {version}",
        "Scanning I2C network...",
        "- I2C device found at address 0x68:\tMPU6050",
        *([f"Set up the new board...\r\n{QUESTION}"] if new_board else []),
        "Buzzer volume: 5/10",
        "Calibrated zero positions",
        "Build skill list...52",
        "Ready!",
        "g",
        "d",
    ]
    pauses = random.uniform(0.01, 0.35, len(lines)).tolist()
    return [Spoken(pause, line + "\r\n") for pause, line in zip(pauses, lines, strict=True)]
