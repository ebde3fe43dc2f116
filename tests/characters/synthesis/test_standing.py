"""What is read from recordings of people who stand: rests, shifts, and whom they suit."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cubeling.characters import Character, CharacterError, Clip, Pose
from cubeling.characters.control.controllers.recordings import read_motions
from cubeling.characters.skeleton import rotations
from cubeling.characters.synthesis.idle.database import IdleDatabase
from cubeling.characters.synthesis.idle.posture_space import PostureVectors
from cubeling.characters.synthesis.idle.recordings import (
    RestSpan,
    StandingRecording,
    borrow_shifts,
    find_rests,
    read_parts,
    read_standing,
)
from tests.characters.synthesis.stander import (
    CHANCES,
    PAUSES,
    RATE,
    SIDES,
    database as database,
    kind as kind,
    script,
)
from tests.examples import some

IDLE = Path(__file__).parents[4] / "shared" / "data" / "idle"


def test_rests_and_shifts_are_found_where_they_are() -> None:
    balance, truth = script(200, 1)
    rests = find_rests(balance, RATE)  # the script ends within a shift
    assert [rest.balance for rest in rests] == [name for name, _ in truth]
    lengths = np.array([(rest.end - rest.first) / RATE for rest in rests])
    assert lengths == pytest.approx(np.array([pause for _, pause in truth]), abs=0.5)


def test_somebody_who_never_shifts_has_one_rest() -> None:
    assert find_rests(np.full(100, 0.3), RATE) == (RestSpan(0, 100, "left"),)


def test_probabilities_and_pauses_are_those_of_the_stander(database: IdleDatabase) -> None:
    for name, row in CHANCES.items():
        found = database.probabilities(name)
        assert sum(found.values()) == pytest.approx(1.0)
        counted = sum(shift.start == name for shift in database.shifts)
        for after, chance in zip(SIDES, row, strict=True):
            deviation = np.sqrt(chance * (1 - chance) / counted)
            assert abs(found.get(after, 0.0) - chance) <= 3 * deviation
        low, high = database.pause_limits(name)
        assert PAUSES[0] - 0.5 <= low < high <= PAUSES[1] + 0.6


def standing_clip(human: Character, moved: np.ndarray, lowered: float = 0.0) -> Clip:
    """Return a clip of the rest pose whose root moves, (frames, 3) [m]."""
    rest = human.skeleton.rest
    count = len(moved)
    translations = np.repeat(rest.translations[None], count, axis=0)
    translations[:, 0] += moved - [0.0, lowered, 0.0]
    return Clip("anna", RATE, Pose(translations, np.repeat(rest.rotations[None], count, axis=0)))


def test_a_recording_with_a_few_steps_gives_the_parts_between_them(human: Character) -> None:
    times = np.arange(30 * RATE) / RATE
    ahead = np.interp(times, [0, 10, 10.6, 20, 20.6, 24, 24.6, 30], [0, 0, 1, 1, 2, 2, 3, 3])
    clip = standing_clip(human, np.stack([0 * ahead, 0 * ahead, ahead], axis=1))
    parts = read_parts(clip, human.skeleton, human.anatomy)
    lengths = [len(each.vectors) / RATE for each in parts]
    assert lengths == pytest.approx([10.0, 9.4, 5.4], abs=0.8)  # the third is too short
    whole = standing_clip(human, np.zeros((200, 3)))
    assert [len(p.vectors) for p in read_parts(whole, human.skeleton, human.anatomy)] == [200]


def test_somebody_who_sits_shifts_with_her_trunk(human: Character) -> None:
    way, truth = script(12, 2)
    clip = standing_clip(human, np.zeros((len(way), 3)), 0.5)
    spine = human.anatomy.joints["spine"]
    turned = clip.poses.rotations.copy()
    turned[:, spine] = rotations.multiply(rotations.about("z", -0.4 * way), turned[:, spine])
    seated = replace(clip, poses=replace(clip.poses, rotations=turned))
    (found,) = read_parts(seated, human.skeleton, human.anatomy)
    assert abs(len(found.rests) - len(truth)) <= 2
    assert {rest.balance for rest in found.rests} >= {"left", "right"}


def test_who_never_shifts_borrows_shifts_about_her_own_posture(kind: PostureVectors) -> None:
    rng = np.random.default_rng(3)
    still = np.zeros(500)
    own = StandingRecording(
        "anna", RATE, np.full((500, kind.size), 0.1), still, find_rests(still, RATE)
    )
    way, _ = script(20, 4)
    vectors = np.outer(way, rng.normal(size=kind.size) * 0.1) - 0.2
    lender = StandingRecording("bea", 2 * RATE, vectors, way, find_rests(way, 2 * RATE))
    database = IdleDatabase.of(borrow_shifts([own], [lender]), kind)
    assert len(database.shifts) >= 10
    assert np.concatenate(database.rests).mean() == pytest.approx(0.1, abs=0.05)


def test_people_who_walk_or_jump_are_refused_and_those_who_sit_are_not(human: Character) -> None:
    body = human.skeleton, human.anatomy
    walk = human.clips["Walk"]
    with pytest.raises(CharacterError, match=r"both feet stand in only \d+%"):
        read_standing(walk, *body)
    standing = Pose(*(np.repeat(each[None], 50, axis=0) for each in (
        human.skeleton.rest.translations, human.skeleton.rest.rotations)))  # fmt: skip
    still = Clip("still", RATE, standing, root_motion=True)
    assert read_standing(still, *body).rests == (RestSpan(0, 50, "both"),)
    low = standing.translations.copy()
    low[:, human.anatomy.joints["hips"], 1] -= 0.4
    sitting = read_standing(replace(still, poses=replace(standing, translations=low)), *body)
    assert sitting.rests == (RestSpan(0, 50, "both"),)
    leaping = standing.translations.copy()
    leaping[25:, 0, 0] += 1.0
    with pytest.raises(CharacterError, match=r"a joint jumps at 1\.0 s"):
        read_standing(replace(still, poses=replace(standing, translations=leaping)), *body)


def beginning(path: Path, frames: int, folder: Path) -> Path:
    """Return a recording of the first frames of a longer one."""
    lines = path.read_text().splitlines()
    head = next(number for number, line in enumerate(lines) if line.startswith("Frames:"))
    kept = [*lines[:head], f"Frames: {frames}", *lines[head + 1 : head + 2 + frames]]
    shorter = folder / path.name
    shorter.write_text("\n".join(kept) + "\n")
    return shorter


@pytest.mark.full
@pytest.mark.slow(reason="a recording of a person is retargeted and analysed")
@pytest.mark.skipif(not IDLE.is_dir(), reason="needs shared/data/idle")
@pytest.mark.parametrize(("frames", "shifts"), some([(720, 8), (3110, 20)]))
def test_a_real_person_shifts_her_balance(
    human: Character, kind: PostureVectors, tmp_path: Path, frames: int, shifts: int
) -> None:
    path = beginning(IDLE / "007_acted.bvh", frames, tmp_path)
    (clip,) = read_motions([str(path)], human)
    assert len(clip) == frames
    recording = read_standing(clip, human.skeleton, human.anatomy)
    database = IdleDatabase.of([recording], kind)
    assert len(database.shifts) >= shifts
    assert set(database.by_balance) == {"left", "both", "right"}
    again = kind.poses(recording.vectors).globals(human.skeleton)[:, :, :3, 3]
    feet = again[:, [human.anatomy.joints[side + "Foot"] for side in ("left", "right")]]
    assert np.ptp(feet[..., [0, 2]], axis=0).max() < 0.1  # they stay, while the hips go
    hips = again[:, human.anatomy.joints["hips"]]
    assert np.ptp(hips[:, 0]) > 0.12
