"""A test that takes clearly more than a second of CPU is named, unless it names its reason."""

from pathlib import Path

import pytest

from tests.cost import LIMIT_S, NOISE, CostCheck

TOO_LONG, LONG = 1.1 * NOISE * LIMIT_S, 0.9 * NOISE * LIMIT_S

SUITE = f"""
import pytest

@pytest.fixture(scope="session")
def spend(pytestconfig):
    return pytestconfig.spend

@pytest.fixture(scope="module")
def shared(spend):
    spend({TOO_LONG})

@pytest.fixture
def own(spend):
    spend({TOO_LONG})

def test_call(spend): spend({TOO_LONG})

def test_own_fixture(own): pass

def test_shared_fixture(shared): pass

def test_within_noise(shared, spend): spend({LONG})

@pytest.mark.slow(reason="a day of traffic")
def test_with_a_reason(spend): spend({TOO_LONG})

@pytest.mark.full
def test_not_of_every_change(spend): spend({TOO_LONG})
"""


class Clock:
    """A clock that goes on where a test says so."""

    now = 0.0

    def __call__(self) -> float:
        return self.now

    def pytest_configure(self, config) -> None:
        config.spend = self.spend

    def spend(self, seconds: float) -> None:
        self.now += seconds


def run(folder: Path, strict: bool, suite: str = SUITE) -> tuple[int, CostCheck]:
    (folder / f"{folder.name}.py").write_text(suite)
    (folder / "pytest.ini").write_text("[pytest]\nmarkers =\n    slow: why\n    full: rarely\n")
    clock = Clock()
    check = CostCheck(strict, clock)
    arguments = ["--import-mode=importlib", "-p", "no:xdist", "-p", "no:cacheprovider"]
    return pytest.main(
        [*arguments, "--rootdir", str(folder), str(folder)], plugins=[clock, check]
    ), check


def test_only_what_a_test_spends_by_itself_needs_a_reason(tmp_path, capsys):
    code, check = run(tmp_path, strict=True)
    names = {name.split("::")[1] for name in check.long}
    assert names == {"test_call", "test_own_fixture"}
    assert code == pytest.ExitCode.TESTS_FAILED
    assert "test_own_fixture" in capsys.readouterr().out


def test_elsewhere_than_in_ci_it_is_only_said(tmp_path, capsys):
    code, _ = run(tmp_path, strict=False)
    assert code == pytest.ExitCode.OK
    assert "test_call" in capsys.readouterr().out


def test_a_suite_of_short_tests_passes_without_a_word(tmp_path, capsys):
    code, _ = run(tmp_path, strict=True, suite="def test_short(): pass")
    assert code == pytest.ExitCode.OK
    assert "CPU" not in capsys.readouterr().out
