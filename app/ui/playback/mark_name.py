"""The name of a mark, as it is typed after the key B."""

NAMING_S = 4.0
"""How long a mark waits for the next key of its name [s]; then keys mean what they always do."""

MAX_NAME_CHARS = 60


class MarkName:
    """Takes a digit, or a name that Enter ends.

    >>> naming = MarkName(0.0)
    >>> [naming.press(key, 1.0) for key in ("F", "E", "Backspace", "E", "L", "L", "Enter")]
    [True, True, True, True, True, True, True]
    >>> naming.text, naming.done
    ('fell', True)
    """

    def __init__(self, now: float) -> None:
        self.text = ""
        """What was typed so far."""
        self.done = False
        """Whether that is all."""
        self._last_s = now

    def press(self, key: str, now: float) -> bool:
        """Take a key at a time [s]; return False if it is none of a name, or comes too late."""
        late, self._last_s = now - self._last_s > NAMING_S, now
        if late:
            return False
        if key.isdigit() and not self.text:
            self.text, self.done = key, True
        elif len(key) == 1 and key.isalnum() and len(self.text) < MAX_NAME_CHARS:
            self.text += key.lower()
        elif key == "Space" and self.text:
            self.text += " "
        elif key == "Backspace":
            self.text = self.text[:-1]
        elif key in ("Enter", "Esc"):
            self.text = "" if key == "Esc" else self.text.strip()
            self.done = True
        else:
            return False
        return True
