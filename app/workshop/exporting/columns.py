"""What is exported: the tables, their columns, and what each column means.

This is the one place that names them: files, data dictionary and docs/exporting.md are made of it.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cubeling.app.pipeline.table.acts import Act
from cubeling.app.session import SessionFile, SessionOptions
from cubeling.app.session.acts import WizardAct, act_words
from cubeling.app.session.encoding import INPUTS_TOPIC
from cubeling.app.workshop.exporting.column import Cell, Column, Table, field, vector
from cubeling.app.workshop.moods import read_robot_traces
from cubeling.characters import CharacterCommand, PosedCharacter
from cubeling.characters.motion import rotations
from cubeling.tracking import CubeState
from cubeling.tracking.appearance import Appearance, HandMask


def _cube_place(state: CubeState) -> NDArray[np.float64] | None:
    return None if state.camera_from_cube is None else state.camera_from_cube[:3, 3]


def _cube_rotation(state: CubeState) -> NDArray[np.float64] | None:
    if state.camera_from_cube is None:
        return None
    return rotations.from_matrix(state.camera_from_cube[:3, :3])


def _of_hand(value: Callable[[HandMask], Cell]) -> Callable[[Appearance], Cell]:
    """Return what takes a cell from the hand; empty where there is none."""
    return lambda seen: None if seen.hand is None else value(seen.hand)


def _area(hand: HandMask) -> float:
    return float(hand.share.sum()) / 255.0 * hand.scale**2


def _of_light(name: str) -> Callable[[Appearance], Cell]:
    """Return what takes a vector from the light; None until it was measured."""
    return lambda seen: None if seen.light is None else getattr(seen.light, name)


def _target(command: CharacterCommand) -> NDArray[np.float64] | None:
    return None if command.locomotion is None else command.locomotion.target


def _yaw(posed: PosedCharacter) -> float:
    place = posed.table_from_character
    return math.atan2(place[0, 2], place[2, 2])


def read_robot(session: SessionFile) -> Iterator[tuple[float, Any]]:
    """Yield what the robot was asked, answered and showed, with its times [s]."""
    for event in read_robot_traces(session.path).events:
        yield event.time, event


@dataclass(frozen=True)
class ToldAct:
    """Something that a wizard or another program told a character to do."""

    act: Act
    """What it was told."""

    name: str
    """The same in words."""

    noted: WizardAct | None
    """What the wizard's desk says of it; None for another program's."""


def read_acts(session: SessionFile) -> Iterator[tuple[float, ToldAct]]:
    """Yield what the characters were told to do, with the times [s] of the frames."""
    noted = {each.number: each for each in session.wizard_acts}
    for time, inputs in sorted(session.inputs.items()):
        for act in inputs.acts:
            if act.note is None:
                yield time, ToldAct(act, act_words(act), None)
            elif act.kind not in ("cue", "undo"):  # they are columns of the act
                yield time, ToldAct(act, act_words(act), noted[act.note.number])


def read_marks(session: SessionFile) -> Iterator[tuple[float, Any]]:
    """Yield the marked moments, with their times [s]."""
    first = session.first_time
    for mark in session.marks:
        yield first + mark.at_s, mark


CAMERA_AXES = ("to the right", "down", "forward")
"""Axes of the camera frame, as in OpenCV."""

COLOUR_NAMES = ("red", "green", "blue")


def played(
    name: str, meaning: str, asked: Callable[[SessionOptions], Cell] = lambda options: None
) -> Column:
    """Return a column of what was played; for older sessions, of what was asked for."""
    return Column(
        name,
        "",
        f"{meaning}; empty for older sessions, which do not say it",
        lambda info: info.played.get(name) or asked(info.options),
    )


CONTEXT_COLUMNS = (
    Column("session", "", "Name of the session's file, without its suffix", lambda row: row[0]),
    Column("participant", "", "Code of who played", lambda row: row[1]),
    Column("condition", "", "The condition of the study", lambda row: row[2]),
    Column("time_s", "s", "Time of the frame by the camera's clock", lambda row: row[3]),
)
"""The first columns of every table but `sessions`."""

SESSION_CONTEXT_COLUMNS = CONTEXT_COLUMNS[:-1]
"""The first columns of the table `sessions`, which has no time."""

SESSION_COLUMNS = (
    field("scenario", "", "Name of the scenario", "options.scenario"),
    played("cube", "The cube", lambda options: options.cube),
    played("cube_folded", "Dictionary, size and faces of the cubes, in JSON"),
    played("character", "The character", lambda options: options.character),
    played(
        "others", "The rest of the cast, a line each", lambda options: "\n".join(options.others)
    ),
    played("character_sha256", "SHA-256 of the characters' files, a line each"),
    played("personality", "The personality", lambda options: options.personality),
    played("controller", "What moved the character", lambda options: options.controller),
    played(
        "turns",
        "Full turns of the cube from the least to the greatest intensity",
        lambda options: f"{options.turns:g}",
    ),
    played("lens", "Whose lens the camera has; its numbers are in the session"),
    played("robot", "URL of the robot, a line each"),
    played("driver", "Its protocol, a line each"),
    played("language", "Code of the language at the beginning; empty for silence"),
    played("voice", "The voice; empty for silence"),
    played("seeds", "The seed of each character, in JSON"),
    played("version", "Version of Cubeling"),
    played("libraries", "Versions of its libraries"),
    played("machine", "System and Python"),
    field("notes", "", "What the experimenter noted", "labels.notes"),
    field("frames", "", "Camera frames"),
    field("duration_s", "s", "From the first to the last camera frame", "duration"),
    field(
        "clock_zero_utc",
        "",
        "Date and time at which time_s was 0, in UTC by ISO 8601; empty if the camera was not live",
        "clock_zero",
    ),
)
"""The columns of the table `sessions`, which has a row for each session."""

EXPORT_TABLES = (
    Table(
        "poses",
        "/cube/state",
        (
            field("visible", "", "1 if the cube was found and its pose is trusted"),
            field("verdict", "", "trusted, unseen, or why the pose was refused"),
            *vector(
                ("x_m", "y_m", "z_m"),
                "m",
                [f"Centre of the cube in the camera frame, {axis}" for axis in CAMERA_AXES],
                _cube_place,
            ),
            *vector(
                ("qx", "qy", "qz", "qw"),
                "",
                [f"Unit quaternion from the cube to the camera frame, {part}" for part in "xyzw"],
                _cube_rotation,
            ),
            *vector(
                ("vx_m_s", "vy_m_s", "vz_m_s"),
                "m/s",
                [f"Velocity of the cube's centre, {axis}" for axis in CAMERA_AXES],
                lambda state: state.velocity[:3],
            ),
            *vector(
                ("wx_rad_s", "wy_rad_s", "wz_rad_s"),
                "rad/s",
                [f"Angular velocity about the axis {axis}" for axis in CAMERA_AXES],
                lambda state: state.velocity[3:],
            ),
            field("reprojection_error_px", "px", "Root mean square residual of the pose",
                   "reprojection_error"),
            field("measured_on", "", "markers, image or predicted", "source"),
            field("faces", "", "Faces whose markers were used", nested=True),
        ),
    ),
    Table(
        "controls",
        "/cube/controls",
        (
            field("visible", "", "1 if the cube is seen; else the last values are repeated"),
            field("top_face", "", "Name of the face that points up"),
            field("heading_rad", "rad", "Direction of the forward side, clockwise from above; "
                   "0 towards the camera", "heading"),
            field("camera_angle_rad", "rad", "Angle between the forward side and the camera",
                   "camera_angle"),
            field("turns", "turns", "Turns since the cube was placed, clockwise from above"),
            field("resting", "", "1 if the cube rests on the table"),
            field("placed", "", "1 in the frame in which the cube comes to rest"),
            field("lifted", "", "1 if the cube is off the table or tipped"),
            *vector(
                ("x_m", "z_m"),
                "m",
                ("Centre of the cube on the table, to the right",
                 "Centre of the cube on the table, towards the camera"),
                lambda controls: controls.position,
            ),
            field("placements", "", "How often the cube has been placed so far"),
            field("shaken", "", "1 in the frame in which a shake is recognised"),
            field("gestures", "", "Gestures recognised in this frame", nested=True),
        ),
    ),
    Table(
        "appearances",
        "/picture/appearance",
        (
            Column("hand", "", "1 if a hand is in front of the cube",
                   lambda seen: seen.hand is not None),
            Column("hand_x_px", "px", "Left edge of the part of the picture that the hand covers; "
                   "as the next ones, empty without a hand", _of_hand(lambda hand: hand.x)),
            Column("hand_y_px", "px", "Its upper edge", _of_hand(lambda hand: hand.y)),
            Column("hand_width_px", "px", "Its width",
                   _of_hand(lambda hand: hand.share.shape[1] * hand.scale)),
            Column("hand_height_px", "px", "Its height",
                   _of_hand(lambda hand: hand.share.shape[0] * hand.scale)),
            Column("hand_area_px", "px²", "What the hand covers near the cube", _of_hand(_area)),
            *vector(
                ("behind_x_m", "behind_y_m", "behind_z_m"),
                "m",
                [f"Nearest point of the cube that the hand hides, in the camera frame, {axis}"
                 for axis in CAMERA_AXES],
                _of_hand(lambda hand: hand.behind),
            ),
            *vector(
                ("light_x", "light_y", "light_z"),
                "",
                [f"Unit vector towards the key light in the camera frame, {axis}; "
                 "empty until it was measured" for axis in CAMERA_AXES],
                _of_light("to_light"),
            ),
            *vector(
                ("key_r", "key_g", "key_b"),
                "",
                [f"Irradiance of the key light, linear {colour}; 1 makes white just white"
                 for colour in COLOUR_NAMES],
                _of_light("key"),
            ),
            *vector(
                ("ambient_r", "ambient_g", "ambient_b"),
                "",
                [f"Irradiance from all around, linear {colour}" for colour in COLOUR_NAMES],
                _of_light("ambient"),
            ),
            field("light_certainty", "", "How well the direction of the light is known, 0 to 1",
                   "light.certainty"),
            field("blur_px", "px", "Standard deviation of the blur of sharp edges; as the next "
                   "ones, empty until a still cube was measured", "softness.blur"),
            field("noise", "", "Standard deviation of a pixel's noise, grey values of 0 to 255",
                   "softness.noise"),
            field("haze", "", "Share of the light of paper that glare adds to everything",
                   "softness.haze"),
            field("paper", "", "Light of the paper, linear; 1 is the brightest white",
                   "softness.paper"),
        ),
    ),
    Table(
        "commands",
        "/character/command",
        (
            field("visible", "", "1 if the character is drawn"),
            field("activity", "", "The action, or move or idle"),
            field("weight", "", "Intensity of the action, −1 to 1"),
            field("speed", "", "AvatAR's Speed that is asked for, 0 to 5"),
            Column("said", "", "What the character says in this frame; empty for nothing",
                   lambda command: command.speech.utterance.text if command.speaks else None),
            *vector(
                ("target_x_m", "target_z_m"),
                "m",
                ("Where to go on the table, to the right",
                 "Where to go on the table, towards the camera"),
                _target,
            ),
        ),
    ),
    Table(
        "characters",
        "/character/pose",
        (
            field("visible", "", "1 if the character is drawn"),
            field("state", "", "idle, walk, run, hop, or the action"),
            field("speed", "", "AvatAR's Speed that is used, 0 to 5"),
            field("weight", "", "Intensity in use, −1 to 1"),
            *vector(
                ("x_m", "z_m"),
                "m",
                ("Where the character stands on the table, to the right",
                 "Where it stands on the table, towards the camera"),
                lambda posed: posed.table_from_character[[0, 2], 3],
            ),
            Column("yaw_rad", "rad", "Its heading about the upward axis; 0 towards the camera",
                   _yaw),
            field("joint_translations", "m", "Of each joint in its parent, [x, y, z]",
                   "pose.translations", nested=True),
            field("joint_rotations", "", "Of each joint in its parent, quaternion [x, y, z, w]",
                   "pose.rotations", nested=True),
            field("morphs", "", "Weights of the morph targets; empty for none", "pose.morphs",
                   nested=True),
        ),
    ),
    Table(
        "emotions",
        "/robot/emotion",
        (
            field("valence", "", "From unpleasant, −1, to pleasant, 1", "emotion.valence"),
            field("arousal", "", "From calm, −1, to excited, 1", "emotion.arousal"),
            field("label", "", "The word for the emotion", "emotion.label"),
        ),
    ),
    Table(
        "robot",
        "/robot/wire",
        (
            field("what", "", "commanded, acknowledged or observed for an emotion; asked, taken or "
                   "refused for an action"),
            *vector(("valence", "arousal"), "", ("From unpleasant, −1, to pleasant, 1; empty for "
                    "an action", "From calm, −1, to excited, 1"), lambda event: event.emotion),
            field("name", "", "The mood's or the action's name, if the robot gave one"),
            field("number", "", "Number of the command, which its answer repeats"),
            field("reason", "", "Why it was refused"),
        ),
        read_robot,
    ),
    Table(
        "acts",
        INPUTS_TOPIC,
        (
            Column("by", "", "wizard, or program for another program",
                   lambda told: "program" if told.noted is None else "wizard"),
            field("who", "", "Who of the cast did it; empty for the first", "act.who"),
            field("kind", "", "action, gesture, say, emotion, go, or play for the robot; "
                   "a program's undo", "act.kind"),
            field("name", "", "The action, gesture, text, emotion or place, or release"),
            field("weight", "", "Intensity of an action, −1 to 1", "act.weight"),
            field("number", "", "Of the wizard's act in its session; as the next ones, empty for a "
                   "program's", "noted.number"),
            field("cue", "", "The cue that it answers; empty for none", "noted.cue"),
            field("delay_s", "s", "Time from the cue to the act at the desk", "noted.delay_s"),
            field("undone", "", "1 if the wizard took it back as an error", "noted.undone"),
        ),
        read_acts,
    ),
    Table(
        "marks",
        "/events",
        (
            field("at_s", "s", "When, from the first frame"),
            field("kind", "", "The digit that was pressed, or the type that was given"),
            field("name", "", "What it is"),
        ),
        read_marks,
    ),
    Table(
        "events",
        "/events",
        (Column("event", "", "placed FACE, shaken, start over, cube opened or closed, camera lost, "
                "camera back, robot lost, robot back", lambda event: event.get("event")),),
    ),
)  # fmt: skip
"""The tables besides `sessions`."""


def dictionary_rows() -> Iterator[tuple[str, str, str, str, str]]:
    """Yield (table, column, unit, files, meaning) for every column of every table."""
    for name, columns in (
        ("sessions", SESSION_CONTEXT_COLUMNS + SESSION_COLUMNS),
        *((table.name, CONTEXT_COLUMNS + table.columns) for table in EXPORT_TABLES),
    ):
        for column in columns:
            files = "jsonl" if column.nested else "csv, jsonl"
            yield name, column.name, column.unit, files, column.meaning
