"""Films of the study of gesture and speech, in its four conditions.

Fernández-Baena 2015, section 4.4.5 (M8): captured, strength and time, time only, random. A film in
which a gesture costs 10 or more, because none suits an accent, is left out, and so are its pairs.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path

import numpy as np

from cubeling.app.sound import SAMPLE_RATE
from cubeling.app.speaking.speech_video import sound_blocks
from cubeling.app.workshop.reproduction.gesturing.spoken import (
    Condition,
    accents_for,
    speeches,
)
from cubeling.app.workshop.stimuli.film import FilmLook, write_film
from cubeling.app.workshop.study.manifest import MANIFEST, write_rows
from cubeling.characters import Character, Clip, read_motions
from cubeling.characters.motion import (
    GestureLibrary,
    GesturePlan,
    GesturePlanner,
    GestureSettings,
    stack,
)
from cubeling.characters.rendering import standing_pose
from cubeling.characters.speech import Speech, Utterance, resample

ORIGINAL = "original"
"""The condition whose gestures were captured with the speech."""

CONDITIONS: tuple[Condition, ...] = ("intensity", "time", "random")
MEMBERS = (*CONDITIONS, ORIGINAL)

SETTINGS = GestureSettings(model="thesis", accent_floor=0.0)
"""How gestures are chosen: by the two rules and the costs of the study."""

TRIES = 20
"""Seeds that are tried until no gesture costs 10 or more."""

LEAD_S, TAIL_S = 0.4, 1.0
"""Time before and after the speech [s]: hands come to rest."""

MOTION_SUFFIXES = (".bvh", ".amc")

PAIRS = "pairs.csv"


@dataclass(frozen=True)
class PlannedFilm:
    """What a film is to show, or why it is left out."""

    member: str
    """One of `MEMBERS`."""

    plan: GesturePlan | None
    """The gestures; None for captured ones, and for a film that is left out."""

    seed: int
    """The seed that led to the plan, or the first that was tried."""

    left_out: str = ""
    """Why there is no film; "" if there is one."""


def plan_film(
    planner: GesturePlanner, utterance: Utterance, condition: Condition, seed: int, number: int
) -> PlannedFilm:
    """Return the gestures of a condition: the first of some plans without a cost of 10 or more.

    `number` is that of the recording, so that each has random numbers of its own.
    """
    for each in range(seed, seed + TRIES):
        rng = np.random.default_rng([each, number])
        accents = accents_for(condition, utterance.accents, utterance.duration, rng)
        plan = planner.plan(accents, utterance.duration, seed=each)
        if plan.gestures and not plan.skipped and not any(g.relaxed for g in plan.gestures):
            return PlannedFilm(condition, plan, each)
    return PlannedFilm(condition, None, seed, f"{TRIES} plans have a gesture that costs 10 or more")


def film_clip(body: Character, plan: GesturePlan, rate: float) -> Clip:
    """Return the motion of a plan, over a body that stands, `LEAD_S` after the start."""
    motion = plan.motion()
    standing = standing_pose(body)
    count = round((LEAD_S + max(plan.duration + TAIL_S, motion.duration)) * rate) + 1
    poses = []
    for number in range(count):
        turns = standing.rotations.copy()
        turns[motion.joints] = motion.turns(max(number / rate - LEAD_S, 0.0))
        poses.append(replace(standing, rotations=turns))
    return Clip("gestures", rate, stack(poses), loop=False)


def captured_clip(
    body: Character, library: GestureLibrary, clip: Clip, speech: Speech, rate: float
) -> Clip:
    """Return captured gestures as the others are shown: the same joints, and legs that stand."""
    standing, joints = standing_pose(body), list(library.joints)
    count = round((LEAD_S + speech.duration + TAIL_S) * rate) + 1
    poses = []
    for number in range(count):
        time = min(max(number / rate - LEAD_S, 0.0), clip.duration)
        turns = standing.rotations.copy()
        turns[joints] = clip.sample(time).rotations[joints]
        poses.append(replace(standing, rotations=turns))
    return Clip("captured", rate, stack(poses), loop=False)


def write_gesture_films(
    sounds: Path,
    folder: Path,
    body: Character,
    library: GestureLibrary,
    look: FilmLook,
    *,
    captured: Path | None = None,
    seed: int = 0,
    drawn: Callable[[str], None] = lambda name: None,
) -> tuple[int, int]:
    """Write the films of all recordings of a folder, and return how many films and pairs there are.

    The manifest says what each file shows and what is left out, `pairs.csv` which pairs are there.

    Parameters
    ----------
    sounds
        The recordings: .wav files, whose names are those of the speeches.
    folder
        An existing folder.
    body, library, look
        Who gestures, what is chosen from, and how it is drawn.
    captured
        A folder with gestures that were captured with the speech: a motion file for each recording,
        of the same name. None for no films of them.
    seed
        The first that is tried.
    drawn
        Called with the name of each film before it is drawn.

    Raises
    ------
    AppError, CharacterError
        A recording cannot be read, or a file cannot be written.
    """
    planner = GesturePlanner(library, SETTINGS)
    rows, pairs = [], []
    for number, (name, speech, utterance) in enumerate(speeches(sounds)):
        there = []
        films = [plan_film(planner, utterance, each, seed, number) for each in CONDITIONS]
        files = (captured / f"{name}{suffix}" for suffix in MOTION_SUFFIXES) if captured else ()
        motion = next((each for each in files if each.is_file()), None)
        reason = "" if motion else "no gestures were captured with this speech"
        for film in (*films, PlannedFilm(ORIGINAL, None, seed, reason)):
            path = folder / f"{name}-{film.member}.mp4"
            if not film.left_out:
                drawn(path.name)
                if film.plan is not None:
                    clip = film_clip(body, film.plan, look.rate)
                else:
                    assert motion is not None
                    (recorded,) = read_motions([str(motion)], body)
                    clip = captured_clip(body, library, recorded, speech, look.rate)
                write_film(path, body, clip, look, sound_blocks(_heard(speech)))
                there.append(film.member)
            rows.append(_row(path.name, name, film))
        pairs += [_pair(name, pair, there) for pair in combinations(MEMBERS, 2)]
    write_rows(folder / MANIFEST, rows)
    write_rows(folder / PAIRS, pairs)
    return (
        sum(not row["left out"] for row in rows),
        sum(not pair["left out"] for pair in pairs),
    )


def _heard(speech: Speech) -> np.ndarray[tuple[int, int], np.dtype[np.float32]]:
    """Return the sound of a film, mono, (n, 1)."""
    samples = resample(speech.samples, speech.rate, SAMPLE_RATE)
    lead = np.zeros(round(LEAD_S * SAMPLE_RATE), np.float32)
    return np.concatenate([lead, samples.astype(np.float32)])[:, None]


def _row(file: str, speech: str, film: PlannedFilm) -> dict[str, str]:
    gestures = film.plan.gestures if film.plan is not None else ()
    dearest = max((g.costs.smooth + g.costs.strength + g.costs.time for g in gestures), default=0.0)
    return {
        "file": "" if film.left_out else file,
        "speech": speech,
        "member": film.member,
        "seed": f"{film.seed}",
        "gestures": f"{len(gestures)}" if gestures else "",
        "dearest": f"{dearest:.3f}" if gestures else "",
        "left out": film.left_out,
    }


def _pair(speech: str, pair: tuple[str, str], there: Sequence[str]) -> Mapping[str, str]:
    missing = [member for member in pair if member not in there]
    return {
        "speech": speech,
        "pair": " / ".join(pair),
        "left out": f"no film of {' and '.join(missing)}" if missing else "",
    }
