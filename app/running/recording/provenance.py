"""What a session plays, resolved: names, files and versions instead of options."""

import hashlib
import json
import platform
import re
from importlib import metadata, resources
from typing import Any

from cubeling.app.pipeline.cast.further_members import seed_of
from cubeling.app.pipeline.playground import Playground
from cubeling.app.pipeline.scenario import CastScenario
from cubeling.app.session import SessionOptions
from cubeling.characters import Character
from cubeling.files import first_bytes
from cubeling.robot import protocol_of
from cubeling.tracking import CubeModel, FrameSource, Intrinsics

PROGRAM = "cubeling"

MAX_CHARACTER_BYTES = 1 << 30
"""More than any character has [bytes]."""


def played(
    options: SessionOptions, playground: Playground, source: FrameSource, language: str
) -> dict[str, str]:
    """Return what is played, as text by text, for a reader of the recording.

    Parameters
    ----------
    options
        The settings as they are now.
    playground, source
        What plays, and where its frames come from.
    language
        Code of the language in which the character speaks; "" for silence.
    """
    scenario = playground.scenario
    own = scenario.others if isinstance(scenario, CastScenario) else ()
    chosen = options.character is not None or options.others
    names = (options.character or scenario.character, *(options.others if chosen else own))
    members = [member.name for member in playground.cast.members]
    robots = [each for each in (options.robot, options.second_robot) if each != "none"]
    return {
        "scenario": scenario.name,
        "character": options.character or scenario.character,
        "others": "\n".join(names[1:]),
        "character_sha256": "\n".join(map(_character_hash, names)),
        "personality": options.personality or scenario.personality,
        "controller": options.controller,
        "turns": f"{options.turns:g}",
        "cube": playground.cube.name,
        "cube_folded": json.dumps([_folded(player.cube) for player in playground.players]),
        "lens": _lens(options, source, playground.intrinsics),
        "robot": "\n".join(robots),
        "driver": "\n".join(protocol_of(url, None)[1] for url in robots),
        "language": language,
        "voice": (options.voice or "eSpeak NG") if language else "",
        "seeds": json.dumps({name: seed_of(number, name) for number, name in enumerate(members)}),
        "version": metadata.version(PROGRAM),
        "libraries": " ".join(_libraries()),
        "machine": f"{platform.platform()}, Python {platform.python_version()}",
    }


def _character_hash(name: str) -> str:
    """Return the SHA-256 of a character's file, in hexadecimal; "" if it is gone."""
    if name in Character.bundled_names():
        name = str(resources.files("cubeling.characters") / "assets" / f"{name}.glb")
    content = first_bytes(name, MAX_CHARACTER_BYTES)
    return hashlib.sha256(content).hexdigest() if content else ""


def _folded(cube: CubeModel) -> dict[str, Any]:
    faces = [
        {"face": face.name, "marker": face.marker_id, "roll_deg": face.roll_deg, "role": face.role}
        for face in cube.faces
    ]
    return {
        "name": cube.name,
        "dictionary": cube.dictionary,
        "edge_mm": round(1000 * cube.edge, 3),
        "marker_mm": round(1000 * cube.marker_size, 3),
        "faces": faces,
    }


def _lens(options: SessionOptions, source: FrameSource, lens: Intrinsics) -> str:
    """Return whose lens the camera has; its numbers are on /camera/calibration."""
    if options.intrinsics is not None:
        return f"calibrated: {options.intrinsics.name}"
    if source.intrinsics is not None:
        return "that of the source"
    guess = Intrinsics.guess(lens.size).focal_deviation
    return "guessed" if lens.focal_deviation == guess else "measured in play"


def _libraries() -> list[str]:
    """Return the libraries that the program needs, each "NAME==VERSION" as it is installed."""
    found = []
    for requirement in metadata.requires(PROGRAM) or ():
        name = re.match(r"[\w.-]+", requirement)
        if name is not None and "extra ==" not in requirement:
            found.append(f"{name[0]}=={metadata.version(name[0])}")
    return found
