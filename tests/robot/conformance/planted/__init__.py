"""Robots with faults that their makers may make, planted in the source of the firmware."""

from tests.robot.conformance.planted.bodies import BODIES
from tests.robot.conformance.planted.commands import COMMANDS
from tests.robot.conformance.planted.framing import FRAMING
from tests.robot.conformance.planted.robot import PlantedFault
from tests.robot.conformance.planted.sessions import SESSIONS
from tests.robot.conformance.planted.states import STATES

FAULTS: tuple[PlantedFault, ...] = FRAMING + BODIES + SESSIONS + COMMANDS + STATES
"""All of them, in the order of the document."""
