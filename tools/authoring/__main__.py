"""Write the bundled characters: ``python -m tools.authoring [human|vleo|robot|all]``."""

import sys
from collections.abc import Callable
from pathlib import Path

from cubeling.characters.model.character import Character
from tools.authoring.human.character import build_human
from tools.authoring.human.face_map import save_face_maps
from tools.authoring.people import save_standing
from tools.authoring.robot.character import build_robot
from tools.authoring.speakers import GESTURES
from tools.authoring.vleo.character import build_vleo

BUILDERS: dict[str, Callable[[], Character]] = {
    "human": build_human,
    "vleo": build_vleo,
    "robot": build_robot,
}
FACES: dict[str, Callable[[Path], list[Path]]] = {"human": save_face_maps}
"""What writes the folder of the face maps of a character, by its name."""

ASSETS = Path(__file__).parents[2] / "characters" / "assets"


def main(arguments: list[str]) -> int:
    """Write the named characters, or all, and return the exit code."""
    wanted = arguments or ["all"]
    names = list(BUILDERS) if wanted == ["all"] else wanted
    unknown = [name for name in names if name not in BUILDERS]
    if unknown:
        sys.stderr.write(f"no character {unknown[0]!r} to make; there are {', '.join(BUILDERS)}\n")
        return 2
    for name in names:
        character = BUILDERS[name]()
        path = ASSETS / f"{name}.glb"
        character.save(path)
        save_standing(character, path.with_suffix(".idle"))
        files = [path, path.with_suffix(".idle")]
        if name in GESTURES:
            files.append(path.with_suffix(".gestures"))
            GESTURES[name](character).save(files[-1])
        if name in FACES:
            files += FACES[name](path.with_name(f"{name}_face"))
        for written in files:
            sys.stdout.write(f"{written}: {written.stat().st_size / 1024:.0f} KiB\n")
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
