"""The mixer: to the sample, never too loud, and with a bounded number of sounds."""

import numpy as np
import pytest
from hypothesis import given, settings, strategies as st

from cubeling.app.sound import Cue, Mixer, SoundBank
from cubeling.app.sound.mixer import CEILING, FADE_OUT, KNEE, MAX_SOUNDS
from tests.examples import examples

RAMP = np.linspace(0.1, 0.5, 1000)


def mixer(volume=1.0, **own):
    return Mixer(SoundBank({name: [np.asarray(s)] for name, s in own.items()}), volume)


def test_a_cue_begins_with_the_next_sample_and_ends_by_itself():
    mix = mixer(ramp=RAMP)
    assert not mix.render(100).any()
    mix.start(Cue("ramp"))
    heard = np.concatenate([mix.render(700), mix.render(700)])
    half = np.sqrt(0.5)
    np.testing.assert_allclose(heard[:1000], half * RAMP[:, None].repeat(2, 1), rtol=1e-6)
    assert not heard[1000:].any()


@given(
    blocks=st.lists(st.integers(0, 700), min_size=1, max_size=12),
    gains=st.lists(st.floats(0, 1), min_size=1, max_size=4),
)
@settings(max_examples=examples(40), deadline=None)
def test_the_size_of_the_blocks_does_not_matter(blocks, gains):
    one, many = mixer(ramp=RAMP), mixer(ramp=RAMP)
    for gain in gains:
        for mix in (one, many):
            mix.start(Cue("ramp", gain, pan=gain - 0.5, rate=1.0 + gain))
    parts = [many.render(count) for count in blocks]
    np.testing.assert_array_equal(one.render(sum(blocks)), np.concatenate(parts))


@pytest.mark.parametrize("volume", [0.0, 0.5, 1.0])
def test_nothing_is_louder_than_the_ceiling(volume):
    mix = mixer(volume, loud=np.full(300, 0.9))
    for _ in range(10):
        mix.start(Cue("loud"))
    heard = np.abs(mix.render(300))
    assert heard.max() <= volume * CEILING
    assert heard.max() >= volume * KNEE


def test_a_sound_at_the_side_is_as_loud_as_in_the_middle():
    powers = []
    for pan in (-1.0, -0.3, 0.0, 1.0):
        mix = mixer(ramp=RAMP)
        mix.start(Cue("ramp", pan=pan))
        left, right = (mix.render(1000) ** 2).sum(axis=0)
        powers.append(left + right)
        assert (left > right) == (pan < 0) or pan == 0
    assert powers == pytest.approx([powers[0]] * 4, rel=1e-5)


def test_a_higher_rate_is_shorter():
    mix = mixer(ramp=RAMP)
    mix.start(Cue("ramp", rate=2.0))
    assert np.flatnonzero(mix.render(1000)[:, 0])[-1] == pytest.approx(499, abs=1)


def test_variants_take_turns():
    mix = Mixer(SoundBank({"a": [np.full(10, 0.1), np.full(10, 0.2)]}))
    heard = []
    for number in range(3):
        mix.start(Cue("a", variant=number))
        heard.append(float(mix.render(10)[0].sum()))
    assert heard[0] == heard[2] != heard[1]


def test_unknown_sounds_are_silent_and_their_number_is_bounded():
    mix = mixer(ramp=RAMP)
    mix.start(Cue("wave"))
    assert not mix.render(10).any()
    for _ in range(1000):
        mix.start(Cue("ramp"))
    mix.render(1)
    assert len(mix._playing) == MAX_SOUNDS


def test_a_new_speech_takes_the_place_of_the_old_one_which_fades():
    mix = mixer()
    mix.say(np.full(5000, 0.4), pan=-1.0)
    first = mix.render(1000)
    assert np.abs(first[:, 0] - 0.4).max() < 1e-6
    mix.say(np.full(500, 0.2), pan=1.0)
    left, right = mix.render(3000).T
    assert np.abs(right[:500] - 0.2).max() < 1e-6
    assert not right[500:].any()
    assert left[0] > 0.39
    assert np.abs(np.diff(left)).max() < 0.001  # no click
    assert not left[FADE_OUT:].any()


def test_silence_ends_a_speech():
    mix = mixer()
    mix.say(np.full(5000, 0.4))
    mix.render(100)
    mix.say(np.zeros(0))
    assert not mix.render(3000)[FADE_OUT:].any()
