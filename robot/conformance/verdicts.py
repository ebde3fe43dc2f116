"""How a check ends when it does not end well."""


class UnmetError(Exception):
    """A robot does not do what is required.

    Parameters
    ----------
    expected
        What it should have done.
    came
        What it did.
    """

    def __init__(self, expected: str, came: str) -> None:
        super().__init__(f"expected {expected}; came {came}")
        self.expected = expected
        self.came = came


class SilentError(UnmetError):
    """A robot that answered before does not even answer a greeting any more."""


class NotApplicableError(Exception):
    """A robot has nothing that a check could try."""
