"""Faults of section 7: STATE, the emotion shown, the failsafe, the clock, and the log."""

from tests.robot.conformance.planted.robot import PlantedFault as Fault

_STATE = "            self._beat,\n            self._taken,\n"
_BEAT = "            self._beat = values[2]\n            self._send_state(now)\n"
_CLOSE = "        self.number = 0\n        self._in_force = False\n        self._body.neutral()\n"
_FAILSAFE = "self.number and now - self._last_received >= m.FAILSAFE_AFTER"
_RECEIVED = "        self._last_received = now\n        if kind == m.BEAT:"
_COUNTED = "        if kind {}:\n            self._last_received = now\n        if kind == m.BEAT:"
_NEUTRAL = "        self._target = (0, 0)\n        self.held = 0\n"
_MOVED = "            self.valence += d_valence\n            self.arousal += d_arousal\n"
_TIME = "            now & 0xFFFFFFFF,\n            self._result"
_TICK_FIRST = "        self.tick(now)\n        decoder"
_ANGLES = "            *angles,\n"
_LOG_RATE = "and idle and now - self._last_log >= m.LOG_EVERY"
_STEP = "self.angles[index] += min(max(way, -max_step), max_step)"
_TARGET = "target = min(max(targets[index], 100 * servo.low), 100 * servo.high)"


def _not_counted(what: str, condition: str, versions: tuple[int, ...] = (1, 2, 3)) -> Fault:
    edit = ("session", _RECEIVED, _COUNTED.format(condition))
    return Fault(f"{what} does not keep a session open", "", (edit,), versions)


STATES = (
    # --- BEAT and STATE
    Fault("count of BEAT plus 1 in STATE", "", (("session", _STATE, _STATE.replace("self._beat,", "self._beat + 1 & 0xFFFF,")),)),
    Fault("count of BEAT in 8 bits", "", (("session", _BEAT, _BEAT.replace("values[2]\n", "values[2] & 0xFF\n")),)),
    Fault("count of BEAT in 15 bits", "", (("session", _BEAT, _BEAT.replace("values[2]\n", "values[2] & 0x7FFF\n")),)),
    Fault("only a higher count of BEAT kept", "", (("session", _BEAT, _BEAT.replace("values[2]\n", "max(self._beat, values[2])\n")),)),
    Fault("BEAT with the count of the one before not answered", "", (("session", _BEAT, "            if self._beat != values[2] or not values[2]:\n                self._beat = values[2]\n                self._send_state(now)\n"),)),
    Fault("BEAT of count 0 not answered", "", (("session", _BEAT, "            if values[2]:\n                self._beat = values[2]\n                self._send_state(now)\n"),)),
    Fault("STATE of its own accord with beat 0", "", (("session", "m.STATE_EVERY:\n            self._send_state(now)\n", "m.STATE_EVERY:\n            beat, self._beat = self._beat, 0\n            self._send_state(now)\n            self._beat = beat\n"),)),
    Fault("BEAT answered by the STATE before it", "", (("session", _BEAT, "            self._send_state(now)\n            self._beat = values[2]\n"),)),
    Fault("STATE only for BEAT", "", (("session", "m.STATE_EVERY:\n            self._send_state(now)\n", "m.STATE_EVERY:\n            self._last_state = now\n"),)),
    Fault("STATE every 200 ms", "", (("session", "now - self._last_state >= m.STATE_EVERY", "now - self._last_state >= 200"),)),
    Fault("STATE of its own accord only after the first BEAT", "", (("session", "if self.number and now - self._last_state >= m.STATE_EVERY", "if self.number and self._beat and now - self._last_state >= m.STATE_EVERY"),)),
    Fault("STATE every 5 ms", "", (("session", "now - self._last_state >= m.STATE_EVERY", "now - self._last_state >= 5"),), level="should"),
    Fault("battery in percent of 1/10000 beyond full", "", (("session", "            self._board.battery(),\n", "            self._board.battery() * 100 & 0xFFFF,\n"),)),
    Fault("battery signed below empty", "", (("session", "            self._board.battery(),\n", "            -1 & 0xFFFF,\n"),)),
    Fault("valence and arousal exchanged in STATE", "", (("session", "            body.valence,\n            body.arousal,\n", "            body.arousal,\n            body.valence,\n"),)),
    Fault("valence in STATE beyond its limits", "", (("session", "            body.valence,\n", "            body.valence * 5 // 4,\n"),)),
    Fault("angles in STATE in 1/10 degree", "", (("session", _ANGLES, "            *[angle * 573 // 1000 for angle in angles],\n"),), versions=(3,)),
    Fault("angles in STATE in 1/100 degree", "", (("session", _ANGLES, "            *[max(min(angle * 573 // 100, 32767), -32768) for angle in angles],\n"),)),
    Fault("angles in STATE from the last joint to the first", "", (("session", _ANGLES, "            *angles[::-1],\n"),)),
    Fault("angles in STATE always 0", "", (("session", _ANGLES, "            *[0] * len(angles),\n"),), versions=(3,)),
    Fault("angles in STATE not limited", "", (("session", _ANGLES, "            *[angle * 3 for angle in angles],\n"),)),
    Fault("angles in STATE of joints that it does not have", "", (("session", "*(0,) * (m.JOINTS_MAX - len(angles)),", "*(100,) * (m.JOINTS_MAX - len(angles)),"),)),
    Fault("joints beyond their limits in one motion", "", (("joints", _TARGET, "target = targets[index] + 100 * (servo.high + 10) * (targets[index] > 99 * servo.high - 1200)"),)),
    Fault("joints at twice their top speed", "", (("joints", _STEP, "self.angles[index] += min(max(way, -2 * max_step), 2 * max_step)"),)),
    Fault("joints without a top speed", "", (("joints", _STEP, "self.angles[index] += way"),)),
    Fault("flags that no version has", "", (("session", "flags = m.FLAG_STILL if body.stopped else 0", "flags = 0x80 | (m.FLAG_STILL if body.stopped else 0)"),)),
    Fault("a mood that it does not have", "", (("session", "            body.mood,\n", "            255 if abs(body.valence) < 100 else body.mood,\n"),)),
    # --- the emotion shown
    Fault("emotion shown at once", "", (("body", "EMOTION_SPEED = 10\n", "EMOTION_SPEED = 2000\n"),), level="should"),
    Fault("emotion shown after 20 s", "", (("body", "EMOTION_SPEED = 10\n", "EMOTION_SPEED = 1\n"), ("body", "max_change = EMOTION_SPEED * elapsed", "max_change = EMOTION_SPEED * elapsed // 2"))),
    Fault("emotion ends 0.05 before the one commanded", "", (("body", "            if length > max_change:\n", "            if length < 500:\n                d_valence = d_arousal = 0\n            if length > max_change:\n"),)),
    Fault("arousal never shown", "", (("body", _MOVED, "            self.valence += d_valence\n"),)),
    Fault("negative valence not shown", "", (("session", "            body.valence,\n", "            max(body.valence, 0),\n"),)),
    Fault("negative arousal not shown", "", (("session", "            body.arousal,\n", "            max(body.arousal, 0),\n"),)),
    Fault("emotion shown up to 0.9", "", (("session", "            body.valence,\n            body.arousal,\n", "            max(min(body.valence, 9000), -9000),\n            max(min(body.arousal, 9000), -9000),\n"),)),
    Fault("arousal shown down to -0.5", "", (("session", "            body.arousal,\n", "            max(body.arousal, -5000),\n"),)),
    Fault("emotion in 8 bits turns over at 1", "", (("session", "            body.valence,\n", "            ((body.valence * 128 // 10000 + 128) % 256 - 128) * 10000 // 128,\n"),)),
    Fault("emotion decays by itself", "", (("body", _MOVED, _MOVED + "        self._age += elapsed\n        if self._age > 3000:\n            self._target = (0, 0)\n"), ("body", "        self._target = (valence, arousal)\n", "        self._target = (valence, arousal)\n        self._age = 0\n"), ("body", "        self._target = (0, 0)\n        self._named_mood = NOTHING\n", "        self._target = (0, 0)\n        self._age = 0\n        self._named_mood = NOTHING\n"))),
    Fault("emotion starts from neutral each time", "", (("body", "        self._target = (valence, arousal)\n", "        self._target = (valence, arousal)\n        self.valence = self.arousal = 0\n"),)),
    Fault("emotion goes the wrong way first", "", (("body", "        self._target = (valence, arousal)\n", "        self.valence = max(min(self.valence - (valence > self.valence) * 2000, 10000), -10000)\n        self._target = (valence, arousal)\n"),)),
    Fault("emotion ended by PLAY", "", (("body", "        self._start(index, True)\n", "        self._start(index, True)\n        self._target = (0, 0)\n"),)),
    Fault("emotion ended by MOVE", "", (("body", "        self.held = self.held & ~released | moved\n", "        self.held = self.held & ~released | moved\n        self._target = (0, 0)\n"),), versions=(3,)),
    # --- the failsafe
    Fault("no failsafe", "", (("session", _FAILSAFE, "False"),)),
    Fault("failsafe after 600 ms", "", (("messages", "FAILSAFE_AFTER = 450", "FAILSAFE_AFTER = 600"),)),
    Fault("failsafe after 530 ms", "", (("messages", "FAILSAFE_AFTER = 450", "FAILSAFE_AFTER = 530"),)),
    Fault("failsafe after 390 ms", "", (("messages", "FAILSAFE_AFTER = 450", "FAILSAFE_AFTER = 390"),)),
    Fault("failsafe after 300 ms", "", (("messages", "FAILSAFE_AFTER = 450", "FAILSAFE_AFTER = 300"),)),
    Fault("failsafe counted from the last STATE", "", (("session", _FAILSAFE, "self.number and now - max(self._last_received, self._last_state) >= m.FAILSAFE_AFTER"),)),
    Fault("failsafe only once", "", (("session", _FAILSAFE + ":\n", _FAILSAFE + " and not self._failed:\n            self._failed = True\n"), ("session", "        self._host = 0\n", "        self._host = self._failed = 0\n"))),
    Fault("no failsafe while it is stopped", "", (("session", _FAILSAFE, _FAILSAFE + " and not self._body.stopped"),)),
    Fault("no failsafe while a motion is played", "", (("session", _FAILSAFE, _FAILSAFE + " and not self._body._play_once"),)),
    Fault("no failsafe while joints are held", "", (("session", _FAILSAFE, _FAILSAFE + " and not self._body.held"),), versions=(3,)),
    Fault("no failsafe before the first BEAT", "", (("session", _FAILSAFE, _FAILSAFE + " and self._beat"),)),
    Fault("no failsafe before the first command", "", (("session", _FAILSAFE, _FAILSAFE + " and self._in_force"),)),
    Fault("failsafe ends the session only", "", (("session", _CLOSE, _CLOSE.replace("        self._body.neutral()\n", "")),)),
    Fault("failsafe goes to neutral, but keeps the session", "", (("session", "m.FAILSAFE_AFTER:\n            self._close()\n", "m.FAILSAFE_AFTER:\n            self._in_force = False\n            self._body.neutral()\n"),)),
    Fault("failsafe keeps the command in force", "", (("session", _CLOSE, _CLOSE.replace("        self._in_force = False\n", "")),)),
    Fault("failsafe stops the robot", "", (("session", "m.FAILSAFE_AFTER:\n            self._close()\n", "m.FAILSAFE_AFTER:\n            self._close()\n            self._body.stopped = True\n"),)),
    Fault("failsafe jumps to neutral", "", (("session", "m.FAILSAFE_AFTER:\n            self._close()\n", "m.FAILSAFE_AFTER:\n            self._close()\n            self._body.valence = self._body.arousal = 0\n"),)),
    Fault("neutral at the next HELLO only", "", (("session", _CLOSE, _CLOSE.replace("        self._body.neutral()\n", "        self._left = True\n")), ("session", "        if host != self._host:\n", "        if self._left:\n            self._body.neutral()\n            self._left = False\n        if host != self._host:\n"), ("session", "        self._host = 0\n", "        self._host = self._left = 0\n"))),
    Fault("neutral keeps the motion", "", (("body", "        self.sounds.end()\n        self._start(self.mood)\n", "        self.sounds.end()\n"),)),
    Fault("neutral keeps the sound", "", (("body", "        self.sounds.end()\n        self._start(self.mood)\n", "        self._start(self.mood)\n"),)),
    Fault("neutral keeps the arousal", "", (("body", _NEUTRAL, "        self._target = (0, self._target[1])\n        self.held = 0\n"),)),
    Fault("neutral keeps the held joints", "", (("body", _NEUTRAL, "        self._target = (0, 0)\n"),), versions=(3,)),
    Fault("BYE ignored", "", (("session", "        elif kind == m.BYE:\n            self._close()\n", "        elif kind == m.BYE:\n            pass\n"),)),
    Fault("BYE ends the session only", "", (("session", "        elif kind == m.BYE:\n            self._close()\n", "        elif kind == m.BYE:\n            self.number = 0\n            self._in_force = False\n"),)),
    Fault("BYE keeps the command in force", "", (("session", "        elif kind == m.BYE:\n            self._close()\n", "        elif kind == m.BYE:\n            self._close()\n            self._in_force = True\n"),)),
    _not_counted("BEAT", "!= m.BEAT"),
    _not_counted("ASK", "!= m.ASK"),
    _not_counted("EXPRESS", "!= m.EXPRESS"),
    _not_counted("PLAY", "!= m.PLAY"),
    _not_counted("STOP", "!= m.STOP"),
    _not_counted("MOVE", "!= m.MOVE", (3,)),
    _not_counted("anything but BEAT", "== m.BEAT"),
    Fault("repeated command does not keep a session open", "", (("session", _RECEIVED, "        if not (kind & 0x10 and kind != m.BYE and values[2] <= self._taken):\n            self._last_received = now\n        if kind == m.BEAT:"),)),
    Fault("ASK without an answer does not keep a session open", "", (("session", _RECEIVED, "        if not (kind == m.ASK and values[2] > 3):\n            self._last_received = now\n        if kind == m.BEAT:"),)),
    Fault("refused command does not keep a session open", "", (("session", "            self._result = self._apply(kind, values, now)\n", "            before = self._before\n            self._result = self._apply(kind, values, now)\n            if self._result:\n                self._last_received = before\n"), ("session", _RECEIVED, "        self._before = self._last_received\n" + _RECEIVED))),
    Fault("every byte keeps a session open", "", (("session", _TICK_FIRST, "        self.tick(now)\n        if count:\n            self._last_received = now\n        decoder"),)),
    Fault("every whole frame keeps a session open", "", (("session", "            if size:\n                values", "            if size:\n                self._last_received = now\n                values"),)),
    Fault("bodies out of range keep a session open", "", (("session", "                if values is not None:\n", "                if values is None and size > 7:\n                    self._last_received = now\n                if values is not None:\n"),)),
    Fault("short bodies keep a session open", "", (("session", "                if values is not None:\n", "                if values is None and size < 5:\n                    self._last_received = now\n                if values is not None:\n"),)),
    Fault("waiting bytes processed before the clock is read", "", (("session", _TICK_FIRST, "        decoder"), ("session", "                    self._receive_message(values, now)\n", "                    self._receive_message(values, now)\n        self.tick(now)\n"))),
    Fault("clock read only while no bytes wait", "", (("session", _TICK_FIRST, "        if not count:\n            self.tick(now)\n        decoder"),)),
    Fault("STATE of its own accord only while no bytes wait", "", (("session", "now - self._last_state >= m.STATE_EVERY", "now - self._last_state >= m.STATE_EVERY and not self._busy"), ("session", _TICK_FIRST, "        self._busy = count\n        self.tick(now)\n        decoder"), ("session", "        self._host = 0\n", "        self._host = self._busy = 0\n"))),
    # --- the clock
    Fault("no clock", "", (("session", _TIME, _TIME.replace("now & 0xFFFFFFFF", "0")),), versions=(3,)),
    Fault("clock in seconds", "", (("session", _TIME, _TIME.replace("now & 0xFFFFFFFF", "now // 1000")),), versions=(3,)),
    Fault("clock in microseconds", "", (("session", _TIME, _TIME.replace("now & 0xFFFFFFFF", "now * 1000 & 0xFFFFFFFF")),), versions=(3,)),
    Fault("clock in ticks of 1/1024 s", "", (("session", _TIME, _TIME.replace("now & 0xFFFFFFFF", "now * 1024 // 1000")),), versions=(3,)),
    Fault("clock of 16 bits", "", (("session", _TIME, _TIME.replace("0xFFFFFFFF", "0xFFFF")),), versions=(3,)),
    Fault("clock with its high byte first", "", (("session", _TIME, "            now << 24 & 0xFF000000 | now << 8 & 0xFF0000 | now >> 8 & 0xFF00 | now >> 24,\n            self._result"),), versions=(3,)),
    Fault("clock 0.5 % fast", "", (("session", _TIME, _TIME.replace("now & 0xFFFFFFFF", "now * 1005 // 1000")),), versions=(3,)),
    Fault("clock 0.5 % slow", "", (("session", _TIME, _TIME.replace("now & 0xFFFFFFFF", "now * 995 // 1000")),), versions=(3,)),
    Fault("clock begins with every session", "", (("session", _TIME, _TIME.replace("now & 0xFFFFFFFF", "now - self._began")), ("session", "            self.number, self._beat, self._last_state = session, 0, now\n", "            self.number, self._beat, self._last_state = session, 0, now\n            self._began = now\n")), versions=(3,)),
    Fault("clock begins with every host", "", (("session", _TIME, _TIME.replace("now & 0xFFFFFFFF", "now - self._began")), ("session", "            self._result = m.RESULT_TAKEN\n        if session", "            self._result = m.RESULT_TAKEN\n            self._began = now\n        if session")), versions=(3,)),
    Fault("clock stands without a session", "", (("session", _TIME, _TIME.replace("now & 0xFFFFFFFF", "now - self._idle")), ("session", "        if self.number and now - self._last_received >=", "        if not self.number:\n            self._idle += now - self._ticked\n        self._ticked = now\n        if self.number and now - self._last_received >="), ("session", "        self._host = 0\n", "        self._host = self._idle = self._ticked = 0\n")), versions=(3,)),
    Fault("clock in steps of 100 ms", "", (("session", _TIME, _TIME.replace("now & 0xFFFFFFFF", "now // 100 * 100")),), versions=(3,)),
    Fault("clock in steps of 20 ms", "", (("session", _TIME, _TIME.replace("now & 0xFFFFFFFF", "now // 20 * 20")),), versions=(3,)),
    Fault("clock read when the STATE before was sent", "", (("session", "        self._last_state = now\n        body", "        self._before, self._last_state = self._last_state, now\n        body"), ("session", _TIME, _TIME.replace("now & 0xFFFFFFFF", "self._before"))), versions=(3,)),
    Fault("clock jumps back now and then", "", (("session", _TIME, _TIME.replace("now & 0xFFFFFFFF", "now - 300 * (now // 1000 % 8 == 7)")),), versions=(3,)),
    Fault("clock set by HELLO", "", (("session", _TIME, _TIME.replace("now & 0xFFFFFFFF", "now + self._host % 5000")),), versions=(3,)),
    # --- the log
    Fault("LOG without a limit of its rate", "", (("session", _LOG_RATE, "and idle"),), versions=(3,)),
    Fault("LOG every 50 ms", "", (("session", _LOG_RATE, "and idle and now - self._last_log >= 50"),), versions=(3,)),
    Fault("LOG in place of a STATE", "", (("session", "m.STATE_EVERY:\n            self._send_state(now)\n", "m.STATE_EVERY:\n            if self._version < 3 or not self._log._waiting:\n                self._send_state(now)\n            self._last_state = now\n"),), versions=(3,)),
    Fault("LOG before the ACK of its command", "", (("session", "        self._log.write(m.SEVERITY_WARNING, text, now)\n", "        self._log.write(m.SEVERITY_WARNING, text, now)\n        if self._version >= 3 and now - self._last_log >= 100:\n            self._send_log(now)\n"),), versions=(3,)),
    Fault("LOG with control characters", "", (("log", "data = text.encode()", "data = b'\\x1b[31m' + text.encode()"),), versions=(3,)),
    Fault("LOG with a line feed", "", (("log", "data = text.encode()", "data = text.encode() + b'\\r\\n'"),), versions=(3,)),
    Fault("LOG without text", "", (("log", "data[:end]))", "b''))"),), versions=(3,)),
    Fault("LOG that is not UTF-8", "", (("log", "data = text.encode()", "data = b'\\xb0' + text.encode()"),), versions=(3,)),
    Fault("LOG with one count for all", "", (("log", "self._count = (self._count + 1) & 0xFFFF", "self._count = 1"),), versions=(3,)),
    Fault("LOG counts down", "", (("log", "self._count = (self._count + 1) & 0xFFFF", "self._count = (self._count - 1) & 0xFFFF"),), versions=(3,)),
    Fault("LOG with the newest line first", "", (("log", "self._waiting.pop(0)", "self._waiting.pop()"),), versions=(3,)),
    Fault("LOG drops the oldest line", "", (("log", "            return\n", "            self._waiting.pop(0)\n"),), versions=(3,)),
    Fault("LOG with the time of its sending in seconds", "", (("log", "now & 0xFFFFFFFF", "now // 1000"),), versions=(3,)),
    Fault("LOG with a time in the future", "", (("log", "now & 0xFFFFFFFF", "now + 60000"),), versions=(3,)),
    Fault("LOG repeated", "", (("session", "            self._send(m.LOG, *line)\n", "            self._send(m.LOG, *line)\n            self._send(m.LOG, *line)\n"),), versions=(3,)),
)
