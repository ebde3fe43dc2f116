"""Map the rooms, which are folders at the top level, to packages inside `cubeling`.

Everything else about the build is in pyproject.toml, which can name such a mapping but not find
the packages in it.
"""

from setuptools import find_packages, setup

ROOMS = ("affect", "tracking", "characters", "robot", "app", "recordings")

setup(
    packages=["cubeling"]
    + [f"cubeling.{name}" for room in ROOMS for name in find_packages(include=[room, f"{room}.*"])],
    package_dir={f"cubeling.{room}": room for room in ROOMS},
)
