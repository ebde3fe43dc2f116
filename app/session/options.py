"""What the user asks of a session: the settings from the command line to the recording."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Self

from cubeling.app.errors import AppError
from cubeling.app.pipeline.choices import REALISM_CHOICES, ROBOT_NAMES, checked_players
from cubeling.app.session.codecs import NO_VIDEO
from cubeling.characters.speech import DEFAULT_PROFILE, SpeechProfile

START_STAGES = ("camera", "state", "controls", "appearance", "command", "pose", "emotion")
"""The stages that a replay can start from; each takes one channel more as recorded."""


@dataclass(frozen=True, kw_only=True)
class SessionOptions:
    """The settings of one session. They do not change once the session is open."""

    scenario: str
    """Name of the scenario."""

    source: str
    """URI of the frames, as `cubeling.tracking.open_source` takes it."""

    cubes: tuple[str, ...] = ()
    """Bundled cubes or .toml files: the one in play, then others that may come into view; () for
    the scenario's own."""

    players: int = 1
    """How many play, each with a cube: the first of `cubes`."""

    character: str | None = None
    """A bundled character or a .glb file; None for the scenario's own."""

    others: tuple[str, ...] = ()
    """The rest of the cast: bundled characters or files, at most `MAX_CAST` with the first."""

    controller: str = "tree"
    """What moves the character: one of `cubeling.characters.CONTROLLER_CHOICES`."""

    motions: tuple[str, ...] = ()
    """Files that the controller takes its motions from; none for the character's own clips."""

    idle: Path | None = None
    """The .idle file of the person as whom the character stands; None for its own idle clip."""

    own_motions_only: bool = False
    """Whether a character without clips stays in its rest pose, and plays nobody else's."""

    whole_limbs: bool = True
    """Whether a character's detached feet move with its shins; not in what was recorded before."""

    language: str | None = None
    """Code of the language in which the character speaks, or "none" for silence; None for that of
    a recording, or English in a window."""

    talk_language: str = ""
    """Code of the language in which a dialogue begins; "" for its first one."""

    model: str | None = None
    """The address of a language model, up to and with `/v1`; None for none."""

    model_name: str = "default"
    """The name by which the address knows the model."""

    asks_model: bool = False
    """Whether a dialogue waits for a model's answers: also in a replay, which asks none."""

    voice: str | None = None
    """The command of the voice; None for eSpeak NG."""

    profile: SpeechProfile = DEFAULT_PROFILE
    """How the character says it with its body; a recording holds it with each line."""

    lines: Path | None = None
    """The .toml file of what the character says; None for the scenario's own lines."""

    intrinsics: Path | None = None
    """The camera's calibration file; None to take the source's intrinsics or to guess them."""

    speed_map: str = "corrected"
    """One of `SPEED_MAP_NAMES`, for `follow` and `sketch`."""

    turns: float = 2.0
    """Full turns of the cube from the least to the greatest intensity, for `companion`."""

    personality: str | None = None
    """A bundled personality or a .toml file; None for the scenario's own."""

    look: str = "auto"
    """What the character's eyes follow: one of `LOOK_CHOICES`."""

    realism: tuple[str, ...] = tuple(REALISM_CHOICES)
    """What makes the characters look real, of `REALISM_CHOICES`."""

    inside: str = "auto"
    """When the character is inside the cube: one of `INSIDE_CHOICES`."""

    quality: str = "auto"
    """How finely characters are drawn: one of `characters.rendering.QUALITIES`, or "auto" for the
    best that holds the camera's rate. Videos are always drawn in the best, unless one is named."""

    robot: str = "sim"
    """URL of the robot, as `RobotLine.open` takes it."""

    second_robot: str = "none"
    """The same of the second player's."""

    robot_names: tuple[str, str] = ROBOT_NAMES
    """Names of the two."""

    robot_settings: Path | None = None
    """A .toml file for the robot's driver."""

    record: Path | None = None
    """The .mcap file to record the session to."""

    codec: str = "auto"
    """How a recording stores the camera's pictures: one of `CODECS`."""

    part_s: float | None = None
    """Duration of a part of a recording, then it goes on in another file [s]; None for any."""

    part_bytes: int | None = None
    """Size of such a part; None for any."""

    video_codec: str = "auto"
    """What encodes the pictures of `output`, as `app.ui.output_formats.ENCODERS` names it; "auto"
    for the usual one of its kind of video."""

    output: Path | None = None
    """The video, animation or contact sheet to write; None to open a window."""

    overwrite: bool = False
    """Whether `output` may exist; a recording is never overwritten."""

    pictures: bool = True
    """Whether pictures are drawn; what needs only numbers leaves them out."""

    appearance: bool = False
    """Whether what pictures tell of hand, light and softness is measured although none is drawn."""

    muted: bool = False
    """Whether the session is silent: nothing is heard, and a video has no sound."""

    volume: float = 0.5
    """Loudness of what is heard, and of a video's sound, 0…1."""

    sounds: Path | None = None
    """A folder of .wav files that replace our sounds; None for ours."""

    fast: bool = False
    """Whether a recording is processed as fast as possible although a real robot follows it."""

    salvage: bool = False
    """Whether a source that breaks off counts as finished."""

    stage: str = "camera"
    """The channel from which on a replay computes: one of `START_STAGES`."""

    patience_s: float = 30.0
    """How long the session goes on without a picture of a camera that was lost [s]."""

    participant: str = ""
    """Code of who plays; "" where nobody said."""

    condition: str = ""
    """The condition of the study; "" for none."""

    notes: str = ""
    """What the experimenter notes of the session."""

    start_s: float = 0.0
    """Where to start in a recording, from its first frame [s]."""

    end_s: float | None = None
    """Where to end in it [s]; None for its end."""

    loop: bool = False
    """Whether a recording in a window begins again at its end."""

    folder: Path | None = None
    """Where snapshots and recordings go that a key makes; None for `default_folder`."""

    @property
    def cube(self) -> str | None:
        """The cube in play; None for the scenario's own."""
        return self.cubes[0] if self.cubes else None

    @property
    def windowed(self) -> bool:
        """Whether the session has a window, so that a user watches it."""
        return self.pictures and self.output is None

    @property
    def keeps_scenario(self) -> bool:
        """Whether the scenario stays.

        A recording holds one, and so does a replay of its stages; a controller and an idle motion
        are prepared for the character of one, and the cubes of several players for one.
        """
        own = self.controller == "tree" and self.idle is None
        several = self.players > 1
        return self.record is not None or self.stage != "camera" or several or not own

    def metadata(self) -> dict[str, str]:
        """Return what a recording keeps of the settings: all that a replay needs."""
        source = self.source
        return {
            "scenario": self.scenario,
            "cube": self.cube or "",
            "players": str(self.players),
            "robot_names": "\n".join(self.robot_names),
            "further_cubes": "\n".join(self.cubes[1 : self.players]),
            "character": self.character or "",
            "others": "\n".join(self.others),
            "controller": self.controller,
            "motions": "\n".join(self.motions),
            "idle": "" if self.idle is None else str(self.idle),
            "own_motions_only": "yes" if self.own_motions_only else "no",
            "whole_limbs": "yes" if self.whole_limbs else "no",
            "speed_map": self.speed_map,
            "turns": f"{self.turns:g}",
            "personality": self.personality or "",
            "talk_language": self.talk_language,
            "asks_model": "yes" if self.asks_model else "no",
            "look": self.look,
            "inside": self.inside,
            "realism": ",".join(self.realism),
            "video": "no" if self.codec == NO_VIDEO else "yes",
            "participant": self.participant,
            "condition": self.condition,
            "notes": self.notes,
            "source": source.split("://")[0] if "://" in source else Path(source).name,
        }

    @classmethod
    def from_metadata(cls, metadata: Mapping[str, str], source: str) -> Self:
        """Return the settings that `metadata` kept, to replay the recording `source`.

        Raises ValueError if its `turns` or `players` is no number.
        """
        numbers = {"turns": 2.0, "players": 1.0}
        for name, usual in numbers.items():
            try:
                numbers[name] = float(metadata.get(name, usual))
            except ValueError:
                stated = metadata[name]
                raise ValueError(f"its '{name}' is {stated!r:.40}, which is no number") from None
        cube = metadata.get("cube")
        names = (*metadata.get("robot_names", "").splitlines(), *ROBOT_NAMES)[:2]
        realism = metadata.get("realism", ",".join(REALISM_CHOICES))
        return cls(
            scenario=metadata["scenario"],
            source=source,
            cubes=(*((cube,) if cube else ()), *metadata.get("further_cubes", "").splitlines()),
            players=checked_players(numbers["players"]),
            robot_names=(names[0], names[1]),
            character=metadata.get("character") or None,
            others=tuple(metadata.get("others", "").splitlines()),
            controller=metadata.get("controller", "tree"),
            motions=tuple(metadata.get("motions", "").splitlines()),
            idle=Path(metadata["idle"]) if metadata.get("idle") else None,
            # What was recorded before there were lent motions had none.
            own_motions_only=metadata.get("own_motions_only", "yes") == "yes",
            whole_limbs=metadata.get("whole_limbs", "no") == "yes",
            speed_map=metadata.get("speed_map", "corrected"),
            turns=numbers["turns"],
            personality=metadata.get("personality") or None,
            talk_language=metadata.get("talk_language", ""),
            asks_model=metadata.get("asks_model") == "yes",
            look=metadata.get("look", "auto"),
            inside=metadata.get("inside", "auto"),
            realism=tuple(filter(None, realism.split(","))),
            participant=metadata.get("participant", ""),
            condition=metadata.get("condition", ""),
            notes=metadata.get("notes", ""),
        )


def check_stage(start: str) -> None:
    """Raise AppError if a replay cannot start from a stage."""
    if start not in START_STAGES:
        raise AppError(
            f"a replay cannot start from '{start}': choose one of {', '.join(START_STAGES)}"
        )
