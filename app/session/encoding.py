"""Encoding the messages of the pipeline, which are frozen dataclasses, as JSON with schemas."""

import base64
import dataclasses
import json
import struct
import types
import typing
from typing import Any, TypeVar

import cv2
import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.scenario import EmotionTarget
from cubeling.characters import CharacterCommand, Pose, PosedCharacter
from cubeling.characters.speech import Samples
from cubeling.tracking import CubeControls, CubeState
from cubeling.tracking.appearance import Appearance

T = TypeVar("T")

SESSION_RECORD, FORMAT_KEY = "cubeling", "format"
"""Name of a session's metadata, and the key of the version of its format."""

SESSION_FORMAT = 1
"""The version of the format that is written: all that changed it stands in `_upgrade_content`."""

PART_KEY, FIRST_PART_KEY = "part", "first_part"
"""Keys of a part of a recording but the first: its number, and the file that it began with."""

PLAYED_RECORD = "cubeling played"
"""Name of a session's metadata that say what is played, resolved."""

CLOCK_RECORD, CLOCK_ZERO = "cubeling clock", "zero_utc"
"""Name of a live session's metadata, and their key: when its timestamps were 0, by ISO 8601."""

IMAGE_TOPIC = "/camera/image"
"""The channel of the camera's frames."""

INPUTS_TOPIC = "/inputs"
"""The channel of what came in with a frame next to its picture."""

LINE_TOPIC = "/audio/line"
"""The channel of what the character says: a message with the sound in the frame in which a line
begins. The inputs of that frame hold the words."""


def line_topic(name: str) -> str:
    """Return the channel of the sound of one of the cast, by its name as `Lines` have it.

    >>> line_topic(""), line_topic("vleo")
    ('/audio/line', '/cast/vleo/line')
    """
    return f"/cast/{name}/line" if name else LINE_TOPIC


def sound_topic(name: str) -> str:
    """Return the channel of a sound that a scenario plays, by its name.

    >>> sound_topic("wind.ogg")
    '/audio/sounds/wind.ogg'
    """
    return f"/audio/sounds/{name}"


MAX_MASK_PX = 1 << 24
"""Most pixels of a mask in a message; that of a hand is smaller than the camera's picture."""

_FULL_SCALE = 32767  # the largest sample of 16 bits
_NOISE = 1e-9  # the greatest number of a pose that counts as zero; 1 is exact to 6e-8

MESSAGE_TYPES: dict[str, type[Any]] = {
    "/cube/state": CubeState,
    "/cube/controls": CubeControls,
    "/character/command": CharacterCommand,
    "/character/pose": PosedCharacter,
    "/robot/emotion": EmotionTarget,
}
"""The type of the messages on each channel that every session has."""

APPEARANCE_TOPIC = "/picture/appearance"
"""The channel of what the pictures tell beside the cube's pose, where pictures were drawn."""

CHANNEL_TYPES: dict[str, type[Any]] = {**MESSAGE_TYPES, APPEARANCE_TOPIC: Appearance}
"""The type of the messages on each channel between camera and picture."""

CAST_TYPES: dict[str, type[Any]] = {
    "command": CharacterCommand,
    "pose": PosedCharacter,
    "emotion": EmotionTarget,
}
"""The type of the messages of each further character, whose channels are /cast/NAME/PART, by the
last part."""


PLAYER_TYPES: dict[str, type[Any]] = {"state": CubeState, "controls": CubeControls}
"""The same of each further player, whose channels are /cubes/NAME/PART."""

ROBOT_TYPES: dict[str, type[Any]] = {"emotion": EmotionTarget}
"""The same of each further player's robot, whose channels are /robots/NAME/PART."""

WIRE_TOPIC = "/robot/wire"
"""The channel of the bytes of the robot's line; those of a further one are on /robots/NAME/wire."""

FOLDER_TYPES = {"cast": CAST_TYPES, "cubes": PLAYER_TYPES, "robots": ROBOT_TYPES}
"""The types of the messages in each folder of channels /FOLDER/NAME/PART."""


def message_type(topic: str) -> type[Any] | None:
    """Return the type of the messages on a channel between camera and picture; None for others.

    >>> message_type("/cast/vleo/pose").__name__
    'PosedCharacter'
    """
    _, folder, *name, part = topic.split("/") if topic.count("/") > 1 else ("", "", topic)
    return FOLDER_TYPES.get(folder, {}).get(part) if name else CHANNEL_TYPES.get(topic)


def encode(message: object) -> bytes:
    """Return a dataclass as JSON; numbers keep every bit, and NaN becomes null.

    Arrays of bytes, as the share of a picture that a hand covers, are PNG files in base64.

    Joints (`Pose`) are rounded to single precision, as on the graphics card, and what is only noise
    of rounding to zero: it is not the same with every processor.
    """
    return json.dumps(_plain(message), separators=(",", ":"), allow_nan=False).encode()


def decode(kind: type[T], document: bytes) -> T:
    """Return the dataclass that `encode` wrote; ValueError if it is no JSON or not of that type."""
    try:
        value = _value_of(kind, _upgrade_content(kind, json.loads(document)))
    except (KeyError, TypeError, AttributeError) as error:
        raise ValueError(f"not a {kind.__name__}: {error}") from error
    return typing.cast(T, value)


def encode_sound(samples: Samples) -> bytes:
    """Return sound, (n,), as samples of 16 bits."""
    return np.round(np.clip(samples, -1.0, 1.0) * _FULL_SCALE).astype("<i2").tobytes()


def decode_sound(data: bytes) -> Samples:
    """Return the sound that `encode_sound` wrote."""
    return np.frombuffer(data, "<i2").astype(np.float32) / np.float32(_FULL_SCALE)


def decode_sound_message(data: bytes) -> tuple[int, Samples]:
    """Return sample rate [Hz] and sound of a message; raises ValueError for another one."""
    from foxglove_schemas_protobuf.RawAudio_pb2 import RawAudio
    from google.protobuf.message import DecodeError

    try:
        audio = RawAudio.FromString(data)
    except DecodeError as error:
        raise ValueError(error) from None
    return audio.sample_rate, decode_sound(audio.data)


def upgrade(topic: str, document: bytes) -> bytes:
    """Return a channel's document as this version writes it, whichever version wrote it.

    A document that no version wrote is returned as it is.
    """
    kind = message_type(topic)
    if kind is None:
        return document
    try:
        content = json.loads(document)
        newer = _upgrade_content(kind, content)
        same = newer is content and kind is not PosedCharacter  # whose rounding got coarser
        return document if same else encode(_value_of(kind, newer))
    except (ValueError, KeyError, TypeError, AttributeError):
        return document


def schema(kind: type[Any]) -> bytes:
    """Return the JSON Schema of a dataclass."""
    return json.dumps({"title": kind.__name__, **_schema(kind)}, separators=(",", ":")).encode()


def _upgrade_content(kind: type[Any], content: Any) -> Any:
    """Return the content of a document in today's fields.

    Before `affect.Emotion` held its word, an emotion had a label next to it, and the intents of a
    command were single fields, of which the oldest sessions lack some. A shake was a field of its
    own among the controls. All that was before sessions held the version of their format: these
    fields tell the versions apart. Before a profile had `liveliness`, a speech moved only arms and
    head; so it does in a replay. Before there was a cast, no obstacle was alive. Before there were
    24 emotions, none had an intensity. Before there was a map of the room, no appearance had one.
    """
    if kind is Appearance and "room" not in content:
        content = {**content, "room": None}
    boxes = content.get("obstacles")
    if boxes and "alive" not in boxes[0]:  # before there was a cast
        content = {**content, "obstacles": [{**each, "alive": False} for each in boxes]}
    speech = content.get("speech")
    if isinstance(speech, dict) and "liveliness" not in speech.get("profile", {"liveliness": 0}):
        still = {**speech["profile"], "liveliness": 0.0}
        content = {**content, "speech": {**speech, "profile": still}}
    if kind is CubeControls and "shaken" in content:
        controls = {key: value for key, value in content.items() if key != "shaken"}
        return {**controls, "gestures": ["shaken"] if content["shaken"] else []}
    if kind is EmotionTarget and "label" in content:
        emotion = {**content["emotion"], "word": content["label"]}
        content = {"emotion": emotion, "timestamp": content["timestamp"]}
    emotion = content.get("emotion")
    if isinstance(emotion, dict) and "word" in emotion and "intensity" not in emotion:
        content = {**content, "emotion": {**emotion, "intensity": None}}
    if kind is CharacterCommand and isinstance(content.get("action"), str):
        return _upgrade_command(content)
    if kind is CharacterCommand and "behaviour" not in content:  # before hands reached
        return {"speech": None, **content, "behaviour": None}
    return content


def _upgrade_command(old: dict[str, Any]) -> dict[str, Any]:
    """Return a command with intents from one whose intents are single fields."""
    going = {"speed": "speed", "target": "target", "stop": "stop", "look_at": "facing"}
    command: dict[str, Any] = {
        key: old[key] for key in ("timestamp", "gaze", "visible") if key in old
    }
    command["locomotion"] = {new: old[key] for key, new in going.items() if key in old}
    if old["action"] != "move":
        command["action"] = {"name": old["action"], "weight": old.get("weight", 0.0)}
    if old.get("feeling") is not None:
        valence, arousal = old["feeling"]
        word = old.get("mood") or None
        command["emotion"] = {"valence": valence, "arousal": arousal, "word": word}
    return command


def _plain(value: object) -> object:
    if isinstance(value, Pose):
        fields = dataclasses.fields(value)
        return {field.name: _single(getattr(value, field.name)) for field in fields}
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        fields = dataclasses.fields(value)
        return {field.name: _plain(getattr(value, field.name)) for field in fields}
    if isinstance(value, np.ndarray):
        if value.dtype == np.uint8:
            return base64.b64encode(cv2.imencode(".png", value)[1].tobytes()).decode()
        return value.tolist() if np.isfinite(value).all() else _with_gaps(value)
    if isinstance(value, tuple | list):
        return [_plain(item) for item in value]
    if isinstance(value, float | np.floating):
        return float(value) if np.isfinite(value) else None
    if isinstance(value, np.bool_ | np.integer):
        return value.item()
    return value


def _with_gaps(array: NDArray[Any]) -> object:
    """Return nested lists with None for numbers that are not finite."""
    numbers = array.astype(object)
    numbers[~np.isfinite(array)] = None
    return numbers.tolist()


def _single(array: NDArray[Any] | None) -> object:
    """Return the shortest decimals that give the same single-precision numbers."""
    if array is None:
        return None
    single = np.where(np.abs(array) < _NOISE, 0.0, array).astype(np.float32)
    return np.array([float(str(number)) for number in single.flat]).reshape(array.shape).tolist()


def _value_of(kind: Any, value: Any) -> Any:
    if dataclasses.is_dataclass(kind):
        hints = typing.get_type_hints(kind)
        names = [field.name for field in dataclasses.fields(kind) if field.name in value]
        return typing.cast(Any, kind)(
            **{name: _value_of(hints[name], value[name]) for name in names}
        )
    origin = typing.get_origin(kind)
    if origin in (typing.Union, types.UnionType):
        choices = [choice for choice in typing.get_args(kind) if choice is not type(None)]
        return None if value is None else _value_of(choices[0], value)
    if origin is np.ndarray:
        return _mask(value) if isinstance(value, str) else _numbers(value)
    if origin is tuple:
        return tuple(_value_of(typing.get_args(kind)[0], item) for item in value)
    if kind is float:
        return value if isinstance(value, float) else float(_numbers(value))
    if kind in (bool, int, str) and type(value) is not kind:
        raise ValueError(f"{str(value)!r:.40} is no {kind.__name__}")
    if origin is typing.Literal and value not in typing.get_args(kind):
        raise ValueError(f"{str(value)!r:.40} is none of {typing.get_args(kind)}")
    return value


def _numbers(value: Any) -> NDArray[np.float64]:
    """Return numbers, with NaN for None."""
    try:
        return np.array(value, float)
    except (ValueError, TypeError):
        raise ValueError(f"{str(value)!r:.40} is no number or array of numbers") from None


def _mask(text: str) -> NDArray[np.uint8]:
    """Return the bytes (height, width) in a PNG file in base64."""
    data = base64.b64decode(text)
    size = struct.unpack(">II", data[16:24]) if len(data) > 24 else (0, 0)  # of PNG's header
    image = None
    if 0 < size[0] * size[1] <= MAX_MASK_PX:
        image = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_GRAYSCALE)
    if image is None:
        raise ValueError("not a PNG file in base64, or too large")
    return np.asarray(image, np.uint8)


def _schema(kind: Any) -> dict[str, Any]:
    if dataclasses.is_dataclass(kind):
        hints = typing.get_type_hints(kind)
        fields = {field.name: _schema(hints[field.name]) for field in dataclasses.fields(kind)}
        return {"type": "object", "properties": fields}
    origin = typing.get_origin(kind)
    if origin in (typing.Union, types.UnionType):
        return {"anyOf": [_schema(choice) for choice in typing.get_args(kind)]}
    if kind == NDArray[np.uint8]:
        return {"type": "string", "contentEncoding": "base64", "contentMediaType": "image/png"}
    if origin is np.ndarray:
        return {"type": "array"}
    if origin is tuple:
        return {"type": "array", "items": _schema(typing.get_args(kind)[0])}
    if origin is typing.Literal:
        return {"enum": list(typing.get_args(kind))}
    names = {bool: "boolean", int: "integer", float: "number", str: "string", type(None): "null"}
    return {"type": names[kind]}
