"""The quirks of a simulated board, and its messages at the start."""

from dataclasses import dataclass

import numpy as np


@dataclass(frozen=True)
class BoardQuirks:
    """The quirks of a board."""

    merges: bool = True
    """Whether waiting lines are read as one and the next byte interrupts a skill, as on a BiBoard;
    otherwise lines wait in order and a skill always plays to its end, as on a NyBoard."""

    buffer: int = 256
    """Size of the input buffer [bytes]; further bytes are lost."""

    answers_query: bool = True
    """Whether "?" is answered with model and version; old boards only echo it."""

    slow: float = 0.03
    """Probability that a line is read only after 0.5 s to 1.5 s."""

    mangled: float = 0.01
    """Probability that text without a line end precedes an echo."""

    brown_outs: float = 0.01
    """Probability that the voltage drops during a skill and the board restarts."""

    restless: float = 25.0
    """Mean time between unsolicited sensor texts and falls [s]; 0 for none."""

    battery_lasts: float = 5400.0
    """Time until the battery is low [s]; it is replaced ten minutes later."""


CALIBRATION_QUESTION = "- Reset the joints' calibration offsets? (Y/n): "
"""The question of a new board; it waits for a byte, and "Y" erases the calibration."""


def startup(
    random: np.random.Generator, model: str, version: str, new_board: bool
) -> list[tuple[float, str]]:
    """Return the texts of a board that starts, each with the time since the one before [s].

    Like a real board's, they begin with bytes at another baud rate and a "k" that is no echo, and
    end with the rest that the board commands itself.
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
        *([f"Set up the new board...\r\n{CALIBRATION_QUESTION}"] if new_board else []),
        "Buzzer volume: 5/10",
        "Calibrated zero positions",
        "Build skill list...52",
        "Ready!",
        "g",
        "d",
    ]
    pauses = random.uniform(0.01, 0.35, len(lines)).tolist()
    return [(pause, line + "\r\n") for pause, line in zip(pauses, lines, strict=True)]
