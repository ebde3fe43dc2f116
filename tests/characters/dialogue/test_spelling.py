"""Words as children write them are read as those that sound so."""

import pytest

from cubeling.app.scenarios.talk import Talk


@pytest.mark.parametrize(
    ("language", "typed", "meant"),
    [
        ("en", "wat is yor nam", "what is your name"),
        ("en", "tel me a jok", "tell me a joke"),
        ("en", "do you like trisseratops", "do you like triceratops"),
        ("es", "ola komo te yamas", "hola como te llamas"),
        ("es", "ke comes", "que comes"),
        ("es", "puedes rujir", "puedes rugir"),
        ("es", "muerdes a la jente", "muerdes a la gente"),
        ("en", "asdfgh qwertz", "asdfgh qwertz"),
    ],
)
def test_words_are_read_as_they_sound(language, typed, meant):
    corrected = Talk.script.spelling.correct(tuple(typed.split()), language)
    assert " ".join(corrected) == meant
