"""The picture of the wiring, generated from the firmware's default table of servos.

`python -m tools.wiring` renews docs/pictures/robot-wiring.svg; a test compares it.
"""

from pathlib import Path
from xml.sax.saxutils import escape

from cubeling.robot.firmware.dino import servos
from cubeling.robot.firmware.dino.table import Servo, ServoTable

PICTURE = Path(__file__).parents[1] / "docs" / "pictures" / "robot-wiring.svg"
"""Path of the diagram."""

SIGNAL, PLUS, MINUS = "#e08a1e", "#cf3b3b", "#4a4038"
"""Colours of the wires, as on most servos: orange or white, red, brown or black."""

_INK, _SOFT, _LINE, _PAPER = "#26323c", "#5d6b77", "#8794a0", "#ffffff"
_BOARD, _BOARD_EDGE, _SERVO, _SERVO_EDGE = "#2f7d5b", "#205740", "#dfe7ee", "#7d8fa0"
_FONT = "Inter, 'Segoe UI', 'DejaVu Sans', Arial, sans-serif"

_WIDTH, _TOP, _PITCH = 1030, 92, 84  # of the picture; of the first servo; between two
_BOARD_LEFT, _BOARD_RIGHT, _PIN_PITCH = 230, 400, 52
_PLUS_X, _MINUS_X, _SERVO_X = 610, 640, 740  # of the rails, and of the servos' plugs


def wiring(table: ServoTable) -> str:
    """Return the diagram as SVG: the computer, the board, its servos, their supply, the buzzer."""
    count = len(table.servos)
    bottom = _TOP + _PITCH * count
    height = bottom + 112
    pins = [_TOP + 30 + _PIN_PITCH * index for index in range(count)]
    heights = [_TOP + _PITCH * index + 10 for index in range(count)]
    parts = [_title(table), *_rails(heights[0], bottom + 20)]
    parts += _supply(bottom + 20)
    for index, (y, servo) in enumerate(zip(heights, table.servos, strict=True)):
        lane = _lane(index, pins[:count], heights)
        parts += [_wire(SIGNAL, [(_BOARD_RIGHT, pins[index]), (lane, pins[index]),
                                 (lane, y), (_SERVO_X, y)])]  # fmt: skip
        parts += _plug(y)
        parts += _servo(servo, y)
    ground = pins[-1] + _PIN_PITCH
    parts += _board(table, pins, ground)
    parts += _ground(ground, bottom + 20)
    if table.buzzer is not None:
        parts += _buzzer(table.buzzer, ground - 78)
    if table.developer_pin is not None:
        parts += _developer(table.developer_pin, ground)
    parts += _computer(_TOP + 34)
    head = (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}" '
        f'width="{_WIDTH}" height="{height}" font-family="{_FONT}">'
    )
    paper = f'<rect width="100%" height="100%" fill="{_PAPER}" />'
    return "\n".join([head, paper, *parts, "</svg>", ""])


def _lane(index: int, pins: list[int], heights: list[int]) -> int:
    """Return the x at which a signal turns, so that no two signals cross."""
    # Signals that go up turn further right the lower they are; those that go down, the reverse.
    rank = index if heights[index] < pins[index] else len(pins) - 1 - index
    return 430 + 28 * rank


def _title(table: ServoTable) -> str:
    return _text(28, 46, f"{table.name}: {len(table.servos)} servos on a Pico or an ESP32", 20, 600)


def _rails(top: int, bottom: int) -> list[str]:
    return [
        _wire(PLUS, [(_PLUS_X, top + 12), (_PLUS_X, bottom)], 4),
        _wire(MINUS, [(_MINUS_X, top + 24), (_MINUS_X, bottom)], 4),
    ]


def _plug(y: int) -> list[str]:
    return [
        _wire(PLUS, [(_PLUS_X, y + 12), (_SERVO_X, y + 12)]),
        _wire(MINUS, [(_MINUS_X, y + 24), (_SERVO_X, y + 24)]),
        _dot(_PLUS_X, y + 12, PLUS),
        _dot(_MINUS_X, y + 24, MINUS),
    ]


def _servo(servo: Servo, y: int) -> list[str]:
    x = _SERVO_X
    # The body has two ears; the horn points to the joint's zero position.
    horn = f"translate({x + 66} {y + 12}) rotate({servo.neutral - 90})"
    return [
        _box(x - 4, y + 3, 118, 18, 4, _SERVO, _SERVO_EDGE),
        _box(x + 8, y - 18, 94, 60, 6, _SERVO, _SERVO_EDGE),
        f'<g transform="{horn}"><rect x="-5" y="-26" width="10" height="32" rx="5" '
        f'fill="{_PAPER}" stroke="{_SERVO_EDGE}" stroke-width="1.4" />'
        f'<circle r="9" fill="{_PAPER}" stroke="{_SERVO_EDGE}" stroke-width="1.4" />'
        f'<circle r="2.4" fill="{_SERVO_EDGE}" /></g>',
        _text(x + 126, y + 8, servo.name, 14, 600),
        _text(x + 126, y + 27, f"{servo.low}° … {servo.high}°".replace("-", "−"), 12, colour=_SOFT),
    ]


def _board(table: ServoTable, pins: list[int], ground: int) -> list[str]:
    x, width, top = _BOARD_LEFT, _BOARD_RIGHT - _BOARD_LEFT, _TOP - 6
    height = ground - top + 34
    parts = [
        _box(x, top, width, height, 10, _BOARD, _BOARD_EDGE),
        _box(x + 52, top + height // 2 - 33, 66, 66, 4, "#24313a", "#18222a"),
        _text(x + width // 2, top + height + 24, "Pico or ESP32", 14, 600, "middle"),
    ]
    for y, servo in zip(pins, table.servos, strict=True):
        parts += _pin(_BOARD_RIGHT - 10, y, str(servo.pin))
    return parts + _pin(_BOARD_RIGHT - 10, ground, "GND")


def _pin(x: int, y: int, label: str) -> list[str]:
    left = x < (_BOARD_LEFT + _BOARD_RIGHT) // 2
    at, anchor = (x + 14, "start") if left else (x - 14, "end")
    return [
        f'<circle cx="{x}" cy="{y}" r="6" fill="#f1d36b" stroke="{_BOARD_EDGE}" />',
        _text(at, y + 5, label, 13, 600, anchor, "#ffffff"),
    ]


def _ground(y: int, bottom: int) -> list[str]:
    # Without a common ground the signals have no return path, and the servos twitch.
    turn, meet = 585, bottom - 18
    points = [(_BOARD_RIGHT - 4, y), (turn, y), (turn, meet), (_MINUS_X, meet)]
    return [
        _wire(MINUS, points),
        _dot(_MINUS_X, meet, MINUS),
        _text(turn - 14, meet + 2, "one ground for all", 12, 400, "end", _SOFT),
    ]


def _buzzer(pin: int, y: int) -> list[str]:
    x, edge = 84, _BOARD_LEFT + 10
    return [
        _wire(SIGNAL, [(edge - 6, y), (x, y)]),
        _wire(MINUS, [(edge - 6, y + 39), (x, y + 39), (x, y)]),
        f'<circle cx="{x}" cy="{y}" r="26" fill="#333c44" stroke="#1c2329" stroke-width="1.4" />',
        f'<circle cx="{x}" cy="{y}" r="5" fill="{_LINE}" />',
        _text(x, y - 36, "buzzer", 14, 600, "middle"),
        *_pin(edge, y, str(pin)),
        *_pin(edge, y + 39, "GND"),
    ]


def _developer(pin: int, y: int) -> list[str]:
    edge = _BOARD_LEFT + 10
    return [
        f'<path d="M{edge - 6} {y} H196" fill="none" stroke="{_LINE}" stroke-width="2" '
        'stroke-dasharray="5 4" />',
        _text(188, y + 4, "to GND: does not start", 12, 400, "end", _SOFT),
        *_pin(edge, y, str(pin)),
    ]


def _supply(y: int) -> list[str]:
    x, width = 560, 150
    return [
        _box(x, y, width, 64, 8, "#f4ede1", "#b59f78"),
        _text(_PLUS_X, y + 20, "+", 16, 700, "middle", PLUS),
        _text(_MINUS_X, y + 20, "−", 16, 700, "middle", MINUS),
        _text(x + width // 2, y + 48, "5 V, 4 A", 14, 600, "middle"),
        _text(x + width + 16, y + 28, "for the servos alone:", 12, colour=_SOFT),
        _text(x + width + 16, y + 45, "never from the board’s 5 V pin", 12, colour=_SOFT),
    ]


def _computer(y: int) -> list[str]:
    return [
        _wire(_SOFT, [(128, y + 28), (_BOARD_LEFT, y + 28)], 6),
        _box(_BOARD_LEFT - 14, y + 16, 30, 24, 3, "#c9d1d8", "#8794a0"),
        _box(28, y - 18, 100, 68, 6, "#eef2f5", _LINE),
        _box(36, y - 10, 84, 52, 3, "#24313a", "#18222a"),
        f'<path d="M16 {y + 58} H140 L132 {y + 68} H24 Z" fill="#c9d1d8" stroke="{_LINE}" />',
        _text(78, y + 92, "computer", 14, 600, "middle"),
        _text(172, y + 16, "USB", 12, 400, "middle", _SOFT),
    ]


def _wire(colour: str, points: list[tuple[int, int]], width: int = 3) -> str:
    path = "M" + " L".join(f"{x} {y}" for x, y in points)
    common = 'fill="none" stroke-linejoin="round"'
    # A white border shows which of two crossing wires passes over the other.
    return (
        f'<path d="{path}" {common} stroke="{_PAPER}" stroke-width="{width + 4}" />'
        f'<path d="{path}" {common} stroke="{colour}" stroke-width="{width}" />'
    )


def _dot(x: int, y: int, colour: str) -> str:
    return f'<circle cx="{x}" cy="{y}" r="4.5" fill="{colour}" />'


def _box(x: int, y: int, width: int, height: int, radius: int, fill: str, edge: str) -> str:
    return (
        f'<rect x="{x}" y="{y}" width="{width}" height="{height}" rx="{radius}" '
        f'fill="{fill}" stroke="{edge}" stroke-width="1.4" />'
    )


def _text(
    x: int,
    y: int,
    text: str,
    size: int,
    weight: int = 400,
    anchor: str = "start",
    colour: str = _INK,
) -> str:
    return (
        f'<text x="{x}" y="{y}" font-size="{size}" font-weight="{weight}" '
        f'text-anchor="{anchor}" fill="{colour}">{escape(text)}</text>'
    )


if __name__ == "__main__":
    PICTURE.write_text(wiring(ServoTable(servos)), "utf-8")
