"""Feelings obey their law exactly, stay in the plane, come home, and do not chatter."""

import dataclasses
import itertools
import math

import pytest
from hypothesis import given, strategies as st

from cubeling.affect import LABEL_SETS, Emotion, Feelings, Personality
from cubeling.affect.dynamics import MAX_TIME_STEP_S
from cubeling.affect.errors import AffectError
from cubeling.affect.impulses import AffectImpulse
from cubeling.affect.personality_file import bundled_names
from cubeling.affect.words import closest_word
from tests.examples import some

FRAME_S = 1 / 30

axis = st.floats(-1, 1)
half_lives = st.one_of(st.floats(0.05, 200), st.just(math.inf))
pushes = st.builds(AffectImpulse, st.floats(-10, 10), st.floats(-10, 10))
jolts = st.builds(AffectImpulse, st.floats(-2, 2), st.floats(-2, 2))
personalities = st.builds(
    Personality,
    name=st.just("anyone"),
    temperament=st.builds(Emotion, axis, axis),
    valence_half_life=half_lives,
    arousal_half_life=half_lives,
    gains=st.fixed_dictionaries({"kiss": pushes, "shout": pushes}),
    events=st.fixed_dictionaries({"shaken": jolts}),
    movement=st.floats(-2, 2),
    arousal=st.sampled_from(["own", "magnitude"]),
    labels=st.sampled_from(sorted(LABEL_SETS)),
    hysteresis=st.floats(0, 0.25),
    dwell=st.floats(0, 3),
)
doings = st.tuples(
    st.sampled_from(["idle", "kiss", "shout", "dance"]), axis, st.floats(0, 1.5), st.floats(0, 8)
)


ORIGIN = Emotion(0.0, 0.0)


def still(temperament: Emotion = ORIGIN, **numbers: object) -> Personality:
    """Who never moves by itself: an event puts the feeling anywhere, and there it stays."""
    events = {"valence": AffectImpulse(valence=1.0), "arousal": AffectImpulse(arousal=1.0)}
    events |= {"unpleasant": AffectImpulse(valence=-1.0), "calming": AffectImpulse(arousal=-1.0)}
    who = Personality(
        "still", "", temperament, math.inf, math.inf, events=events, labels="circumplex"
    )
    return dataclasses.replace(who, **numbers)  # type: ignore[arg-type]


def put(feelings: Feelings, valence: float, arousal: float) -> None:
    """Bring a still feeling to a point of the plane."""
    ways = [("valence", "unpleasant", valence - feelings.emotion.valence)]
    ways += [("arousal", "calming", arousal - feelings.emotion.arousal)]
    for up, down, way in ways:
        while abs(way) > 1e-15:
            step = min(1.0, abs(way))
            feelings.apply_event(up if way > 0 else down, step)
            way = math.copysign(abs(way) - step, way)


@given(personalities, st.lists(doings, max_size=40), st.lists(st.floats(0, 1), max_size=5))
def test_whatever_is_done_to_whomever_the_feeling_stays_in_the_plane(who, done, jolted):
    feelings, now = Feelings(who), 0.0
    strikes = iter(jolted)
    labels = [feelings.update("idle", 0, now).label]
    for action, weight, later, speed in done:
        now += later
        feelings.apply_event("shaken", next(strikes, 0.0))
        mood = feelings.update(action, weight, now, speed)
        assert -1 <= mood.valence <= 1
        assert -1 <= mood.arousal <= 1
        assert mood.label in who.label_set.places
        labels.append(mood.label)
    hub = who.label_set.hub
    if hub is not None:
        for one, other in itertools.pairwise(labels):
            assert hub in (one, other) or one == other


@given(st.lists(st.tuples(st.sampled_from(["idle", "kiss", "shout"]), axis, st.floats(0, 2))))
def test_the_thesis_personality_integrates_its_gains_without_decay(done):
    """The law of specification M11, written out: rate 0.1·(1 + w)/2, kisses up, shouts down."""
    feelings, now, value = Feelings("thesis"), 3.7, 0.0
    feelings.update("idle", 0.0, now)
    for action, weight, later in done:
        now += later
        gain = {"kiss": 0.1, "shout": -0.1, "idle": 0.0}[action]
        value += gain * (1.0 + weight) / 2.0 * min(later, MAX_TIME_STEP_S)
        value = min(max(value, -1.0), 1.0)
        emotion = feelings.update(action, weight, now)
        assert emotion.valence == pytest.approx(value, abs=1e-9)
        assert emotion.arousal == abs(emotion.valence)


@given(
    personalities,
    axis,
    st.floats(0, 5),
    st.lists(st.floats(0.001, 0.05), min_size=2, max_size=9),
    st.floats(0, 1),
)
def test_the_feeling_does_not_depend_on_how_time_is_cut(who, weight, speed, cuts, jolt):
    times = [0.0, *itertools.accumulate(cuts)]
    moods = []
    for cut in (times, [times[0], times[-1]]):
        feelings = Feelings(who)
        feelings.apply_event("shaken", jolt)
        moods.append([feelings.update("kiss", weight, time, speed) for time in cut][-1])
    assert times[-1] <= MAX_TIME_STEP_S
    assert moods[0].valence == pytest.approx(moods[1].valence, abs=1e-12)
    assert moods[0].arousal == pytest.approx(moods[1].arousal, abs=1e-12)


@pytest.mark.parametrize("half_life", [0.1, 0.5, 7.0, 60.0])
def test_after_a_half_life_half_the_way_home_is_made(half_life):
    home = Emotion(-0.2, 0.1)
    push = AffectImpulse(valence=1.0, arousal=-0.8)
    who = Personality("w", "", home, half_life, 2 * half_life, events={"jolt": push})
    feelings = Feelings(who)
    feelings.update("idle", 0, 0.0)
    feelings.apply_event("jolt")
    steps = math.ceil(half_life / MAX_TIME_STEP_S)
    moods = [feelings.update("idle", 1, half_life * (i + 1) / steps) for i in range(2 * steps)]
    assert moods[steps - 1].valence == pytest.approx(-0.2 + 0.5, abs=1e-12)
    assert moods[-1].valence == pytest.approx(-0.2 + 0.25, abs=1e-12)
    assert moods[-1].arousal == pytest.approx(0.1 - 0.4, abs=1e-12)


def test_a_very_long_half_life_comes_to_the_same_as_none():
    gains = {"kiss": AffectImpulse(0.1, 0.2)}
    slow, never = (
        Feelings(Personality("w", "", Emotion(0, 0), time, time, gains))
        for time in (1e12, math.inf)
    )
    for frame in range(60):
        one = slow.update("kiss", 0.3, frame * FRAME_S)
        other = never.update("kiss", 0.3, frame * FRAME_S)
    assert one.valence == pytest.approx(other.valence, abs=1e-10)
    assert one.arousal == pytest.approx(other.arousal, abs=1e-10)


def test_movement_moves_the_home_of_the_arousal_and_nothing_else():
    who = Personality("w", "", Emotion(0.1, -0.2), 5.0, 0.2, movement=0.5)
    feelings = Feelings(who)
    for frame in range(120):
        mood = feelings.update("move", 0.0, frame * FRAME_S, speed=2.5)
    assert mood.arousal == pytest.approx(-0.2 + 0.25, abs=1e-4)
    assert mood.valence == pytest.approx(0.1)


@given(st.lists(st.floats(0, 8), min_size=1, max_size=20))
def test_the_thesis_personality_walks_as_awake_as_the_follow_scenario_has_it(speeds):
    feelings = Feelings("thesis")
    for frame, speed in enumerate(speeds):
        mood = feelings.update("move", 0.0, frame * FRAME_S, speed)
        assert (mood.valence, mood.arousal) == (0.0, min(max(speed / 5.0, 0.0), 1.0))
        assert mood.label == "neutral"


@pytest.mark.parametrize("name", ["circumplex", "ekman", "occ"])
@pytest.mark.parametrize("hysteresis", [0.0, 0.04])
def test_at_rest_at_a_place_its_own_label_is_shown(name, hysteresis):
    places = LABEL_SETS[name].places
    for label, place in places.items():
        feelings = Feelings(still(Emotion(*place), labels=name, hysteresis=hysteresis))
        shown = [feelings.update("idle", 0, time).label for time in (0, 1, 2)]
        same = [word for word, there in places.items() if there == place]
        assert shown[-1] == (same[0] if math.dist(place, (0, 0)) > 2 * hysteresis else "neutral")
        assert label in same


@given(
    st.sampled_from(["circumplex", "ekman", "occ", "thesis"]),
    st.tuples(axis, axis),
    st.lists(st.tuples(st.floats(0, 1), st.floats(0, math.tau)), min_size=4, max_size=40),
    st.floats(0.01, 0.15),
)
def test_noise_smaller_than_the_hysteresis_brings_back_no_label_that_was_left(
    name, centre, noise, hysteresis
):
    amplitude = 0.98 * hysteresis * (0.5 if name == "thesis" else 1.0)
    who = still(labels=name, hysteresis=hysteresis)
    feelings = Feelings(who)
    shown = []
    for frame, (size, way) in enumerate(noise):
        radius = amplitude * size
        point = (centre[0] + radius * math.cos(way), centre[1] + radius * math.sin(way))
        put(feelings, *(min(max(each, -1.0), 1.0) for each in point))
        shown.append(feelings.update("idle", 0, frame * FRAME_S).label)
    hub = who.label_set.hub
    visits = [label for label, _ in itertools.groupby(shown) if label != hub]
    assert len(visits) == len(set(visits))
    assert len([label for label, _ in itertools.groupby(shown)]) <= 2 * len(set(visits)) + 1


def test_without_hysteresis_the_same_noise_chatters():
    feelings = Feelings(still(hysteresis=0.0))
    shown = []
    for frame in range(20):
        put(feelings, 0.4 + (0.01 if frame % 2 else -0.01), 0.0)
        shown.append(feelings.update("idle", 0, frame * FRAME_S).label)
    assert len(list(itertools.groupby(shown))) == 20


@pytest.mark.parametrize("hysteresis", [0.0, 0.03, 0.1])
def test_a_label_gives_way_where_the_feeling_is_past_the_border_by_the_hysteresis(hysteresis):
    feelings = Feelings(still(hysteresis=hysteresis))
    border = 0.4  # half way from neutral, at 0, to pleased, at 0.8
    there, back = border + hysteresis, border - hysteresis
    shown: list[str] = []
    for valence in (there - 0.001, there + 0.001, back + 0.001, back - 0.001):
        put(feelings, valence, 0.0)
        shown.append(feelings.update("idle", 0, float(len(shown))).label)
    assert shown == ["neutral", "pleased", "pleased", "neutral"]


def test_the_thesis_words_have_the_hysteresis_of_their_personality():
    for hysteresis, word in ((0.05, "happy"), (0.01, "neutral")):
        feelings = Feelings(still(labels="thesis", hysteresis=hysteresis))
        put(feelings, 0.34, 0.0)
        assert feelings.update("idle", 0, 0.0).label == "happy"
        put(feelings, 0.30, 0.0)
        assert feelings.update("idle", 0, 1.0).label == word


def test_a_label_lasts_as_long_as_its_dwell_and_no_longer():
    feelings = Feelings(still(labels="ekman", dwell=1.0))
    seen = []
    for tick in range(0, 400, 25):
        put(feelings, *((0.7, 0.4) if tick < 50 else (-0.6, -0.5)))
        seen.append(feelings.update("idle", 0, tick / 100).label)
    turns = [(label, len(list(run))) for label, run in itertools.groupby(seen)]
    assert turns == [("happy", 4), ("neutral", 4), ("sad", 8)]


@given(personalities, st.lists(doings, min_size=5, max_size=60))
def test_no_label_is_left_before_its_time(who, done):
    feelings, now = Feelings(who), 0.0
    shown = [(0.0, feelings.update("idle", 0, now).label)]
    for action, weight, later, speed in done:
        now += later
        label = feelings.update(action, weight, now, speed).label
        if label != shown[-1][1]:
            shown.append((now, label))
    for (one, _), (other, _) in itertools.pairwise(shown[1:]):
        assert other - one >= who.dwell


@pytest.mark.parametrize("name", bundled_names())
@pytest.mark.parametrize(("action", "mood"), some([("kiss", "happy"), ("shout", "angry")]))
def test_everyone_can_be_pleased_and_angered_and_comes_home(name, action, mood):
    feelings = Feelings(name)
    reached = None
    for frame in range(round(30 / FRAME_S)):
        now = feelings.update(action, 1.0, frame * FRAME_S)
        if reached is None and closest_word(("neutral", "happy", "angry"), now) == mood:
            reached = frame * FRAME_S
    assert reached is not None
    assert 3.0 <= reached <= 20.0
    for frame in range(round(30 / FRAME_S), round(400 / FRAME_S)):
        now = feelings.update("idle", 0.0, frame * FRAME_S)
    if name == "thesis":
        assert (now.valence, now.label) == ((1.0, "happy") if mood == "happy" else (-1.0, "angry"))
    else:
        home = feelings.personality.temperament
        assert now.valence == pytest.approx(home.valence, abs=0.01)
        assert now.arousal == pytest.approx(home.arousal, abs=0.01)
        assert now.label == "neutral"


def test_the_bundled_personalities_differ_to_see():
    """After the same half minute no two of them are near each other in the plane."""
    paths = {}
    for name in bundled_names():
        feelings, path = Feelings(name), []
        for frame in range(round(30 / FRAME_S)):
            action = ("idle", "kiss", "idle", "shout", "idle")[int(frame * FRAME_S / 6)]
            mood = feelings.update(action, 0.5, frame * FRAME_S)
            path.append((mood.valence, mood.arousal))
        paths[name] = path
    for one, other in itertools.combinations(paths, 2):
        apart = [math.dist(a, b) for a, b in zip(paths[one], paths[other], strict=True)]
        assert sum(apart) / len(apart) > 0.15, (one, other)


def test_an_event_strikes_at_once_and_one_that_is_not_known_does_nothing():
    feelings = Feelings("shy")
    home = feelings.update("idle", 0, 0.0)
    assert not feelings.apply_event("struck by lightning")
    assert feelings.update("idle", 0, 0.0) == home
    assert feelings.apply_event("shaken", 0.5)
    struck = feelings.update("idle", 0, 0.0)
    assert struck.valence == pytest.approx(home.valence - 0.15)
    assert struck.arousal == pytest.approx(home.arousal + 0.3)


def test_a_long_gap_counts_as_a_short_one():
    feelings = Feelings("thesis")
    feelings.update("kiss", 1, 0.0)
    assert feelings.update("kiss", 1, 60.0).valence == pytest.approx(0.1 * MAX_TIME_STEP_S)


@pytest.mark.parametrize(
    ("weight", "timestamp", "speed", "says"),
    [
        (1.5, 1, 0, "the weight of 'kiss' must be from -1 to 1"),
        (math.nan, 1, 0, "the weight of 'kiss'"),
        (0, 1, -1, "the speed must be from 0"),
        (0, 1, math.nan, "the speed"),
        (0, -1, 0, "cannot go back"),
        (0, math.nan, 0, "cannot go back"),
        (0, math.inf, 0, "cannot go back"),
    ],
)
def test_nonsense_is_refused_in_one_line_and_changes_nothing(weight, timestamp, speed, says):
    feelings = Feelings("thesis")
    feelings.update("idle", 0, 0.0)
    with pytest.raises(AffectError, match=says) as refusal:
        feelings.update("kiss", weight, timestamp, speed)
    assert "\n" not in str(refusal.value)
    assert feelings.update("kiss", 1, 0.1).valence == pytest.approx(0.01)


@pytest.mark.parametrize("strength", [-0.1, 1.1, math.nan])
def test_an_event_of_nonsensical_strength_is_refused(strength):
    with pytest.raises(AffectError, match="strength of 'shaken' must be from 0 to 1"):
        Feelings("lively").apply_event("shaken", strength)
