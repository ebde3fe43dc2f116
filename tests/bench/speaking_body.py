"""Measure how the body of a speaker joins in; `tests.bench.speaking` prints it.

Alignment is by machine what people are asked with mismatched sound (Kucherenko et al., GENEA 2023):
the speed of hands is compared with the loudness of the speech that they go with, and with that of
others. Loudness is that of the sound, not of the syllables that the motion was planned by.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from numpy.typing import NDArray
from rich.console import Console
from rich.table import Table

from cubeling.affect import Emotion
from cubeling.characters import Animator, Character, CharacterCommand, RootDelta, SpeechIntent
from cubeling.characters.control.loading import load_to_play
from cubeling.characters.control.speech_profile import SpeechProfile
from cubeling.characters.face.expressions import EXPRESSIONS, ExpressionMorphs
from cubeling.characters.face.lids import Lids
from cubeling.characters.smoothing import gaussian_smooth
from cubeling.characters.speech.audio import read_speech
from cubeling.characters.speech.mouth import phones_from_sound
from cubeling.characters.speech.prosody.analysis import LOUDNESS_EXPONENT, utterance_of
from cubeling.characters.speech.prosody.contours import measure_prosody
from cubeling.characters.speech.prosody.phrases import phrases_of
from cubeling.characters.speech.saying import say
from cubeling.characters.speech.speech import Utterance
from cubeling.characters.speech.tagged_text import TaggedText
from cubeling.characters.speech.voices import Voice

RECORDINGS = Path(__file__).parents[2] / ".." / "shared" / "data" / "speech"
STRANGER = RECORDINGS.parent / "gltf" / "RiggedFigure.glb"

RATE = 30
LEAD_S, TAIL_S, SETTLE_S = 1.5, 1.5, 0.5
LAG_S = 0.2
OTHERS = 100
SEEDS = 1
LISTENER = np.array([0.1, 0.16, 0.7])
STILL_M = 0.01
"""A wrist that stays within such a ball beside the chest does not move [m]."""

ALIVE, FROZEN = SpeechProfile(), SpeechProfile(liveliness=0.0)

Array = NDArray[np.float64]

TOPICS = """Good morning, and welcome to the museum. I am a small paper person, and I will show you
around. The house was built a hundred years ago, and a baker lived here with his seven children.

Now look at the old clock over there. Every evening it strikes thirteen, because a mouse has eaten
one of its wheels, and nobody has found another one that fits.

In the next room there are robots. They walk, they dance, and one of them can even cook soup, but
please do not ask it for salt.

The garden is closed today. A storm has broken the big tree, and the gardener is still looking for
his ladder, his hat and his good mood.

Last of all, let me tell you about the cube. Turn it, and I go where you want. Hold it still, and I
wait for you, as long as it takes."""

ACCUSATION = "You lied to me. You broke your promise, and it is your fault that we lost everything."


@dataclass(frozen=True, eq=False)
class Played:
    """A character that says something, frame by frame."""

    times: Array
    """Since the start of the speech, (n,) [s]."""

    places: dict[str, Array]
    """Where joints are, by part, (n, 3) [m] in the size of the character."""

    morphs: Array
    """(n, morphs)."""

    hips_deg: Array
    """Bend of the trunk, (n,) [degrees]."""


PARTS = ("hips", "chest", "head", *(s + p for s in ("left", "right") for p in (
    "UpperArm", "LowerArm", "Hand", "UpperLeg", "LowerLeg", "Foot", "Toes")))  # fmt: skip


def play(
    character: Character,
    utterance: Utterance | None,
    profile: SpeechProfile,
    seed: int = 0,
    emotion: Emotion | None = None,
    seconds: float = 0.0,
) -> Played:
    """Return what a character does while it says something, or stands for some seconds."""
    animator = Animator(character, place=RootDelta(), seed=seed)
    speech = None if utterance is None else SpeechIntent(utterance, 0.0, profile)
    length = seconds if utterance is None else utterance.duration + TAIL_S
    numbers = range(-round((LEAD_S + SETTLE_S) * RATE), round(length * RATE))
    joints = {p: j for p in PARTS if (j := character.anatomy.joint(p)) is not None}
    rest = character.skeleton.rest.globals(character.skeleton)
    times, places, morphs, bends = [], [], [], []
    for number in numbers:
        now = number / RATE
        posed = animator.update(
            CharacterCommand(now, gaze=LISTENER, emotion=emotion, speech=speech)
        )
        if now < -LEAD_S:
            continue
        placed = posed.table_from_character / animator.scale
        world = placed[:3, :3] @ posed.pose.globals(character.skeleton)[:, :3, :]
        world[:, :, 3] += placed[:3, 3]
        times.append(now)
        places.append(world[[*joints.values()], :, 3])
        morphs.append(np.zeros(0) if posed.pose.morphs is None else posed.pose.morphs)
        chest = world[joints.get("chest", joints["hips"]), :, :3]
        up = chest @ rest[joints.get("chest", joints["hips"]), :3, :3].T @ [0.0, 1.0, 0.0]
        bends.append(math.degrees(math.atan2(up[2], up[1])))
    stacked = np.array(places)
    return Played(
        np.array(times),
        {part: stacked[:, number] for number, part in enumerate(joints)},
        np.array(morphs),
        np.array(bends),
    )


def speeds(path: Array) -> Array:
    """Return the speed along a path, (n,) [m/s]."""
    return np.asarray(np.linalg.norm(np.gradient(path, 1.0 / RATE, axis=0), axis=1))


def hand_speed(played: Played) -> Array:
    """Return the speed of both hands together beside the chest, (n,) [m/s]."""
    hands = [speeds(played.places[s + "Hand"] - played.places["chest"]) for s in ("left", "right")]
    return hands[0] + hands[1]


# --- alignment


def recordings() -> Iterator[tuple[str, Utterance, Array]]:
    """Yield name, utterance and loudness (at `RATE`) of each recording."""
    for path in sorted(RECORDINGS.glob("*/*.wav")):
        sound = read_speech(path)
        speech = replace(sound, phones=phones_from_sound(sound.samples, sound.rate))
        prosody = measure_prosody(speech.samples, speech.rate)
        loudness = 10 ** (LOUDNESS_EXPONENT * prosody.intensity / 20)
        times = np.arange(0.0, speech.duration, 1.0 / RATE)
        envelope = gaussian_smooth(np.interp(times, prosody.times, loudness)[:, None], 0.04 * RATE)
        yield path.stem, utterance_of(speech), envelope[:, 0]


def correlation(speed: Array, loudness: Array) -> float:
    """Return the greatest correlation of speed and loudness within `LAG_S`."""
    reach, count = round(LAG_S * RATE), len(loudness)
    found = []
    for lag in range(-reach, reach + 1):
        a = speed[max(lag, 0) : count + min(lag, 0)]
        b = loudness[max(-lag, 0) : count - max(lag, 0)]
        found.append(np.corrcoef(a, b)[0, 1] if a.std() > 1e-9 and b.std() > 1e-12 else 0.0)
    return float(max(found))


def altered(utterance: Utterance, kind: str, rng: np.random.Generator) -> Utterance:
    """Return an utterance whose accents and syllables tell less of its sound.

    "time" has strengths that are drawn at random, "random" times as well.
    """

    def times(of: Sequence[float]) -> list[float]:
        if kind == "time":
            return [*of]
        return sorted(rng.uniform(0.2, utterance.duration - 0.1, len(of)).tolist())

    accents, syllables = utterance.accents, utterance.syllables
    return replace(
        utterance,
        accents=tuple(
            replace(each, time=time, strength=float(rng.uniform(0.3, 1.0)))
            for each, time in zip(accents, times([a.time for a in accents]), strict=True)
        ),
        syllables=tuple(
            replace(each, time=time, loudness=float(rng.uniform()))
            for each, time in zip(syllables, times([s.time for s in syllables]), strict=True)
        ),
    )


def alignment(character: Character, console: Console) -> None:
    """Print how often a motion fits its own speech better than others."""
    spoken = [each for each in recordings() if each[1].duration > 1.5]
    table = Table(title=f"alignment, {len(spoken)} recordings, {SEEDS} seeds, {OTHERS} others each")
    for heading in ("motion", "correlation", "with others", "own is larger (bar: 80 %)", "worst"):
        table.add_column(heading, justify="left" if heading == "motion" else "right")
    kinds = (
        ("alive", "", ALIVE),
        ("frozen (captured rules alone)", "", FROZEN),
        ("alive, strengths at random", "time", ALIVE),
        ("alive, times at random", "random", ALIVE),
        ("frozen, strengths at random", "time", FROZEN),
        ("frozen, times at random", "random", FROZEN),
    )
    for name, kind, profile in kinds:
        own, foreign, larger = [], [], []
        for number, (_, utterance, loudness) in enumerate(spoken):
            rng = np.random.default_rng(number)
            others = np.concatenate([e for n, (_, _, e) in enumerate(spoken) if n != number])
            starts = rng.integers(0, len(others) - len(loudness), OTHERS)
            for seed in range(SEEDS):
                said = altered(utterance, kind, rng) if kind else utterance
                played = play(character, said, profile, seed)
                speed = hand_speed(played)[played.times >= 0.0][: len(loudness)]
                true = correlation(speed, loudness)
                false = np.array(
                    [correlation(speed, others[s : s + len(loudness)]) for s in starts]
                )
                own.append(true)
                foreign.append(false.mean())
                larger.append((true > false).mean())
        each = np.array(larger).reshape(-1, SEEDS).mean(1)
        table.add_row(
            name,
            f"{np.mean(own):.2f}",
            f"{np.mean(foreign):.2f}",
            f"{100 * np.mean(larger):.0f} %",
            f"{100 * each.min():.0f} % ({spoken[int(each.argmin())][0]})",
        )
    console.print(table)


# --- the body


def longest_stillness(path: Array) -> float:
    """Return the longest time in which a path stays within `STILL_M` of where it was [s]."""
    longest = start = 0
    for number in range(len(path)):
        while np.linalg.norm(path[start : number + 1] - path[number], axis=1).max() > 2 * STILL_M:
            start += 1
        longest = max(longest, number + 1 - start)
    return longest / RATE


def knee_deg(played: Played, side: str) -> Array:
    """Return the bend of a knee, (n,) [degrees]."""
    hip, knee, foot = (played.places[side + p] for p in ("UpperLeg", "LowerLeg", "Foot"))
    upper, lower = knee - hip, foot - knee
    cosine = (upper * lower).sum(1) / np.linalg.norm(upper, axis=1) / np.linalg.norm(lower, axis=1)
    return np.asarray(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def elbow_cm(played: Played) -> Array:
    """Return how far elbows are from the line between hips and chest, (n,) [cm]."""
    low, high = played.places["hips"], played.places["chest"]
    way = (high - low) / np.linalg.norm(high - low, axis=1, keepdims=True)
    away = []
    for side in ("left", "right"):
        offset = played.places[side + "LowerArm"] - low
        away.append(np.linalg.norm(offset - (offset * way).sum(1)[:, None] * way, axis=1))
    return np.asarray(100 * np.mean(away, axis=0))


def blinks(character: Character, played: Played) -> tuple[float, float]:
    """Return the number of blinks in a minute, and the share of time with closed lids."""
    lids = Lids.of(character.morphs)
    if not lids:
        return math.nan, math.nan
    closed = np.array([lids.closure(row) for row in played.morphs]) > 0.6
    starts = int((closed[1:] & ~closed[:-1]).sum())
    return 60.0 * starts * RATE / len(closed), float(closed.mean())


def lead_ms(leader: Array, follower: Array) -> float:
    """Return by how much the first of two speeds is ahead, at their greatest correlation [ms]."""
    lags = range(-round(0.4 * RATE), round(0.4 * RATE) + 1)
    reach = max(lags)
    inner = follower[reach:-reach]
    fits = [
        np.corrcoef(leader[reach - lag : len(leader) - reach - lag], inner)[0, 1] for lag in lags
    ]
    return 1000.0 * lags[int(np.argmax(fits))] / RATE


def shifts_at_topics(played: Played, utterance: Utterance) -> tuple[int, int, int, float]:
    """Return topic changes with a shift of weight, all of them, other shifts, and seconds.

    A shift is a way of the pelvis to a side by more than 1.5 cm, beside the feet, within a second
    before to three after the boundary.
    """
    feet = (played.places["leftFoot"] + played.places["rightFoot"]) / 2
    aside = gaussian_smooth((played.places["hips"] - feet)[:, :1], 0.25 * RATE)[:, 0]
    # Ways of the smoothed pelvis between its turning points.
    speed = np.diff(aside) * RATE
    moving = np.abs(speed) > 0.015
    edges = np.flatnonzero(np.diff(np.concatenate([[0], moving.astype(int), [0]])))
    starts = [
        float(played.times[a])
        for a, b in edges.reshape(-1, 2)
        if abs(aside[min(b, len(aside) - 1)] - aside[a]) > 0.015
    ]
    topics = [p.start for p in phrases_of(utterance) if p.opens_topic]
    inside = [s for s in starts if 0.0 < s < utterance.duration]
    near = [any(-1.0 < s - t < 2.0 for s in inside) for t in topics]
    others = [s for s in inside if not any(-1.0 < s - t < 2.5 for t in topics)]
    return sum(near), len(topics), len(others), utterance.duration - 3.0 * len(topics)


def smile(character: Character, played: Played, name: str) -> float:
    """Return the mean share of an expression while something is said."""
    found = ExpressionMorphs.of(character.morphs)
    if not found:
        return math.nan
    column = found.weights[:, EXPRESSIONS.index(name)]
    inside = (played.times > 0.5) & (played.times < played.times[-1] - TAIL_S)
    return float((played.morphs[inside][:, found.numbers] @ column).mean() / column.sum())


def strangers() -> list[Character]:
    """Return the human, and a person of others without clips, with motions lent."""
    people = [load_to_play("human")]
    if STRANGER.exists():
        from cubeling.characters.retargeting.lent_motions import with_lent_motions

        bare = replace(Character.load(STRANGER), clips={})
        people.append(with_lent_motions(bare))
    return people


def body(voice: Voice, console: Console) -> None:
    """Print what the body does with a long text, frozen and alive."""
    tagged = TaggedText.read(TOPICS)
    utterance = utterance_of(say(voice, tagged.text), tagged)
    accused = utterance_of(say(voice, ACCUSATION))
    for character in strangers():
        table = Table(title=f"{character.name}: {utterance.duration:.0f} s of speech, 5 topics")
        for heading in ("", "frozen", "alive", "wanted"):
            table.add_column(heading, justify="left" if not heading else "right")
        columns = [_figures(character, utterance, accused, each) for each in (FROZEN, ALIVE)]
        wanted = {
            "longest time without a movement of an arm": "< 3.5 s",
            "blinks a minute, talking": "26",
            "blinks a minute, silent": "17",
            "shifts at changes of topic": "0.84",
            "shifts within topics": "0.04 /s",
            "feet, largest speed": "< 5 mm/s",
            "trunk ahead of the hands": "100 ms",
            "happy face in an accusation, mood happy": "no smile",
        }
        for name in columns[0]:
            table.add_row(name, columns[0][name], columns[1][name], wanted.get(name, ""))
        console.print(table)


def _figures(
    character: Character, utterance: Utterance, accused: Utterance, profile: SpeechProfile
) -> dict[str, str]:
    played = play(character, utterance, profile)
    inside = (played.times > 0.0) & (played.times < utterance.duration)
    hips = played.places["hips"][inside]
    knees = np.stack([knee_deg(played, side)[inside] for side in ("left", "right")])
    chest = played.places["chest"]
    still = [
        longest_stillness((played.places[s + "Hand"] - chest)[inside]) for s in ("left", "right")
    ]
    talking, closed = blinks(character, played)
    silent, _ = blinks(character, play(character, None, profile, 7, seconds=120.0))
    topics = np.array(
        [shifts_at_topics(play(character, utterance, profile, s), utterance) for s in range(5)]
    ).sum(0)
    feet = [speeds(played.places[s + p]) for s in ("left", "right") for p in ("Foot", "Toes")
            if s + p in played.places]  # fmt: skip
    happy = play(character, accused, profile, emotion=Emotion(0.7, 0.4, "happy"))
    lean = np.abs(np.gradient(gaussian_smooth(played.hips_deg[:, None], 2)[:, 0]))[inside]
    return {
        "hips, range aside": f"{100 * np.ptp(hips[:, 0]):.1f} cm",
        "hips, way in a minute": f"{60 * 100 * speeds(hips).mean():.0f} cm",
        "knees, range": f"{np.ptp(knees, axis=1).mean():.1f}°",
        "elbows from the middle of the trunk": f"{elbow_cm(played)[inside].mean():.1f} cm",
        "longest time without a movement of an arm": f"{max(still):.1f} s",
        "blinks a minute, talking": f"{talking:.0f}",
        "blinks a minute, silent": f"{silent:.0f}",
        "lids closed, talking": f"{100 * closed:.1f} %",
        "shifts at changes of topic": f"{topics[0] / topics[1]:.2f}",
        "shifts within topics": f"{topics[2] / topics[3]:.3f} /s",
        "feet, largest speed": f"{1000 * max(f[inside].max() for f in feet):.1f} mm/s",
        "trunk ahead of the hands": f"{lead_ms(lean, hand_speed(played)[inside]):.0f} ms",
        "happy face in an accusation, mood happy": f"{smile(character, happy, 'happy'):.2f}",
        "angry face in an accusation, mood happy": f"{smile(character, happy, 'angry'):.2f}",
    }
