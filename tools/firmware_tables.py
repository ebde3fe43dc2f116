"""Generate the tables of the firmware.

`python -m tools.firmware_tables` writes `dino/messages.py` (from `cubeling.robot.protocol`) and
`dino/motions.py` (from the simulated dinosaur). A test compares them with their sources.
"""

from pathlib import Path

from cubeling.affect.hysteresis import ANGRY_BELOW, HAPPY_ABOVE
from cubeling.robot.contract.motions import JointSine, SineMotion
from cubeling.robot.protocol import messages as m, timing
from cubeling.robot.protocol.fields import FieldSpec
from cubeling.robot.protocol.schema import HEADER, MESSAGES, MessageSpec, spec_of
from cubeling.robot.protocol.wire import MAX_BODY, MAX_FRAME
from cubeling.robot.simulators.cubeling import dinosaur

BOARD = Path(__file__).parents[1] / "robot" / "firmware" / "dino"
"""The folder that is copied to the board."""

HYSTERESIS = 0.05
"""Hysteresis of the moods; a test compares it with `next_label`."""

TURN = 1024
"""Entries of the firmware's sine table; a power of two."""

_TIMES = ("STATE_EVERY", "FAILSAFE_AFTER", "GONE_EVERY", "LOG_EVERY")


def messages() -> str:
    """Return the text of `messages.py`: numbers, layouts, limits and times."""
    specs = [MESSAGES[number] for number in sorted(MESSAGES)]
    lines = [
        '"""The protocol in numbers, generated from robot/protocol by tools.firmware_tables."""',
        "",
        "# Do not edit: a test compares. Times are in ms.",
        "# fmt: off",
        f"VERSION = {timing.VERSION}",
        f"MAX_BODY = {MAX_BODY}",
        f"MAX_FRAME = {MAX_FRAME}",
        *(f"{name} = {round(1000 * getattr(timing, name))}" for name in _TIMES),
        *(f"{name} = {value}" for name, value in m.constants().items()),
        *(f"{spec.name} = 0x{spec.number:02X}" for spec in specs),
        "",
        "# number: (layout, bytes in version 1, (bytes, defaults) of the fields that each later",
        "#          version added, (place, lowest, highest) of the fields with limits)",
        "FROM_HOST: dict[",
        "    int, tuple[str, int, tuple[tuple[int, bytes], ...], tuple[tuple[int, int, int], ...]]",
        "] = {",
        *(_host_row(spec) for spec in specs if spec.sender == "host"),
        "}",
        "",
        "# number: (layout, (version, bytes) of each version that added fields)",
        "FROM_ROBOT: dict[int, tuple[str, tuple[tuple[int, int], ...]]] = {",
        *(_robot_row(spec) for spec in specs if spec.sender == "robot"),
        "}",
        "",
        *_count_lines(),
    ]
    return "\n".join(lines)


def motions() -> str:
    """Return the text of `motions.py`: the joints' movements in each mood and action."""
    lines = [
        '"""The motions, generated from the simulated robot by tools.firmware_tables."""',
        "",
        "# Do not edit: a test compares.",
        "# fmt: off",
        f"TURN = {TURN}",
        f"MOODS = {len(dinosaur.MOOD_LOOPS)}",
        f"HAPPY_ABOVE = {round(1e4 * HAPPY_ABOVE)}",
        f"ANGRY_BELOW = {round(1e4 * ANGRY_BELOW)}",
        f"HYSTERESIS = {round(1e4 * HYSTERESIS)}",
        "",
        "# (name, ms of one round, sound of a mood or None, (joint, offset and amplitude in",
        "# 1/100 degree, cycles in a round, start in 1/1024 cycle)); the moods' loops come first.",
        "MOTIONS: tuple[",
        "    tuple[str, int, str | None, tuple[tuple[str, int, int, int, int], ...]], ...",
        "] = (",
        *(line for motion in dinosaur.MOTIONS for line in _motion_lines(motion)),
        ")",
        "",
    ]
    return "\n".join(lines)


def _host_row(spec: MessageSpec) -> str:
    places = [(place, field) for place, field in enumerate(spec.fields, start=2)]
    limits = [
        f"({place}, {_count(field, field.low, 0)}, {_count(field, field.high, 1)})"
        for place, field in places
        if field.low is not None or field.high is not None
    ]
    later = [f"({part.end}, {_defaults(spec, part.since)!r})" for part in spec.parts[1:]]
    layout = f'"{_layout(spec)}", {spec.size}, {_tuple(later)}'
    return f"    0x{spec.number:02X}: ({layout},\n           {_tuple(limits)}),"


def _robot_row(spec: MessageSpec) -> str:
    sizes = [f"({part.since}, {part.end})" for part in spec.parts]
    return f'    0x{spec.number:02X}: ("{_layout(spec)}", {_tuple(sizes)}),'


def _layout(spec: MessageSpec) -> str:
    return HEADER.format + "".join(part.layout.format[1:] for part in spec.parts)


def _defaults(spec: MessageSpec, since: int) -> bytes:
    (part,) = [part for part in spec.parts if part.since == since]
    defaults = {name: field.default for name, field in spec.kind.__dataclass_fields__.items()}
    counts = [one for field in part.fields for one in field.to_wire(defaults[field.name])]
    return part.layout.pack(*counts)


def _count(field: FieldSpec, limit: float | None, highest: int) -> int:
    """Return a limit in counts; the limit of the wire type where the field has none."""
    if limit is not None:
        return round(limit / field.scale)
    return {"u8": (0, 255), "u16": (0, 65535), "u32": (0, 2**32 - 1), "i16": (-32768, 32767)}[
        field.wire_type
    ][highest]


def _tuple(items: list[str]) -> str:
    return f"({', '.join(items)}{',' if len(items) == 1 else ''})"


def _count_lines() -> list[str]:
    """Return the lines of the limits of a catalogue."""
    limits = {field.name: field.high for field in spec_of(m.Welcome).fields}
    kinds = ("motions", "sounds", "moods")
    highest = {limits[kind] for kind in kinds}
    (most,) = highest
    assert most is not None
    name_bytes, log_bytes = (spec_of(kind).fields[-1].size for kind in (m.Name, m.Log))
    return [
        f"ENTRIES_MAX = {most:.0f}",
        f"NAME_BYTES = {name_bytes}",
        f"LOG_BYTES = {log_bytes}",
        "",
    ]


def _motion_lines(motion: SineMotion) -> list[str]:
    sound = "None" if motion.sound is None else f'"{motion.sound}"'
    return [
        f'    ("{motion.name}", {round(1000 * motion.period)}, {sound}, (',
        *(f"        {_sine(joint, sine)}," for joint, sine in motion.joints.items()),
        "    )),",
    ]


def _sine(joint: str, sine: JointSine) -> str:
    offset, amplitude = round(100 * sine.offset), round(100 * sine.amplitude)
    return f'("{joint}", {offset}, {amplitude}, {sine.cycles}, {round(TURN * sine.phase) % TURN})'


if __name__ == "__main__":
    (BOARD / "messages.py").write_text(messages(), "utf-8")
    (BOARD / "motions.py").write_text(motions(), "utf-8")
