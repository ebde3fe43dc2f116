"""Whether the faces of a cube have the roles that a scenario reads."""

from collections.abc import Sequence

from cubeling.app.errors import AppError
from cubeling.app.pipeline.registry import find_scenario, scenario_names
from cubeling.app.pipeline.scenario import missing_roles
from cubeling.tracking import CubeModel, bundled_cubes


def check_cubes(scenario: str, cubes: Sequence[str]) -> None:
    """Refuse cubes if a scenario cannot be played with the first of them; () is its own.

    Raises AppError if a role is not known or one that the scenario reads is missing, or if two
    cubes have the same markers; and TrackingError if a cube cannot be read.
    """
    chosen = find_scenario(scenario)
    names = cubes or (chosen.cube,)
    models = [CubeModel.load(name) for name in names]
    markers: dict[frozenset[tuple[str, int]], str] = {}
    for name, model in zip(names, models, strict=True):
        check_roles(model, name, chosen.roles)
        if (twin := markers.setdefault(model.markers, name)) != name:
            raise AppError(f"{name} has the markers of {twin}: name only one of them")
    missing = missing_roles(chosen, models[0])
    if missing:
        found = ", ".join(_roles(models[0])) or "none"
        raise AppError(
            f"{names[0]}: {scenario} needs a face with each of the roles "
            f"{', '.join(chosen.roles)}; missing: {', '.join(missing)} (the cube has {found})"
        )


def check_roles(cube: CubeModel, where: str, played: Sequence[str] = ()) -> None:
    """Raise AppError if a face has a role of no bundled cube and of no scenario.

    `played` are the roles of the scenario that is to be played.
    """
    known = [*played]
    known += [role for name in bundled_cubes() for role in _roles(CubeModel.load(name))]
    unknown = [face for face in cube.faces if face.role and face.role not in known]
    if unknown:  # only then import the packages that add scenarios
        known += [role for name in scenario_names() for role in find_scenario(name).roles]
    for face in unknown:
        if face.role not in known:
            raise AppError(
                f"{where}: face '{face.name}' has the role '{face.role}'; "
                f"use one of {', '.join(dict.fromkeys(known))}"
            )


def _roles(cube: CubeModel) -> list[str]:
    return list(dict.fromkeys(face.role for face in cube.faces if face.role))
