"""How a check ends that does not pass."""


class CheckFailed(Exception):  # noqa: N818 # as unittest's failureException: a result, not a fault
    """The robot does not meet a requirement: what it should have done, and what it did."""

    def __init__(self, expected: str, received: str) -> None:
        super().__init__(f"expected {expected}; received {received}")
        self.expected = expected
        self.received = received


class NoAnswerError(CheckFailed):
    """A robot that answered before no longer answers HELLO."""


class NotApplicableError(Exception):
    """The robot lacks what the check needs."""
