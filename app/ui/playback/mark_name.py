"""The name of a mark, as it is typed after the key B."""

NAMING_S = 4.0
"""How long a mark waits for the first key of its name [s]; then keys mean what they always do."""

MAX_NAME_CHARS = 60


class MarkName:
    """Takes a digit, or Enter and a name that Enter ends.

    >>> naming = MarkName(0.0)
    >>> [naming.press(key, 1.0) for key in ("Enter", "F", "E", "Backspace", "E", "L", "L", "Enter")]
    [True, True, True, True, True, True, True, True]
    >>> naming.text, naming.done
    ('fell', True)
    >>> MarkName(0.0).press("R", 1.0), MarkName(0.0).press("2", 5.0)
    (False, False)
    """

    def __init__(self, now: float) -> None:
        self.text = ""
        """What was typed so far."""
        self.typing = False
        """Whether letters are text now."""
        self.done = False
        """Whether that is all."""
        self._began_s = now

    def press(self, key: str, now: float) -> bool:
        """Take a key at a time [s]; return False if it is none of a name, or comes too late."""
        if self.typing:
            return self._type(key)
        if now - self._began_s > NAMING_S:
            return False
        if key.isdigit():
            self.text, self.done = key, True
        elif key == "Enter":
            self.typing = True
        else:
            return False
        return True

    def _type(self, key: str) -> bool:
        if len(key) == 1 and key.isalnum() and len(self.text) < MAX_NAME_CHARS:
            self.text += key.lower()
        elif key == "Space" and self.text:
            self.text += " "
        elif key == "Backspace":
            self.text = self.text[:-1]
        elif key in ("Enter", "Esc"):
            self.text = "" if key == "Esc" else self.text.strip()
            self.done = True
        return True
