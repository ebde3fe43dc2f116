"""A proxy on loopback that stalls, slows down, drops or forgets connections, and is cut off."""

import asyncio
import contextlib


class FaultyProxy:
    """Forwards connections to a port, with faults for as long as their coroutines take."""

    def __init__(self, target: int) -> None:
        self._target = target
        self._flowing = asyncio.Event()
        self._flowing.set()
        self._cut = self._forgets = False
        self._forgotten: set[asyncio.StreamWriter] = set()
        self.bytes_per_s = 0.0
        """What it carries each way; 0 for all."""
        self.up, self.down = 0, 0
        """Bytes that went to the server, and from it."""
        self._writers: set[asyncio.StreamWriter] = set()
        self.port = 0

    async def __aenter__(self) -> "FaultyProxy":
        self._server = await asyncio.start_server(self._serve, "127.0.0.1", 0)
        self.port = self._server.sockets[0].getsockname()[1]
        return self

    async def __aexit__(self, *_: object) -> None:
        self._server.close()
        self.drop()

    def drop(self) -> None:
        """End all connections at once."""
        for writer in tuple(self._writers):
            writer.transport.abort()

    async def stall(self, seconds: float) -> None:
        """Hold back what comes for some seconds; nobody is told."""
        self._flowing.clear()
        await asyncio.sleep(seconds)
        self._flowing.set()

    async def slow_down(self, seconds: float, bytes_per_s: float) -> None:
        """Let only so much through each way of a connection, for some seconds."""
        self.bytes_per_s = bytes_per_s
        await asyncio.sleep(seconds)
        self.bytes_per_s = 0.0

    async def cut(self, seconds: float) -> None:
        """End all connections, and refuse new ones for some seconds."""
        self._cut = True
        self.drop()
        await asyncio.sleep(seconds)
        self._cut = False

    async def forget(self, seconds: float) -> None:
        """Say nothing more, ever, on the connections that are there in some seconds.

        So it is for those of a router that was switched off, or of a phone in another network:
        nobody is told, and only new connections work.
        """
        self._forgets = True
        self._forgotten |= self._writers
        await asyncio.sleep(seconds)
        self._forgets = False

    async def _serve(self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        if self._cut:
            writer.transport.abort()
            return
        try:
            to_reader, to_writer = await asyncio.open_connection("127.0.0.1", self._target)
        except OSError:
            writer.transport.abort()
            return
        pair = {writer, to_writer}
        self._writers |= pair
        if self._forgets:
            self._forgotten |= pair
        await asyncio.gather(
            self._copy(reader, to_writer, up=True), self._copy(to_reader, writer, up=False)
        )
        self._writers -= pair
        self._forgotten -= pair

    async def _copy(
        self, reader: asyncio.StreamReader, writer: asyncio.StreamWriter, *, up: bool
    ) -> None:
        with contextlib.suppress(OSError):
            while data := await reader.read(65536):
                await self._flowing.wait()
                if writer in self._forgotten:
                    continue
                if self.bytes_per_s:
                    await asyncio.sleep(len(data) / self.bytes_per_s)
                self.up += len(data) if up else 0
                self.down += 0 if up else len(data)
                writer.write(data)
                await writer.drain()
        writer.close()
