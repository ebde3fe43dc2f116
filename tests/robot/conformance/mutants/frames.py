"""Robots that break sections 2 and 3."""

from typing import Any

from cubeling.robot.protocol import messages as m
from cubeling.robot.protocol.schema import MESSAGES, pack
from cubeling.robot.protocol.wire import FrameError, cobs_decode, crc16, decode_frame, encode_frame
from tests.robot.conformance.mutants.base import Mutant, breaks


@breaks("garbage before a frame", "half a frame before a frame")
class LosesTheFrameAfterGarbage(Mutant):
    lost = False

    def decode(self, frame: bytes) -> bytes | None:
        body = super().decode(frame)
        lost, self.lost = self.lost, body is None
        return None if lost else body


@breaks("half a frame before a frame", "frames in one go")
class EndsAFrameAtEverySecondEdge(Mutant):
    def frames(self, data: bytes) -> list[bytes]:
        pieces = (self.pending + data).split(b"\0")
        whole = pieces[1 : len(pieces) - 1 : 2]
        self.pending = b"" if len(pieces) % 2 else b"\0" + pieces[-1]
        return [piece for piece in whole if piece]


@breaks("frame in pieces")
class ReadsOnlyWholeFrames(Mutant):
    def frames(self, data: bytes) -> list[bytes]:
        self.pending = b""
        return super().frames(data)


@breaks("frames in one go")
class TakesOneFrameOfEachRead(Mutant):
    def frames(self, data: bytes) -> list[bytes]:
        return super().frames(data)[:1]


@breaks("wrong bit dropped", "failsafe not reset by noise")
class IgnoresTheCheck(Mutant):
    def decode(self, frame: bytes) -> bytes | None:
        try:
            return cobs_decode(frame[:-3])
        except FrameError:
            return None


@breaks("wrong bit dropped")
class ComparesHalfOfTheCheck(Mutant):
    def decode(self, frame: bytes) -> bytes | None:
        good = encode_frame(b"\1")
        del good
        crc = crc16(frame[:-3])
        if len(frame) < 5 or frame[-3] & 15 != crc >> 12 or frame[-2] & 63 != crc >> 6 & 63:
            return None
        try:
            return cobs_decode(frame[:-3])
        except FrameError:
            return None


@breaks("wrong mark dropped")
class MasksTheMarks(Mutant):
    def decode(self, frame: bytes) -> bytes | None:
        high, middle, low = frame[-3:] if len(frame) > 3 else (0, 0, 0)
        marked = bytes([high & 15 | 0xE0, middle & 63 | 0x80, low & 63 | 0x80])
        return super().decode(frame[:-3] + marked)


@breaks("wrong cobs dropped")
class ReadsCobsPastItsEnd(Mutant):
    def decode(self, frame: bytes) -> bytes | None:
        body = super().decode(frame)
        if body is None and len(frame) > 4 and frame[-3:] == _check(frame[:-3]):
            return frame[1:-3]
        return body


@breaks("longest frame received")
class HasASmallBuffer(Mutant):
    def decode(self, frame: bytes) -> bytes | None:
        return super().decode(frame) if len(frame) <= 100 else None


@breaks("longer frame dropped")
class HasALargeBuffer(Mutant):
    def frames(self, data: bytes) -> list[bytes]:
        *ended, self.pending = (self.pending + data).split(b"\0")
        return [piece for piece in ended if piece]

    def decode(self, frame: bytes) -> bytes | None:
        if len(frame) > 124 and frame[-3:] == _check(frame[:-3]):
            return cobs_decode(frame[:-3])[:120]
        return super().decode(frame)


@breaks("flood survived")
class DiesOfTooMuchNoise(Mutant):
    noise = 0

    def frames(self, data: bytes) -> list[bytes]:
        self.noise += len(data)
        return [] if self.noise > 4000 else super().frames(data)


@breaks("sends valid frames")
class PrintsWhatItDoes(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        self.write(b"beat\r\n")
        super().send_message(session, message)


@breaks("sends valid frames")
class SendsAWrongCheck(Mutant):
    count = 0

    def send_message(self, session: int, message: Any) -> None:
        self.count += 1
        frame = bytearray(encode_frame(pack(message, session)))
        frame[-2] ^= self.count % 5 == 0
        self.write(bytes(frame))


@breaks("sends valid frames")
class SendsALongerState(Mutant):
    count = 0

    def send_message(self, session: int, message: Any) -> None:
        self.count += 1
        more = b"\7" if self.count % 5 == 0 else b""
        self.write(encode_frame(pack(message, session) + more))


@breaks("sends valid frames")
class EchoesTheHost(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        self.write(encode_frame(body))
        super().on_body(number, session, body)


@breaks("sends valid frames")
class HasABatteryBeyondFull(Mutant):
    def send_message(self, session: int, message: Any) -> None:
        frame = pack(message, session)
        if isinstance(message, m.State) and message.beat % 3 == 0:
            frame = frame[:14] + (12000).to_bytes(2, "little") + frame[16:]
        self.write(encode_frame(frame))


# --- Section 3 -----------------------------------------------------------------------------------


@breaks("unknown message skipped")
class AcknowledgesWhatItDoesNotKnow(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number not in MESSAGES:
            self.send(session, m.Ack(1, m.RESULT_REFUSED))
        super().on_body(number, session, body)


@breaks("unknown message skipped", "echo skipped")
class LooksAtTheSessionFirst(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        form = MESSAGES.get(number)
        if (form is None or form.sender == "robot") and session != self.session:
            self.send(session, m.Gone())
        super().on_body(number, session, body)


@breaks("short body skipped")
class FillsShortBodiesUp(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number in MESSAGES:
            body += bytes(max(MESSAGES[number].size - len(body), 0))
        super().on_body(number, session, body)


@breaks("longer body used")
class WantsExactLengths(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number not in MESSAGES or len(body) <= MESSAGES[number].parts[-1].end:
            super().on_body(number, session, body)


@breaks("field out of range skipped")
class ClampsFields(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number == 0x10:
            clamped = bytearray(body)
            for place in (7, 9):
                value = int.from_bytes(body[place : place + 2], "little", signed=True)
                value = max(-10000, min(10000, value))
                clamped[place : place + 2] = value.to_bytes(2, "little", signed=True)
            body = bytes(clamped)
        super().on_body(number, session, body)


@breaks("field out of range skipped")
class GreetsAnyVersion(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number == 1 and body[3] == 0:
            body = body[:3] + b"\1" + body[4:]
        super().on_body(number, session, body)


@breaks("express of version 1 used")
class KnowsOnlyTheLongExpress(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        if number != 0x10 or len(body) >= 12:
            super().on_body(number, session, body)


@breaks("express of version 2 used")
class IgnoresTheMood(Mutant):
    def on_body(self, number: int, session: int, body: bytes) -> None:
        super().on_body(number, session, body[:11] if number == 0x10 else body)


def _check(encoded: bytes) -> bytes:
    crc = crc16(encoded)
    return bytes([0xE0 | crc >> 12, 0x80 | crc >> 6 & 0x3F, 0x80 | crc & 0x3F])


assert _check(b"\2\1") == encode_frame(b"\1")[-4:-1]
assert decode_frame(b"\2\1" + _check(b"\2\1")) == b"\1"
