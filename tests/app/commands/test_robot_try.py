"""`cubeling robot try`: what a robot makes of each mood, in a line each."""


def test_every_mood_is_tried_and_what_came_of_it_told(cubeling):
    code, out, _ = cubeling("robot", "try", "sim:cubeling", "--seconds", "0.3")
    assert code == 0
    lines = out.splitlines()
    assert "moods neutral, happy, angry" in lines[0]
    assert [line.split()[0] for line in lines[1:]] == ["neutral", "happy", "angry", "neutral"]
    assert all("acknowledged 0." in line and "shown 0." in line for line in lines[1:])


def test_a_robot_that_does_not_say_what_it_shows_is_not_believed_to_show_it(cubeling):
    code, out, _ = cubeling("robot", "try", "sim:pleo", "--mood", "happy", "--seconds", "0.1")
    assert code == 0
    assert "it does not say what it shows" in out


def test_a_mood_that_the_robot_does_not_have_is_refused_and_the_others_named(cubeling):
    code, _, err = cubeling("robot", "try", "sim:cubeling", "--mood", "furious")
    assert code == 2
    assert "no mood 'furious': neutral, happy, angry" in err


def test_a_time_that_is_none_is_refused(cubeling):
    for seconds in ("0", "nan", "1e9"):
        code, _, err = cubeling("robot", "try", "sim:cubeling", "--seconds", seconds)
        assert code == 2
        assert "0.1 to 3600 seconds" in err


def test_what_the_robot_complains_of_is_told_in_its_own_words(cubeling, tmp_path):
    (tmp_path / "mine.toml").write_text('[moods.neutral]\nmotion = "[red]x"\nlength_s = 9\n')
    args = ("--settings", str(tmp_path / "mine.toml"), "--mood", "neutral", "--seconds", "1.5")
    code, out, _ = cubeling("robot", "try", "sim:pleo", *args)
    assert code == 0
    assert "not acknowledged" in out
    assert "it complains: Error: file not found: [red]x" in out
