"""Every message of the protocol; codec, document, C header and vectors come from this table."""

from dataclasses import dataclass
from typing import Final

from cubeling.robot.protocol.fields import wire_field
from cubeling.robot.protocol.schema import message

NOTHING: Final = 255
"""The index for none: no motion, no sound."""

JOINTS_MAX: Final = 16
"""Most joints of a robot in this version."""

ITEM_JOINT: Final = 0
ITEM_MOTION: Final = 1
ITEM_SOUND: Final = 2
ITEM_MOOD: Final = 3

RESULT_TAKEN: Final = 0
RESULT_REFUSED: Final = 1
"""ACK.result of a command whose index the catalogue does not have; before version 3, of all that
are refused."""
RESULT_OUT_OF_RANGE: Final = 2
RESULT_CANNOT: Final = 3
RESULT_BUSY: Final = 4
RESULT_NOT_NOW: Final = 5
RESULT_MOTORS_OFF: Final = 6
RESULT_LOW_BATTERY: Final = 7
RESULT_TOO_HOT: Final = 8

REFUSALS: Final = {
    RESULT_REFUSED: "it has no such entry",
    RESULT_OUT_OF_RANGE: "an angle is beyond its joint's limits",
    RESULT_CANNOT: "it has no means for that",
    RESULT_BUSY: "it is busy with something that it does not interrupt",
    RESULT_NOT_NOW: "it cannot at this moment",
    RESULT_MOTORS_OFF: "its motors have no power",
    RESULT_LOW_BATTERY: "its battery is low",
    RESULT_TOO_HOT: "it is too hot",
}
"""Why a command was refused, in the words that a person reads; others are "another reason"."""

SEVERITY_INFO: Final = 0
SEVERITY_WARNING: Final = 1
SEVERITY_ERROR: Final = 2
"""LOG.severity; a higher one counts as an error."""

ABILITY_MOVE: Final = 1
"""Bit of WELCOME.abilities: the robot takes MOVE."""

FLAG_CHARGING: Final = 1
"""Bit of STATE.flags: the battery is being charged."""

FLAG_STILL: Final = 2
"""Bit of STATE.flags: stopped; the robot holds its neutral pose."""

FLAG_LIMP: Final = 4
"""Bit of STATE.flags: the motors have no power; nothing moves."""

FLAG_RECKONED: Final = 8
"""Bit of STATE.flags: the joint angles are calculated, because the robot cannot measure them."""


def constants() -> dict[str, int]:
    """Return the numbers above by name, for the robots' own languages."""
    return {name: value for name, value in globals().items() if isinstance(value, int)}


# --- Messages of the host ----------------------------------------------------------------------


@message(0x01, "host", "Opens the session named in the header, or asks for its WELCOME again.")
@dataclass(frozen=True)
class Hello:
    """Opens a session, or repeats the question if the answer was lost."""

    version: int = wire_field("u8", "highest version that the host speaks", low=1)
    host: int = wire_field("u32", "who speaks: one number for the life of a host program", low=1)


@message(0x02, "host", "Asks for one entry of the robot's catalogue.")
@dataclass(frozen=True)
class Ask:
    """Asks for one entry of the catalogue."""

    item: int = wire_field("u8", "0 joint, 1 motion, 2 sound, 3 mood")
    index: int = wire_field("u8", "which one, from 0")


@message(0x03, "host", "The host is there. Answered by STATE at once.")
@dataclass(frozen=True)
class Beat:
    """Heartbeat of the host."""

    count: int = wire_field("u16", "counts up by one, and starts again at 0 after 65535")


@message(0x10, "host", "A command: feel this from now on.")
@dataclass(frozen=True)
class Express:
    """Shows an emotion until another command comes."""

    number: int = wire_field("u32", "number of the command", low=1)
    valence: float = wire_field(
        "i16", "unpleasant to pleasant", scale=1e-4, unit="1", low=-1, high=1
    )
    arousal: float = wire_field("i16", "calm to excited", scale=1e-4, unit="1", low=-1, high=1)
    mood: int = wire_field(
        "u8", "mood to show, an index; 255: the robot chooses by valence and arousal",
        since=2, default=NOTHING,
    )  # fmt: skip


@message(0x11, "host", "A command: play a motion or a sound once.")
@dataclass(frozen=True)
class Play:
    """Play a motion or a sound once."""

    number: int = wire_field("u32", "number of the command", low=1)
    item: int = wire_field("u8", "1 motion, 2 sound", low=1, high=2)
    index: int = wire_field("u8", "which one, from 0")


@message(0x12, "host", "A command: end motion and sound, feel neutral, and hold the neutral pose.")
@dataclass(frozen=True)
class Stop:
    """End everything and hold the neutral pose until the next EXPRESS or PLAY."""

    number: int = wire_field("u32", "number of the command", low=1)


@message(0x13, "host", "A command: turn single joints, and hold them.", since=3)
@dataclass(frozen=True)
class Move:
    """Turn single joints, and hold them until they are let go."""

    number: int = wire_field("u32", "number of the command", low=1)
    duration: float = wire_field("u16", "time for the way", scale=1e-3, unit="s")
    released: int = wire_field("u16", "bit i: joint i is let go")
    moved: int = wire_field("u16", "bit i: joint i goes to its angle and is held there")
    angles: tuple[float, ...] = wire_field(
        "i16x16", "in catalogue order; those of joints that are not moved have no meaning",
        scale=1e-3, unit="rad",
    )  # fmt: skip


Command = Express | Play | Stop | Move
"""The numbered messages, which are acknowledged."""


@message(0x1F, "host", "Ends the session. The robot goes to neutral at once; no answer.")
@dataclass(frozen=True)
class Bye:
    """Ends the session at once, without an answer."""


# --- Messages of the robot ---------------------------------------------------------------------


@message(0x81, "robot", "Answers HELLO: the session is open.")
@dataclass(frozen=True)
class Welcome:
    """The session is open."""

    version: int = wire_field("u8", "version to be spoken, at most the host's", low=1)
    taken: int = wire_field("u32", "last command of this host that is still in force; 0 if none is")
    catalogue: int = wire_field("u16", "any number that changes when the catalogue does")
    joints: int = wire_field("u8", "joints in the catalogue", high=JOINTS_MAX)
    motions: int = wire_field("u8", "motions in the catalogue", high=254)
    sounds: int = wire_field("u8", "sounds in the catalogue", high=254)
    moods: int = wire_field("u8", "moods in the catalogue", high=254)
    name: str = wire_field("text16", "what the robot is called")
    firmware: str = wire_field("text16", "what runs on it, and which version")
    abilities: int = wire_field("u8", "bit 0: it takes MOVE; others 0", since=3, default=0)


@message(0x82, "robot", "Answers ASK for a joint.")
@dataclass(frozen=True)
class Joint:
    """One joint of the catalogue."""

    index: int = wire_field("u8", "which one, from 0")
    low: float = wire_field("i16", "smallest angle", scale=1e-3, unit="rad")
    high: float = wire_field("i16", "largest angle", scale=1e-3, unit="rad")
    speed: float = wire_field("u16", "top speed", scale=1e-3, unit="rad/s")
    name: str = wire_field("text16", "what it is called")


@message(0x83, "robot", "Answers ASK for a motion, a sound or a mood.")
@dataclass(frozen=True)
class Name:
    """One named entry of the catalogue."""

    item: int = wire_field("u8", "1 motion, 2 sound, 3 mood", low=1, high=3)
    index: int = wire_field("u8", "which one, from 0")
    name: str = wire_field("text16", "what it is called")


@message(0x84, "robot", "The robot is there, and this is how it is.")
@dataclass(frozen=True)
class State:
    """State of the robot."""

    beat: int = wire_field("u16", "count of the last BEAT heard; 0 before the first")
    taken: int = wire_field("u32", "number of the last command taken; 0 before the first")
    flags: int = wire_field(
        "u8", "bit 0: charging; bit 1: stopped; bit 2: motors without power; bit 3: joints are "
        "reckoned from what was commanded, not measured; others 0",
    )  # fmt: skip
    valence: float = wire_field(
        "i16", "shown now, unpleasant to pleasant", scale=1e-4, unit="1", low=-1, high=1
    )
    arousal: float = wire_field(
        "i16", "shown now, calm to excited", scale=1e-4, unit="1", low=-1, high=1
    )
    battery: float = wire_field("u16", "empty to full", scale=1e-4, unit="1", low=0, high=1)
    mood: int = wire_field("u8", "mood shown now, an index")
    motion: int = wire_field("u8", "motion played now, an index; 255 none")
    sound: int = wire_field("u8", "sound played now, an index; 255 none")
    joints: tuple[float, ...] = wire_field(
        "i16x16", "angles, in catalogue order; 0 for those it does not have",
        scale=1e-3, unit="rad",
    )  # fmt: skip
    time: int = wire_field(
        "u32", "when all of this was so, by the robot's clock; 4294967295 is followed by 0",
        unit="ms", since=3, default=0,
    )  # fmt: skip
    result: int = wire_field("u8", "result of the command `taken`, as in ACK", since=3, default=0)
    held: int = wire_field("u16", "bit i: joint i is held by MOVE", since=3, default=0)


@message(0x85, "robot", "Something that a person should know. Not answered, not repeated.", since=3)
@dataclass(frozen=True)
class Log:
    """A line of the robot's log."""

    count: int = wire_field("u16", "counts up by one with every line, also one that is not sent")
    time: int = wire_field("u32", "when it was written, by the robot's clock", unit="ms")
    severity: int = wire_field("u8", "0 information, 1 warning, 2 or more error")
    text: str = wire_field("text80", "what happened, in one line")


@message(0x90, "robot", "Answers every command, also one that it has taken before.")
@dataclass(frozen=True)
class Ack:
    """Answers a command, also one that was received before."""

    number: int = wire_field("u32", "the command's number", low=1)
    result: int = wire_field("u8", "0 taken; others: refused, see section 6")


@message(0x9F, "robot", "The session in the header is not open here: greet again.")
@dataclass(frozen=True)
class Gone:
    """The session in the header is not open at the robot."""
