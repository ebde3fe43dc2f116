"""Faults of sections 4 and 5: sessions, hosts, versions, the catalogue, and what is sent unasked."""

from tests.robot.conformance.planted.robot import PlantedFault as Fault

_NOT_OURS = "        if not self.number or session != self.number:\n"
_HELLO_ZERO = "            if session:\n                self._open(session, values[2], values[3], now)\n"
_ANOTHER_HOST = """            if self._in_force:
                self._body.neutral()
            self._host, self._taken, self._in_force = host, 0, False
            self._result = m.RESULT_TAKEN
"""
_NEW_SESSION = "            self.number, self._beat, self._last_state = session, 0, now\n"
_GONE_RATE = "            if now - self._last_gone >= m.GONE_EVERY:\n"
_GONE = "pack(self._reply, m.VERSION, m.GONE, session)"
_BYE = "        elif kind == m.BYE:\n            self._close()\n"
_CLOSE = "        self.number = 0\n        self._in_force = False\n        self._body.neutral()\n"
_TAKEN = "self._taken if self._in_force else 0,"
_VERSION = "self._version = min(version, m.VERSION)"
_OPEN = "        self._last_received = now\n        self._version"
_NO_ENTRY = "        if item >= len(self._names) or index >= len(self._names[item]):\n            return 0\n"
_ACK = "        self._send(m.ACK, number, result)\n"
_TICK = "        # No LOG while others wait"
_SENT = "            m.ABILITY_MOVE,\n        )\n"
_LATE = """        if now - self._last_late >= 150 and self._late:
            self._last_late = now
            self._send(*self._late.pop(0))
"""
_LATE_LIST = ("session", "        self._host = 0\n", "        self._host = self._last_late = 0\n        self._late = []\n")

SESSIONS = (
    # --- session 0
    Fault("messages in session 0 not answered", "", (("session", _NOT_OURS, "        if not session:\n            return\n" + _NOT_OURS),)),
    Fault("messages in session 0 not answered while one is open", "", (("session", _NOT_OURS, "        if self.number and not session:\n            return\n" + _NOT_OURS),)),
    Fault("messages in session 0 not answered while none is open", "", (("session", _NOT_OURS, "        if not self.number and not session:\n            return\n" + _NOT_OURS),)),
    Fault("session 0 is open while none else is", "", (("session", _NOT_OURS, "        if session != self.number:\n"),)),
    Fault("HELLO in session 0 answered by GONE", "", (("session", _HELLO_ZERO, _HELLO_ZERO + "            else:\n                self._send_buffer.put(self._reply, pack(self._reply, m.VERSION, m.GONE, 0))\n"),)),
    Fault("HELLO in session 0 opens it", "", (("session", _HELLO_ZERO, _HELLO_ZERO.replace("if session:", "if True:")),)),
    Fault("HELLO in session 0 ends the open session", "", (("session", _HELLO_ZERO, _HELLO_ZERO + "            elif self.number:\n                self._close()\n"),)),
    Fault("HELLO in session 0 keeps a session open", "", (("session", _HELLO_ZERO, _HELLO_ZERO + "            else:\n                self._last_received = now\n"),)),
    Fault("HELLO in session 0 changes the host", "", (("session", _HELLO_ZERO, _HELLO_ZERO + "            else:\n                self._host = values[3]\n"),)),
    Fault("HELLO in session 0 changes the version", "", (("session", _HELLO_ZERO, _HELLO_ZERO + "            else:\n                self._version = min(values[2], m.VERSION)\n"),), versions=(2, 3)),
    # --- other sessions
    Fault("messages of other sessions not answered", "", (("session", _GONE_RATE, "            if False:\n"),)),
    Fault("BYE of another session not answered", "", (("session", _GONE_RATE, "            if kind != m.BYE and now - self._last_gone >= m.GONE_EVERY:\n"),)),
    Fault("BYE of another session ends the open one", "", (("session", _NOT_OURS, "        if self.number and kind == m.BYE and session != self.number:\n            self._close()\n" + _NOT_OURS),)),
    Fault("ASK of another session answered", "", (("session", _NOT_OURS, "        if self.number and kind == m.ASK:\n            session = self.number\n" + _NOT_OURS),)),
    Fault("commands of another session carried out", "", (("session", _NOT_OURS, "        if self.number and kind & 0x10 and kind != m.BYE:\n            session = self.number\n" + _NOT_OURS),)),
    Fault("messages of another session keep the open one", "", (("session", _NOT_OURS, "        self._last_received = now\n" + _NOT_OURS),)),
    Fault("GONE names the open session", "", (("session", _GONE, "pack(self._reply, m.VERSION, m.GONE, self.number)"),)),
    Fault("GONE names session 0", "", (("session", _GONE, "pack(self._reply, m.VERSION, m.GONE, 0)"),)),
    Fault("GONE to every message", "", (("session", _GONE_RATE, "            if True:\n"),)),
    Fault("GONE every 10 ms", "", (("session", _GONE_RATE, "            if now - self._last_gone >= 10:\n"),)),
    Fault("GONE every 200 ms", "", (("session", _GONE_RATE, "            if now - self._last_gone >= 200:\n"),)),
    Fault("GONE once for each session", "", (("session", "        self._last_gone = -m.GONE_EVERY\n", "        self._last_gone = -m.GONE_EVERY\n        self._told = -1\n"), ("session", _GONE_RATE, "            if now - self._last_gone >= m.GONE_EVERY and session != self._told:\n                self._told = session\n"))),
    Fault("GONEs beyond the rate sent later", "", (_LATE_LIST, ("session", "                self._send_buffer.put(self._reply, " + _GONE + ")\n", "                self._send_buffer.put(self._reply, " + _GONE + ")\n            else:\n                self._late.append(session)\n"), ("session", _TICK, "        if self._late and now - self._last_gone >= m.GONE_EVERY:\n            self._last_gone = now\n            self._send_buffer.put(self._reply, pack(self._reply, 3, m.GONE, self._late.pop(0)))\n" + _TICK))),
    Fault("no GONE while no session is open", "", (("session", _GONE_RATE, "            if self.number and now - self._last_gone >= m.GONE_EVERY:\n"),)),
    Fault("no GONE while a session is open", "", (("session", _GONE_RATE, "            if not self.number and now - self._last_gone >= m.GONE_EVERY:\n"),)),
    Fault("GONE says what is wrong in more bytes", "", (("messages", '0x9F: ("<BH", ((1, 3),))', '0x9F: ("<BHB", ((1, 4),))'), ("session", _GONE, "pack(self._reply, m.VERSION, m.GONE, session, 7)"))),
    # --- HELLO of the same host
    Fault("same host forgets the numbers in every session", "", (("session", _NEW_SESSION, _NEW_SESSION + "            self._taken = 0\n"),)),
    Fault("same host goes to neutral in every session", "", (("session", _NEW_SESSION, _NEW_SESSION + "            self._body.neutral()\n"),)),
    Fault("same host loses the motion in every session", "", (("session", _NEW_SESSION, _NEW_SESSION + "            self._body._start(self._body.mood)\n"),)),
    Fault("same host loses the sound in every session", "", (("session", _NEW_SESSION, _NEW_SESSION + "            self._body.sounds.end()\n"),)),
    Fault("same host loses the named mood in every session", "", (("session", _NEW_SESSION, _NEW_SESSION + "            self._body._named_mood = m.NOTHING\n"),), versions=(2, 3)),
    Fault("same host loses the stop in every session", "", (("session", _NEW_SESSION, _NEW_SESSION + "            self._body.stopped = False\n"),)),
    Fault("same host loses the held joints in every session", "", (("session", _NEW_SESSION, _NEW_SESSION + "            self._body.held = 0\n"),), versions=(3,)),
    Fault("same host loses the result in every session", "", (("session", _NEW_SESSION, _NEW_SESSION + "            self._result = 0\n"),), versions=(3,)),
    Fault("new session remembers the last beat", "", (("session", _NEW_SESSION, _NEW_SESSION.replace("self._beat, self._last_state = session, 0, now", "self._last_state = session, now")),)),
    Fault("repeated HELLO not answered", "", (("session", "        self._last_received = now\n        self._version", "        if self._repeated:\n            return\n        self._last_received = now\n        self._version"), ("session", "        if session != self.number:\n            self.number", "        self._repeated = session == self.number\n        if session != self.number:\n            self.number"))),
    Fault("repeated HELLO forgets the beat", "", (("session", _OPEN, "        self._beat = 0\n" + _OPEN),)),
    Fault("repeated HELLO goes to neutral", "", (("session", "        if session != self.number:\n            self.number", "        if session == self.number:\n            self._body.neutral()\n        if session != self.number:\n            self.number"),)),
    Fault("repeated HELLO ends the stop", "", (("session", "        if session != self.number:\n            self.number", "        if session == self.number:\n            self._body.stopped = False\n        if session != self.number:\n            self.number"),)),
    Fault("repeated HELLO ends motion and sound", "", (("session", "        if session != self.number:\n            self.number", "        if session == self.number:\n            self._body.sounds.end()\n            self._body._start(self._body.mood)\n        if session != self.number:\n            self.number"),)),
    Fault("repeated HELLO lets go of the joints", "", (("session", "        if session != self.number:\n            self.number", "        if session == self.number:\n            self._body.held = 0\n        if session != self.number:\n            self.number"),), versions=(3,)),
    Fault("repeated HELLO drops the named mood", "", (("session", "        if session != self.number:\n            self.number", "        if session == self.number:\n            self._body._named_mood = m.NOTHING\n        if session != self.number:\n            self.number"),), versions=(2, 3)),
    Fault("repeated HELLO does not keep the session open", "", (("session", _OPEN, "        if not self._repeated:\n            self._last_received = now\n        self._version"), ("session", "        if session != self.number:\n            self.number", "        self._repeated = session == self.number\n        if session != self.number:\n            self.number"))),
    Fault("repeated HELLO keeps the version", "", (("session", _VERSION, "self._version = self._version if self._repeated else min(version, m.VERSION)"), ("session", "        if session != self.number:\n            self.number", "        self._repeated = session == self.number\n        if session != self.number:\n            self.number")), versions=(2, 3)),
    Fault("HELLO with a session that has ended not answered", "", (("session", "        if host != self._host:\n", "        if session == self._ended and not self.number:\n            return\n        if host != self._host:\n"), ("session", _CLOSE, "        self._ended = self.number\n" + _CLOSE), ("session", "        self._host = 0\n", "        self._host = self._ended = 0\n"))),
    Fault("HELLO refused while a session of another host is open", "", (("session", "        if host != self._host:\n", "        if host != self._host and self.number:\n            return\n        if host != self._host:\n"),)),
    # --- HELLO of another host
    Fault("another host keeps the numbers", "", (("session", "host, 0, False\n", "host, self._taken, False\n"),)),
    Fault("another host keeps the command in force", "", (("session", "self._host, self._taken, self._in_force = host, 0, False\n", "self._host = host\n"),)),
    Fault("another host keeps the emotion", "", (("session", "            if self._in_force:\n                self._body.neutral()\n", ""),)),
    Fault("another host keeps the result", "", (("session", "            self._result = m.RESULT_TAKEN\n        if session", "        if session"),), versions=(3,)),
    Fault("another host keeps motion and sound", "", (("session", "                self._body.neutral()\n            self._host", "                self._body._target = (0, 0)\n                self._body.held = 0\n                self._body._named_mood = m.NOTHING if self._body._named_mood == m.NOTHING else 0\n            self._host"),)),
    Fault("another host ends the stop", "", (("session", "                self._body.neutral()\n            self._host", "                self._body.neutral()\n                self._body.stopped = False\n            self._host"),)),
    Fault("another host stops the robot", "", (("session", "                self._body.neutral()\n            self._host", "                self._body.stop()\n            self._host"),)),
    Fault("another host keeps the held joints", "", (("session", "                self._body.neutral()\n            self._host", "                held = self._body.held\n                self._body.neutral()\n                self._body.held = held\n            self._host"),), versions=(3,)),
    Fault("another host noticed in new sessions only", "", (("session", "        if host != self._host:\n", "        if host != self._host and session != self.number:\n"),)),
    Fault("hosts not distinguished", "", (("session", "        if host != self._host:\n", "        if not self._host:\n"),)),
    # --- WELCOME
    Fault("WELCOME names no command", "", (("session", _TAKEN, "0,"),)),
    Fault("WELCOME names a command that is not in force", "", (("session", _TAKEN, "self._taken,"),)),
    Fault("WELCOME names the command before", "", (("session", _TAKEN, "max(self._taken - 1, 0) if self._in_force else 0,"),)),
    Fault("WELCOME does not name a refused command", "", (("session", _TAKEN, "self._taken if self._in_force and not self._result else 0,"),)),
    Fault("WELCOME does not name STOP", "", (("session", _TAKEN, "self._taken if self._in_force and not self._body.stopped else 0,"),)),
    Fault("WELCOME does not name a PLAY that has ended", "", (("session", _TAKEN, "self._taken if self._in_force and (not self._played or self._body._play_once or self._body.sounds.sound >= 0) else 0,"), ("session", "            self._taken, self._in_force = number, True\n", "            self._taken, self._in_force = number, True\n            self._played = kind == m.PLAY\n"), ("session", "        self._host = 0\n", "        self._host = self._played = 0\n"))),
    Fault("WELCOME comes 150 ms late", "", (_LATE_LIST, ("session", "        self._send(\n            m.WELCOME", "        self._last_late = now\n        self._late.append((\n            m.WELCOME"), ("session", _SENT, "            m.ABILITY_MOVE,\n        ))\n"), ("session", _TICK, _LATE + _TICK))),
    Fault("WELCOME comes twice", "", (("session", _SENT, _SENT + "        self._send_buffer.put(self._reply, m.MAX_BODY and {1: 46, 2: 46, 3: 47}[self._version])\n"),)),
    Fault("WELCOME sent again after 200 ms", "", (("session", _SENT, _SENT + "        self._greeted, self._hello = now, (session, version, host)\n"), ("session", "        self._host = 0\n", "        self._host = self._greeted = 0\n"), ("session", _TICK, "        if self._greeted and now - self._greeted >= 200 and self._hello[0] == self.number:\n            self._open(*self._hello, now)\n            self._greeted = 0\n" + _TICK))),
    # --- versions
    Fault("version 255 answered by 255", "", (("session", _VERSION, "self._version = m.VERSION if version < 250 else 255"), ("codec", "if since <= version or not size", "if since <= min(version, 3) or not size"))),
    Fault("version always the highest", "", (("session", _VERSION, "self._version = m.VERSION"),), versions=(2, 3)),
    Fault("HELLO of a later version not answered", "", (("session", "        if host != self._host:\n", "        if version > m.VERSION:\n            return\n        if host != self._host:\n"),)),
    Fault("WELCOME says one version and speaks the highest", "", (("session", "            self._version,\n            self._taken", "            min(version, m.VERSION),\n            self._taken"), ("session", _VERSION, "self._version = m.VERSION")), versions=(2, 3)),
    Fault("version of the first session kept", "", (("session", _VERSION, "self._version = self._kept = self._kept or min(version, m.VERSION)"), ("session", "        self._host = 0\n", "        self._host = self._kept = 0\n")), versions=(2, 3)),
    Fault("version of the first HELLO of a host kept", "", (("session", _VERSION, "self._version = self._version if self._known else min(version, m.VERSION)"), ("session", "        if host != self._host:\n", "        self._known = host == self._host\n        if host != self._host:\n")), versions=(2, 3)),
    Fault("flags of version 2 in version 1", "", (("session", "        if self._version >= 2:\n            flags", "        if True:\n            flags"),), versions=(1, 2, 3)),
    Fault("STATE of version 3 in all versions", "", (("messages", "((1, 51), (3, 58))", "((1, 58),)"),), versions=(1, 2, 3)),
    Fault("STATE of version 1 in all versions", "", (("messages", "((1, 51), (3, 58))", "((1, 51),)"),), versions=(3,)),
    Fault("WELCOME of version 3 in all versions", "", (("messages", "((1, 46), (3, 47))", "((1, 47),)"),)),
    Fault("WELCOME of version 1 in all versions", "", (("messages", "((1, 46), (3, 47))", "((1, 46),)"),), versions=(3,)),
    Fault("LOG in all versions", "", (("session", "self._version >= 3 and idle", "idle"),)),
    Fault("reasons of version 3 in all versions", "", (("session", "        if self._version < 3:\n            result", "        if False:\n            result"),), versions=(3,)),
    Fault("MOVE skipped in sessions of earlier versions", "", (("session", "        if kind == m.BEAT:", "        if kind == m.MOVE and self._version < 3:\n            return\n        if kind == m.BEAT:"),), versions=(3,)),
    Fault("MOVE refused in sessions of earlier versions", "", (("session", "            return self._move(values, now)", "            return self._move(values, now) if self._version >= 3 else m.RESULT_CANNOT"),), versions=(3,)),
    Fault("other abilities than MOVE", "", (("session", "            m.ABILITY_MOVE,\n", "            m.ABILITY_MOVE | 2,\n"),), versions=(3,)),
    Fault("takes MOVE without saying so", "", (("session", "            m.ABILITY_MOVE,\n", "            0,\n"),), versions=(3,)),
    Fault("cannot MOVE, but says that it can", "", (("session", "            return self._move(values, now)", "            return m.RESULT_CANNOT"),), versions=(3,)),
    Fault("cannot MOVE, and refuses an unknown joint by 1", "", (("session", "            m.ABILITY_MOVE,\n", "            0,\n"), ("session", "        unable = self._unable()\n        if unable == m.RESULT_TAKEN:\n            self._body.move", "        unable = m.RESULT_CANNOT\n        if unable == m.RESULT_TAKEN:\n            self._body.move")), versions=(3,)),
    Fault("cannot MOVE, and skips it", "", (("session", "            m.ABILITY_MOVE,\n", "            0,\n"), ("session", "        if kind == m.BEAT:", "        if kind == m.MOVE:\n            return\n        if kind == m.BEAT:")), versions=(3,)),
    # --- the catalogue
    Fault("ASK for no entry answered by an empty NAME", "", (("session", _NO_ENTRY, "        if item and (item >= len(self._names) or index >= len(self._names[item])):\n            return pack(self._reply, self._version, m.NAME, session, min(item, 3), index, b'')\n" + _NO_ENTRY),)),
    Fault("ASK just beyond the end answered by the last entry", "", (("session", _NO_ENTRY, "        if 0 < item < len(self._names) and index == len(self._names[item]) > 0:\n            return pack(self._reply, self._version, m.NAME, session, item, index, self._names[item][-1].encode())\n" + _NO_ENTRY),)),
    Fault("ASK for an unknown item answered by a motion", "", (("session", _NO_ENTRY, "        item = min(item, 3)\n" + _NO_ENTRY),)),
    Fault("ASK for an unknown item crashes", "", (("session", "if item >= len(self._names) or index >= len(self._names[item])", "if index >= len(self._names[item])"),)),
    Fault("ASK for an unknown item refused by ACK", "", (("session", "            if size:\n                self._send_buffer.put", "            if not size:\n                self._send(m.ACK, 1, 1)\n            if size:\n                self._send_buffer.put"),)),
    Fault("last motion not described", "", (("session", _NO_ENTRY, _NO_ENTRY + "        if item == 1 and index == len(self._names[1]) - 1:\n            return 0\n"),)),
    Fault("moods not described", "", (("session", _NO_ENTRY, _NO_ENTRY + "        if item == 3:\n            return 0\n"),)),
    Fault("NAME without its index", "", (("session", "m.NAME, session, item, index, name)", "m.NAME, session, item, 0, name)"),)),
    Fault("NAME with another item", "", (("session", "m.NAME, session, item, index, name)", "m.NAME, session, 1, index, name)"),)),
    Fault("names repeated", "", (("session", "        name = self._names[item][index].encode()\n", "        name = self._names[item][index // 2].encode()\n"),)),
    Fault("a joint without a name", "", (("session", "        name = self._names[item][index].encode()\n", "        name = self._names[item][index].encode() if item or index else b''\n"),)),
    Fault("a joint's limits exchanged", "", (("session", "session, index, low, high, speed, name)", "session, index, high, low, speed, name)"),)),
    Fault("a joint's speed 0", "", (("session", "session, index, low, high, speed, name)", "session, index, low, high, 0, name)"),)),
    Fault("a joint's speed in degrees", "", (("session", "session, index, low, high, speed, name)", "session, index, low, high, speed * 573 // 10000, name)"),)),
    Fault("a joint's limits in 1/10 degree", "", (("session", "session, index, low, high, speed, name)", "session, index, low * 573 // 1000, high * 573 // 1000, speed, name)"),)),
    Fault("a motion too many counted", "", (("session", "counts = [len(names) for names in self._names]", "counts = [len(names) + (names is self._names[1]) for names in self._names]"),)),
    Fault("a motion too few counted", "", (("session", "counts = [len(names) for names in self._names]", "counts = [len(names) - (names is self._names[1]) for names in self._names]"),)),
    Fault("counts of sounds and moods exchanged", "", (("session", "            *counts,\n", "            *counts[:2],\n            counts[3],\n            counts[2],\n"),)),
    Fault("number of the catalogue changes in every session", "", (("session", "            self._catalogue,\n", "            (self._catalogue + self.number) & 0xFFFF,\n"),)),
    Fault("entries of the catalogue rotate", "", (("session", "        name = self._names[item][index].encode()\n", "        name = self._names[item][(index + self.number) % len(self._names[item])].encode()\n"),)),
    Fault("NAME with the session of the host before", "", (("session", "            size = self._describe(values[2], values[3], self.number)", "            size = self._describe(values[2], values[3], self.number - 1)"),)),
    Fault("NAME comes 150 ms late", "", (_LATE_LIST, ("session", "                self._send_buffer.put(self._reply, size)\n        elif", "                self._last_late = now\n                self._late.append(bytes(self._reply[:size]))\n        elif"), ("session", _TICK, "        if now - self._last_late >= 150 and self._late:\n            self._send_buffer.put(self._late[0], len(self._late.pop(0)))\n" + _TICK))),
    # --- unasked
    Fault("ACK of the last command sent every second", "", (("session", "        self._host = 0\n", "        self._host = self._again = 0\n"), ("session", _TICK, "        if self.number and self._taken and now - self._again >= 1000:\n            self._again = now\n            self._send(m.ACK, self._taken, self._result and 1)\n" + _TICK))),
    Fault("every command acknowledged twice", "", (("session", _ACK, _ACK + _ACK),)),
    Fault("new commands acknowledged twice", "", (("session", "            self._result = self._apply(kind, values, now)\n", "            self._result = self._apply(kind, values, now)\n            self._send(m.ACK, number, min(self._result, 1))\n"),)),
    Fault("ACK of the last command sent after HELLO", "", (("session", _SENT, _SENT + "        if self._in_force:\n            self._send(m.ACK, self._taken, self._result and 1)\n"),)),
    Fault("ACK when a motion has ended", "", (("session", _TICK, "        if self._body._play_once:\n            self._playing = True\n        elif self._playing:\n            self._playing = False\n            if self.number and self._taken:\n                self._send(m.ACK, self._taken, 0)\n" + _TICK), ("session", "        self._host = 0\n", "        self._host = self._playing = 0\n"))),
    Fault("BEAT acknowledged", "", (("session", "            self._beat = values[2]\n", "            self._beat = values[2]\n            self._send(m.ACK, max(self._taken, 1), 0)\n"),)),
    Fault("BYE answered by GONE", "", (("session", _BYE, _BYE + "            self._send_buffer.put(self._reply, pack(self._reply, m.VERSION, m.GONE, session))\n"),)),
    Fault("failsafe announced by GONE", "", (("session", "m.FAILSAFE_AFTER:\n            self._close()\n", "m.FAILSAFE_AFTER:\n            self._send(m.GONE)\n            self._close()\n"),)),
    Fault("catalogue sent without ASK", "", (("session", _SENT, _SENT + "        self._send_buffer.put(self._reply, self._describe(3, 0, self.number))\n"),)),
    Fault("STATE sent without a session", "", (("session", "if self.number and now - self._last_state >= m.STATE_EVERY", "if now - self._last_state >= m.STATE_EVERY"),)),
    Fault("STATE sent in the session before", "", (("session", _NEW_SESSION, "            if self.number:\n                before, self.number = self.number, self.number\n                self._before = before\n" + _NEW_SESSION), ("session", "        self._last_state = now\n        body", "        if self._before:\n            number, self.number, self._before = self.number, self._before, 0\n            self._send(m.GONE)\n            self.number = number\n        self._last_state = now\n        body"), ("session", "        self._host = 0\n", "        self._host = self._before = 0\n"))),
    # --- order and lateness
    Fault("BEATs answered after all else", "", (("session", "            self._beat = values[2]\n            self._send_state(now)\n", "            self._beat = values[2]\n            self._due = True\n"), ("session", "                    self._receive_message(values, now)\n", "                    self._receive_message(values, now)\n        if self._due and self.number:\n            self._send_state(now)\n        self._due = False\n"), ("session", "        self._host = 0\n", "        self._host = self._due = 0\n"))),
    Fault("commands acknowledged after all else", "", (("session", _ACK, "        self._acks.append((m.ACK, number, result))\n"), ("session", "                    self._receive_message(values, now)\n", "                    self._receive_message(values, now)\n        for ack in self._acks:\n            if self.number:\n                self._send(*ack)\n        self._acks = []\n"), ("session", "        self._host = 0\n", "        self._host = 0\n        self._acks = []\n"))),
    Fault("messages of one read taken from the last to the first", "", (("session", "                    self._receive_message(values, now)\n", "                    self._stack.append(values)\n        while self._stack:\n            self._receive_message(self._stack.pop(), now)\n"), ("session", "        self._host = 0\n", "        self._host = 0\n        self._stack = []\n"))),
    Fault("only the last of several commands of one read carried out", "", (("session", "                    self._receive_message(values, now)\n", "                    self._stack = values if values[0] == m.EXPRESS else self._stack\n                    if values[0] != m.EXPRESS:\n                        self._receive_message(values, now)\n        if self._stack:\n            self._receive_message(self._stack, now)\n            self._stack = None\n"), ("session", "        self._host = 0\n", "        self._host = 0\n        self._stack = None\n"))),
    Fault("BEAT answered by the next STATE of its own accord", "", (("session", "            self._beat = values[2]\n            self._send_state(now)\n", "            self._beat = values[2]\n"),)),
)
