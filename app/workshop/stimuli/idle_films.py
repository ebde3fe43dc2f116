"""Films of the study of idle motion: people who stand, as recorded and as generated.

Egges 2006, section 3.3.2 (S25).
"""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from cubeling.app.workshop.reproduction.standing.people import read_people
from cubeling.app.workshop.stimuli.film import FilmLook, write_film
from cubeling.app.workshop.study.manifest import MANIFEST, write_rows
from cubeling.characters import Character, Clip, Pose
from cubeling.characters.motion import (
    IdleDatabase,
    IdleMotion,
    PostureVectors,
    StandingRecording,
    stack,
)

ORIGINS = ("recorded", "generated")


def idle_clips(
    person: StandingRecording, kind: PostureVectors, seconds: float, rate: float, seed: int
) -> dict[str, Clip]:
    """Return a piece of a recording, and motion that is generated from all of it.

    Both have the same joints; fingers and face are still in either.
    """
    rng = np.random.default_rng(seed)
    length = len(person.vectors) / person.rate
    first = float(rng.uniform(0.0, max(length - seconds, 0.0)))
    count = round(min(seconds, length) * rate)
    times = first + np.arange(count) / rate
    at = np.clip(np.rint(times * person.rate), 0, len(person.vectors) - 1).astype(int)
    motion = IdleMotion(IdleDatabase.of([person], kind), seed)
    made = [motion.sample(number / rate) for number in range(count)]
    poses: dict[str, Pose] = {
        "recorded": kind.poses(person.vectors[at]),
        "generated": kind.poses(kind.vectors(stack(made))),
    }
    return {name: Clip(name, rate, each, loop=False) for name, each in poses.items()}


def write_idle_films(
    recordings: Path,
    folder: Path,
    look: FilmLook,
    *,
    seconds: float,
    seed: int = 0,
    drawn: Callable[[str], None] = lambda name: None,
) -> int:
    """Write two films of each person in a folder of .bvh files, and return how many there are.

    The people are P1, P2 …, in the order of their files; the manifest says whose each file is.

    Raises
    ------
    AppError
        There are fewer than two recordings, one cannot be read, or a file cannot be written.
    """
    body = Character.load("human")
    people, kind = read_people(recordings, drawn)
    rows = []
    for number, person in enumerate(people, 1):
        clips = idle_clips(person, kind, seconds, look.rate, seed + number)
        for origin in ORIGINS:
            path = folder / f"P{number}-{origin}.mp4"
            drawn(path.name)
            write_film(path, body, clips[origin], look)
            rows.append(
                {
                    "file": path.name,
                    "person": f"P{number}",
                    "origin": origin,
                    "recording": person.name,
                    "seconds": f"{clips[origin].duration:.2f}",
                    "seed": f"{seed + number}",
                }
            )
    write_rows(folder / MANIFEST, rows)
    return len(rows)
