"""Faults of section 3: which bodies are skipped, and what is read from those that are not."""

from tests.robot.conformance.planted.robot import PlantedFault as Fault

_LIMITS = """    for index, low, high in limits:
        if not low <= values[index] <= high:
            return None
"""
_TOO_SHORT = "    if size < first:\n        return None\n"
_UNKNOWN = "    if known is None:\n        return None\n"
_DEFAULTS = "                body[start + index] = defaults[index]\n"
_MOOD = "self._apply(kind, values, now)"
_EXPRESS = '"<BHIhhB", 11, ((12, b\'\\xff\'),)'

BODIES = (
    Fault("short bodies filled up with what the buffer holds", "", (("codec", _TOO_SHORT, ""),)),
    Fault(
        "short bodies filled up with zeros",
        "",
        (("codec", _TOO_SHORT, "    for index in range(size, first):\n        body[index] = 0\n"),),
    ),
    Fault("body one byte too short taken", "", (("codec", "size < first:", "size < first - 1:"),)),
    Fault("longer bodies skipped", "", (("codec", _TOO_SHORT, "    longest = later[-1][0] if later else first\n    if not first <= size <= longest:\n        return None\n"),)),
    Fault("longer HELLO skipped", "", (("codec", _TOO_SHORT, _TOO_SHORT + "    if body[0] == 1 and size > first:\n        return None\n"),)),
    Fault("longer BEAT skipped", "", (("codec", _TOO_SHORT, _TOO_SHORT + "    if body[0] == 3 and size > first:\n        return None\n"),)),
    Fault("longer PLAY skipped", "", (("codec", _TOO_SHORT, _TOO_SHORT + "    if body[0] == 0x11 and size > first:\n        return None\n"),)),
    Fault("longer STOP skipped", "", (("codec", _TOO_SHORT, _TOO_SHORT + "    if body[0] == 0x12 and size > first:\n        return None\n"),)),
    Fault("longer BYE skipped", "", (("codec", _TOO_SHORT, _TOO_SHORT + "    if body[0] == 0x1F and size > first:\n        return None\n"),)),
    Fault("longer ASK skipped", "", (("codec", _TOO_SHORT, _TOO_SHORT + "    if body[0] == 2 and size > first:\n        return None\n"),)),
    Fault("longer MOVE skipped", "", (("codec", _TOO_SHORT, _TOO_SHORT + "    if body[0] == 0x13 and size > first:\n        return None\n"),), versions=(3,)),
    Fault("no limits of fields", "", (("codec", _LIMITS, ""),)),
    Fault("no lower limits of fields", "", (("codec", "not low <= values[index] <= high", "values[index] > high"),)),
    Fault("no upper limits of fields", "", (("codec", "not low <= values[index] <= high", "values[index] < low"),)),
    Fault("limits one count too wide", "", (("messages", "(3, -10000, 10000)", "(3, -10001, 10001)"),)),
    Fault("limits exclusive", "", (("codec", "low <= values[index] <= high", "low - (low > -10000) < values[index] < high + (high < 10000 or high > 10000)"),)),
    Fault("arousal without limits", "", (("messages", "(4, -10000, 10000)", "(4, -32768, 32767)"),)),
    Fault("HELLO of version 0 answered", "", (("messages", "((2, 1, 255), (3, 1,", "((2, 0, 255), (3, 1,"),)),
    Fault("HELLO of host 0 answered", "", (("messages", "((2, 1, 255), (3, 1,", "((2, 1, 255), (3, 0,"),)),
    Fault("EXPRESS with number 0 acknowledged", "", (("messages", "((2, 1, 4294967295), (3, -10000", "((2, 0, 4294967295), (3, -10000"),)),
    Fault("PLAY with number 0 acknowledged", "", (("messages", "((2, 1, 4294967295), (3, 1, 2))", "((2, 0, 4294967295), (3, 1, 2))"),)),
    Fault("STOP with number 0 acknowledged", "", (("messages", '    0x12: ("<BHI", 7, (),\n           ((2, 1,', '    0x12: ("<BHI", 7, (),\n           ((2, 0,'),)),
    Fault("MOVE with number 0 acknowledged", "", (("messages", '    0x13: ("<BHIHHH16h", 45, (),\n           ((2, 1,', '    0x13: ("<BHIHHH16h", 45, (),\n           ((2, 0,'),), versions=(3,)),
    Fault("PLAY of item 0 answered", "", (("messages", "(3, 1, 2))", "(3, 0, 2))"),)),
    Fault("PLAY of item 3 answered", "", (("messages", "(3, 1, 2))", "(3, 1, 3))"),)),
    Fault("fields clamped to their limits", "", (("codec", _LIMITS, "    clamped = list(values)\n    for index, low, high in limits:\n        clamped[index] = min(max(values[index], low), high)\n    values = tuple(clamped)\n"),)),
    # --- numbers of messages
    Fault("unknown messages of other sessions answered by GONE", "", (("codec", _UNKNOWN, "    if known is None:\n        return (0, body[1] | body[2] << 8)\n"), ("session", "        self._last_received = now\n        if kind == m.BEAT:", "        if not kind:\n            return\n        self._last_received = now\n        if kind == m.BEAT:"))),
    Fault("unknown messages keep a session open", "", (("codec", _UNKNOWN, "    if known is None:\n        return (0, body[1] | body[2] << 8)\n"), ("session", "        if kind == m.BEAT:", "        if not kind:\n            return\n        if kind == m.BEAT:"), ("session", "        if not self.number or session != self.number:", "        if not kind and session != self.number:\n            return\n        if not self.number or session != self.number:"))),
    Fault("unknown messages refused by ACK", "", (("codec", _UNKNOWN, "    if known is None:\n        return (0, body[1] | body[2] << 8)\n"), ("session", "        if kind == m.BEAT:", "        if not kind:\n            self._send(m.ACK, max(self._taken, 1), 1)\n            return\n        if kind == m.BEAT:"), ("session", "        if not self.number or session != self.number:", "        if not kind and session != self.number:\n            return\n        if not self.number or session != self.number:"))),
    Fault("highest bit of the message's number ignored", "", (("codec", "FROM_HOST.get(body[0])", "FROM_HOST.get(body[0] & 0x7F)"), ("codec", "    return values\n\n\ndef pack", "    return (values[0] & 0x7F,) + values[1:]\n\n\ndef pack"))),
    Fault("echo of STATE taken for a BEAT", "", (("codec", "    known = FROM_HOST", "    if body[0] == 0x84:\n        body[0] = 3\n    known = FROM_HOST"),)),
    # --- versions of bodies
    Fault("EXPRESS of version 1 skipped", "", (("messages", _EXPRESS, "\"<BHIhhB\", 12, ()"),), versions=(2, 3)),
    Fault("EXPRESS of version 1 keeps the mood that was in the buffer", "", (("codec", _DEFAULTS, "                pass\n"),), versions=(2, 3)),
    Fault("EXPRESS of version 1 names mood 0", "", (("messages", "b'\\xff'", "b'\\x00'"),), versions=(2, 3)),
    Fault(
        "EXPRESS of version 1 keeps the mood that was named",
        "",
        (
            ("session", "                if values is not None:\n", "                self._short = decoder.body[0] == 0x10 and size < 12\n                if values is not None:\n"),
            ("session", "body.express(valence, arousal, mood)", "body.express(valence, arousal, body._named_mood if self._short else mood)"),
        ),
        versions=(2, 3),
    ),
    Fault(
        "mood of EXPRESS ignored in a session of version 1",
        "",
        (("session", "valence, arousal, mood = values[3], values[4], values[5]", "valence, arousal, mood = values[3], values[4], values[5]\n            if self._version < 2:\n                mood = m.NOTHING"),),
        versions=(2, 3),
    ),
    Fault("mood of EXPRESS ignored", "", (("session", "valence, arousal, mood = values[3], values[4], values[5]", "valence, arousal, mood = values[3], values[4], m.NOTHING"),), versions=(2, 3)),
    Fault(
        "EXPRESS of version 1 taken for mood 255 of version 2 only in sessions of version 1",
        "",
        (("codec", _DEFAULTS, "                body[start + index] = 0 if body[1] & 1 else defaults[index]\n"),),
        versions=(2, 3),
    ),
    # --- types of fields
    Fault("session read with its high byte first", "", (("codec", "    return values\n\n\ndef pack", "    return (values[0], (values[1] & 255) << 8 | values[1] >> 8) + values[2:]\n\n\ndef pack"),)),
    Fault("session read signed", "", (("codec", "    return values\n\n\ndef pack", "    if values[1] >= 0x8000:\n        return None\n    return values\n\n\ndef pack"),)),
    Fault("session kept in 8 bits", "", (("session", "self.number, self._beat, self._last_state = session, 0, now", "self.number, self._beat, self._last_state = session & 0xFF, 0, now"), ("session", "session != self.number:\n            if", "session & 0xFF != self.number:\n            if"))),
    Fault("host read in 16 bits", "", (("session", "        if host != self._host:\n", "        host &= 0xFFFF\n        if host != self._host:\n"),)),
    Fault("host read signed", "", (("session", "        if host != self._host:\n", "        if host >= 0x80000000:\n            return\n        if host != self._host:\n"),)),
    Fault("valence read with its high byte first", "", (("session", "body.express(valence, arousal, mood)", "valence = (valence & 255) << 8 | valence >> 8 & 255\n            body.express(max(min(valence - (valence >> 15 << 16), 10000), -10000), arousal, mood)"),)),
    Fault("valence read unsigned", "", (("session", "body.express(valence, arousal, mood)", "body.express(valence if valence >= 0 else 10000, arousal, mood)"),)),
    Fault("valence and arousal exchanged", "", (("session", "body.express(valence, arousal, mood)", "body.express(arousal, valence, mood)"),)),
    Fault("arousal with the wrong sign", "", (("session", "body.express(valence, arousal, mood)", "body.express(valence, -arousal, mood)"),)),
    Fault("motions and sounds exchanged in PLAY", "", (("session", "            item, index = values[3], values[4]\n", "            item, index = 3 - values[3], values[4]\n"),)),
    Fault("MOVE takes its duration for hundredths", "", (("session", "values[6 : 6 + count], duration)", "values[6 : 6 + count], 10 * duration)"),), versions=(3,)),
    Fault("MOVE takes its duration for seconds in 1/1024", "", (("session", "values[6 : 6 + count], duration)", "values[6 : 6 + count], duration // 4)"),), versions=(3,)),
    Fault("MOVE takes its duration signed", "", (("session", "values[6 : 6 + count], duration)", "values[6 : 6 + count], duration - (duration >> 15 << 16))"),), versions=(3,)),
    Fault("angles of MOVE in 1/10 degree", "", (("session", "self._body.move(released, moved, values[6 : 6 + count], duration)", "self._body.move(released, moved, [round(one * 0.57) for one in values[6 : 6 + count]], duration)"),), versions=(3,)),
    Fault("name cut inside a character", "", (("servos", 'NAME = "Dino"', 'NAME = "Dinosaurus Rex é"'), ("table", "not 1 <= len(name.encode()) <= NAME_BYTES", "not 1 <= len(name) <= NAME_BYTES"))),
    Fault("name with the rest of a longer one after its end", "", (("session", "self._name.encode(),", "self._name.encode() + b'\\0saurus',"),), level="should"),
)
