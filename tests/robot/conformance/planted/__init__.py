"""Robots with faults that their makers may make, planted in the source of the firmware."""

from pathlib import Path

from tests.robot.conformance.planted.robot import PlantedFault, read_faults

SUBJECTS = ("framing", "bodies", "sessions", "commands", "states")
"""The files of faults, in the order of the document."""

FAULTS: tuple[PlantedFault, ...] = tuple(
    fault for subject in SUBJECTS for fault in read_faults(Path(__file__).parent / f"{subject}.txt")
)
"""All of them."""
