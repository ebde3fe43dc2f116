"""Faults of section 2: where frames begin and end, their check, and COBS."""

from tests.robot.conformance.planted.robot import PlantedFault as Fault

_COMPARE = """    if (
        frame[end] != 0xE0 | crc >> 12
        or frame[end + 1] != 0x80 | crc >> 6 & 0x3F
        or frame[end + 2] != 0x80 | crc & 0x3F
    ):
        return 0
"""
_COLLECT = """            if count <= MAX_FRAME:
                self._frame[count] = byte
                self._count = count + 1
            return 0
"""
_EMPTY = """        if not count:
            return 0
        return decode"""
_RUN = "        if stop > end:\n            return 0  # a run of COBS passes the end\n"
_JOIN = """        if at < end:
            body[length] = 0
            length += 1
"""
_FULL = """        if self.end + size + OVERHEAD_BYTES > len(self.data):
            self.dropped += 1
            return
"""
_SHIFT = "(register << 4 & 0xFFFF) ^ _CRC_TABLE[register >> 12 ^ byte"

FRAMING = (
    # --- the check: a robot that computes another one is not understood at all
    Fault(
        "CRC starts at 0",
        "",
        (("frames", "end: int, register: int = 0xFFFF", "end: int, register: int = 0"),),
    ),
    Fault("CRC of the polynomial 0x8005", "", (("frames", "0x1021", "0x8005"),)),
    Fault(
        "CRC inverted at the end",
        "",
        (("frames", "    return register\n", "    return register ^ 0xFFFF\n"),),
    ),
    Fault(
        "CRC of the body before COBS",
        "",
        (("frames", "crc = crc16(out, first, at)", "crc = crc16(body, 0, size)"),),
    ),
    Fault(
        "CRC with the low half of a byte first",
        "",
        (
            ("frames", f"{_SHIFT} >> 4]", f"{_SHIFT} & 0xF]"),
            ("frames", f"{_SHIFT} & 15]", f"{_SHIFT} >> 4]"),
        ),
    ),
    Fault(
        "check sent with its last byte first",
        "",
        (
            ("frames", "out[at] = 0xE0 | crc >> 12", "out[at + 2] = 0xE0 | crc >> 12"),
            ("frames", "out[at + 2] = 0x80 | crc & 0x3F", "out[at] = 0x80 | crc & 0x3F"),
        ),
    ),
    Fault("check not compared", "", (("frames", _COMPARE, ""),)),
    Fault(
        "high bits of the check not compared",
        "",
        (("frames", "frame[end] != 0xE0 | crc >> 12\n        or ", ""),),
    ),
    Fault(
        "middle bits of the check not compared",
        "",
        (("frames", "or frame[end + 1] != 0x80 | crc >> 6 & 0x3F\n        ", ""),),
    ),
    Fault(
        "low bits of the check not compared",
        "",
        (("frames", "or frame[end + 2] != 0x80 | crc & 0x3F\n    ", ""),),
    ),
    Fault(
        "first mark of the check ignored",
        "",
        (("frames", "frame[end] != 0xE0 | crc >> 12", "frame[end] & 15 != crc >> 12"),),
    ),
    Fault(
        "second mark of the check ignored",
        "",
        (
            (
                "frames",
                "frame[end + 1] != 0x80 | crc >> 6 & 0x3F",
                "frame[end + 1] & 63 != crc >> 6 & 0x3F",
            ),
        ),
    ),
    Fault(
        "third mark of the check ignored",
        "",
        (("frames", "frame[end + 2] != 0x80 | crc & 0x3F", "frame[end + 2] & 63 != crc & 0x3F"),),
    ),
    Fault(
        "frame taken although only the last byte of its check fits or the others do",
        "",
        (
            ("frames", "        or frame[end + 1]", "        and frame[end + 1]"),
            ("frames", "        or frame[end + 2]", "        and frame[end + 2]"),
        ),
    ),
    # --- COBS
    Fault("COBS without the zeros between its runs", "", (("frames", _JOIN, ""),)),
    Fault(
        "COBS with a zero after the last run",
        "",
        (("frames", _JOIN, _JOIN.replace("at < end", "at <= end")),),
    ),
    Fault("COBS run past the end of its frame", "", (("frames", _RUN, ""),)),
    Fault(
        "COBS run past the end of its frame by one",
        "",
        (("frames", _RUN, _RUN.replace("> end", "> end + 1")),),
    ),
    Fault(
        "COBS run shortened to the end of its frame",
        "",
        (("frames", _RUN, "        stop = min(stop, end)\n"),),
    ),
    Fault(
        "COBS sent with its length one too small after a zero",
        "",
        (("frames", "    out[code] = at - code\n    # Over", "    out[code] = at - code - (code > first)\n    # Over"),),
    ),
    # --- lengths
    Fault(
        "frame of 125 bytes taken",
        "",
        (("frames", "<= size <= MAX_FRAME:", "<= size <= MAX_FRAME + 1:"),),
    ),
    Fault(
        "frame of 124 bytes dropped",
        "",
        (("frames", "<= size <= MAX_FRAME:", "<= size < MAX_FRAME:"),),
    ),
    Fault(
        "buffer of 64 bytes",
        "",
        (("frames", "<= size <= MAX_FRAME:", "<= size <= 64:"),),
    ),
    Fault(
        "frame longer than 124 bytes cut there, and its first bytes taken",
        "",
        (
            ("frames", "    end = size - 3\n", "    end = min(size, MAX_FRAME) - 3\n"),
            ("frames", "<= size <= MAX_FRAME:", "<= size:"),
        ),
    ),
    Fault(
        "collects anew after 125 bytes without an edge",
        "",
        (("frames", _COLLECT, _COLLECT.replace("            return 0\n", "            else:\n                self._frame[0] = byte\n                self._count = 1\n            return 0\n")),),
    ),
    Fault(
        "forgets what it has at 125 bytes without an edge",
        "",
        (("frames", _COLLECT, _COLLECT.replace("            return 0\n", "            else:\n                self._count = 0\n            return 0\n")),),
    ),
    Fault(
        "collects anew after 256 bytes without an edge",
        "",
        (
            ("frames", "self._frame = bytearray(MAX_FRAME + 1)", "self._frame = bytearray(256)"),
            ("frames", _COLLECT, "            self._frame[count] = byte\n            self._count = (count + 1) % 256\n            return 0\n"),
        ),
    ),
    Fault(
        "keeps the last bytes of a run that is too long",
        "",
        (
            (
                "frames",
                _COLLECT,
                _COLLECT.replace(
                    "            return 0\n",
                    "            else:\n                self._frame[:-1] = self._frame[1:]\n"
                    "                self._frame[MAX_FRAME] = byte\n            return 0\n",
                ),
            ),
            ("frames", "<= size <= MAX_FRAME:", "<= size:"),
            ("frames", "    end = size - 3\n", "    if size > MAX_FRAME:\n        for start in range(size - 5):\n            length = decode(frame[start:size], size - start, body) if size - start <= MAX_FRAME else 0\n            if length:\n                return length\n    end = size - 3\n"),
        ),
    ),
    Fault(
        "finds a frame that begins without an edge",
        "",
        (
            (
                "frames",
                "        return decode(self._frame, count, self.body)",
                "        for start in range(max(count - 5, 1)):\n"
                "            size = decode(self._frame[start:], count - start, self.body)\n"
                "            if size:\n                return size\n        return 0",
            ),
        ),
    ),
    Fault(
        "finds a frame that ends without an edge",
        "",
        (
            (
                "frames",
                _COLLECT,
                _COLLECT.replace(
                    "            return 0\n",
                    "                size = decode(self._frame, count + 1, self.body)\n"
                    "                if size:\n                    self._count = 0\n"
                    "                    return size\n            return 0\n",
                ),
            ),
        ),
    ),
    # --- edges
    Fault(
        "wants two edges between frames",
        "",
        (
            ("frames", "        self._count = 0\n\n", "        self._count = 0\n        self._open = False\n\n"),
            ("frames", "        if byte:\n            # One", "        if byte:\n            if not self._open:\n                return 0\n            # One"),
            ("frames", _EMPTY, "        self._open = not count\n" + _EMPTY),
        ),
    ),
    Fault(
        "loses the frame after an empty one",
        "",
        (
            ("frames", "        self._count = 0\n\n", "        self._count = self._empty = 0\n\n"),
            ("frames", _EMPTY, "        self._empty = 0 if count else self._empty + 1\n        if count and self._lost:\n            self._lost = False\n            return 0\n        self._lost = self._empty > 2\n" + _EMPTY),
            ("frames", "        self._frame = bytearray", "        self._lost = False\n        self._frame = bytearray"),
        ),
    ),
    Fault(
        "loses the frame after a damaged one",
        "",
        (
            ("frames", "        self._frame = bytearray", "        self._lost = False\n        self._frame = bytearray"),
            (
                "frames",
                "        return decode(self._frame, count, self.body)",
                "        size = 0 if self._lost else decode(self._frame, count, self.body)\n"
                "        self._lost = not size and not self._lost\n        return size",
            ),
        ),
    ),
    Fault(
        "frame that is cut by a pause lost",
        "",
        (
            (
                "session",
                "        decoder = self._decoder\n",
                "        decoder = self._decoder\n        if count:\n            if now - self._last_byte > 50:\n"
                "                decoder._count = 0\n            self._last_byte = now\n",
            ),
            ("session", "        self._host = 0\n", "        self._host = self._last_byte = 0\n"),
        ),
    ),
    Fault(
        "frame of two reads lost",
        "",
        (("session", "        decoder = self._decoder\n", "        decoder = self._decoder\n        decoder._count = 0\n"),),
    ),
    Fault(
        "one frame of each read taken",
        "",
        (
            (
                "session",
                "                    self._receive_message(values, now)\n",
                "                    self._receive_message(values, now)\n                    break\n",
            ),
        ),
    ),
    Fault("no edge before a frame", "", (("frames", "    out[at] = 0\n    first = code = at + 1\n    at += 2\n", "    first = code = at\n    at += 1\n"),)),
    Fault("no edge after a frame", "", (("frames", "    out[at + 3] = 0\n    return at + 4\n", "    return at + 3\n"),)),
    Fault(
        "text of the developer between frames",
        "",
        (("session", "        self._last_state = now\n        body", "        self._last_state = now\n        self._send_buffer.data[self._send_buffer.end : self._send_buffer.end + 4] = b'ok\\r\\n'\n        self._send_buffer.end += 4\n        body"),),
    ),
    Fault("crash when more is to be sent than fits", "", (("frames", _FULL, ""),)),
    Fault(
        "half a frame sent when the rest does not fit",
        "",
        (("frames", _FULL, _FULL.replace("            return\n", "            self.data[self.end :] = encode_part(body, size, len(self.data) - self.end)\n            self.end = len(self.data)\n            return\n")),
         ("frames", "class TransmitBuffer:", "def encode_part(body: bytearray, size: int, count: int) -> bytes:\n    out = bytearray(200)\n    encode(body, size, out, 0)\n    return bytes(out[:count])\n\n\nclass TransmitBuffer:")),
    ),
)
