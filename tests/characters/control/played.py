"""Plays commands to an animator, and measures what it returns."""

import math

import numpy as np

from cubeling.characters.skeleton import rotations
from tests.characters.commands import command

RATE_HZ = 30


def heading(posed):
    forward = posed.table_from_character[:3, 2]
    return math.atan2(forward[0], forward[2])


def place(posed):
    return posed.table_from_character[[0, 2], 3]


def play(animator, seconds, start=0.0, rate=RATE_HZ, **asked):
    """Give one command for a while and return every frame."""
    times = start + np.arange(round(seconds * rate)) / rate
    return [animator.update(command(float(t), **asked)) for t in times]


def velocities(frames, rate):
    turns = np.stack([frame.pose.rotations for frame in frames])
    steps = rotations.multiply(turns[1:], rotations.conjugate(turns[:-1]))
    return rotations.to_rotation_vector(steps) * rate
