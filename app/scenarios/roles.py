"""Whether the faces of a cube have the roles that a scenario reads."""

from app.errors import AppError
from app.pipeline.registry import find_scenario, scenario_names
from tracking import CubeModel, bundled_cubes


def check_cube(scenario: str, cube: str | None) -> None:
    """Refuse a cube that a scenario cannot be played with; None is the scenario's own.

    Raises AppError if a role is not known or one that the scenario reads is missing, and
    TrackingError if the cube cannot be read.
    """
    chosen = find_scenario(scenario)
    where = cube or chosen.cube
    model = CubeModel.load(where)
    check_roles(model, where)
    missing = [role for role in chosen.roles if role not in _roles(model)]
    if missing:
        found = ", ".join(_roles(model)) or "none"
        raise AppError(
            f"{where}: {scenario} needs a face with each of the roles {', '.join(chosen.roles)}; "
            f"missing: {', '.join(missing)} (the cube has {found})"
        )


def check_roles(cube: CubeModel, where: str) -> None:
    """Raise AppError if a face has a role of no bundled cube and of no scenario."""
    known = [role for name in bundled_cubes() for role in _roles(CubeModel.load(name))]
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
