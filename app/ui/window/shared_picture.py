"""A picture in memory that an X server shares, and shows in a window.

Without a graphics card, OpenGL takes several milliseconds on all cores to copy a picture into a
window. The server copies shared memory (MIT-SHM) once. The connection to it is one of its own, so
that errors in it end no program.
"""

import ctypes
import mmap
import os
from ctypes import POINTER, byref, c_int, c_int16, c_uint8, c_uint16, c_uint32, c_void_p
from typing import Any, Self

import numpy as np
from numpy.typing import NDArray

Pixels = NDArray[np.uint8]

Z_PIXMAP = 2
"""X's name for pixels one after the other."""

TRUE_COLOR_DEPTHS = (24, 32)
"""Bits of a pixel whose bytes are blue, green, red and one more."""

MIN_VERSION = (1, 2)
"""The version of MIT-SHM that takes file descriptors."""


class _Cookie(ctypes.Structure):
    _fields_ = (("sequence", ctypes.c_uint),)


class _Geometry(ctypes.Structure):
    _fields_ = (("response_type", c_uint8), ("depth", c_uint8))


class _Version(ctypes.Structure):
    _fields_ = (("header", c_uint32 * 2), ("major", c_uint16), ("minor", c_uint16))


class _Extension(ctypes.Structure):
    _fields_ = (("header", c_uint32 * 2), ("present", c_uint8))


class _Xcb:
    """The functions of libxcb that are needed, on one connection."""

    def __init__(self) -> None:
        """Load the libraries and connect; raise OSError if that fails."""
        self._xcb, self._shm = ctypes.CDLL("libxcb.so.1"), ctypes.CDLL("libxcb-shm.so.0")
        self._free = ctypes.CDLL(None).free
        self._free.argtypes = (c_void_p,)
        self._xcb.xcb_connect.restype = c_void_p
        self.connection: int | None = self._xcb.xcb_connect(None, None)
        self._check = self.function(self._xcb, "xcb_request_check", c_void_p, _Cookie)
        self.flush = self.function(self._xcb, "xcb_flush", c_int)
        if self.function(self._xcb, "xcb_connection_has_error", c_int)():
            self.close()
            raise OSError("there is no X server")

    def function(self, library: Any, name: str, result: Any, *arguments: Any) -> Any:
        """Return a function of the connection that takes the other arguments."""
        found = library[name]
        found.restype, found.argtypes = result, (c_void_p, *arguments)
        return lambda *given: found(self.connection, *given)

    def request(self, name: str, *arguments: Any) -> Any:
        """Return a function that sends a request and returns its cookie."""
        library = self._shm if name.startswith("xcb_shm") else self._xcb
        return self.function(library, name, _Cookie, *arguments)

    def reply(self, name: str, kind: type[ctypes.Structure], cookie: _Cookie) -> Any:
        """Return the reply of a request; None for an error."""
        library = self._shm if name.startswith("xcb_shm") else self._xcb
        read = self.function(library, f"{name}_reply", c_void_p, _Cookie, c_void_p)
        address = read(cookie, None)
        if not address:
            return None
        copied = kind.from_buffer_copy(ctypes.string_at(address, ctypes.sizeof(kind)))
        self._free(address)
        return copied

    def succeeded(self, cookie: _Cookie) -> bool:
        """Wait for a checked request, and return whether the server has done it."""
        error = self._check(cookie)
        self._free(error)
        return not error

    def new_id(self) -> int:
        return int(self.function(self._xcb, "xcb_generate_id", c_uint32)())

    def has_shared_memory(self) -> bool:
        """Return whether the server has MIT-SHM with file descriptors."""
        found = self.function(self._xcb, "xcb_get_extension_data", POINTER(_Extension), c_void_p)
        extension = found(byref(ctypes.c_char.in_dll(self._shm, "xcb_shm_id")))
        if not extension or not extension.contents.present:
            return False
        cookie = self.request("xcb_shm_query_version")()
        version = self.reply("xcb_shm_query_version", _Version, cookie)
        return version is not None and (version.major, version.minor) >= MIN_VERSION

    def close(self) -> None:
        if self.connection is not None:
            self.function(self._xcb, "xcb_disconnect", None)()
            self.connection = None


class SharedPicture:
    """A picture that an X server shows in a window.

    Whoever opens it closes it, before the window; a second `close` does nothing. One thread uses
    it at a time.
    """

    def __init__(self, xcb: _Xcb, window: int, depth: int) -> None:
        self._xcb, self._window, self._depth = xcb, window, depth
        self._context, self._segment = xcb.new_id(), 0
        create = xcb.request("xcb_create_gc", c_uint32, c_uint32, c_uint32, c_void_p)
        create(self._context, window, 0, None)
        self._ask = xcb.request("xcb_get_input_focus")
        self._put = xcb.request(
            "xcb_shm_put_image",
            *(c_uint32, c_uint32),
            *(c_uint16,) * 6,
            *(c_int16, c_int16),
            *(c_uint8,) * 3,
            *(c_uint32, c_uint32),
        )
        self._pixels: Pixels = np.empty((0, 0, 4), np.uint8)
        self._read: _Cookie | None = None

    @classmethod
    def open(cls, window: int) -> Self | None:
        """Return one for a window by its X id; None where the server shares no memory with us."""
        try:
            xcb = _Xcb()
        except (OSError, AttributeError):  # not on this computer
            return None
        asked = xcb.request("xcb_get_geometry", c_uint32)(window)
        geometry = xcb.reply("xcb_get_geometry", _Geometry, asked)
        if geometry is not None and geometry.depth in TRUE_COLOR_DEPTHS and xcb.has_shared_memory():
            picture = cls(xcb, window, geometry.depth)
            if picture._share(1, 1):  # a server on another computer cannot
                return picture
        xcb.close()
        return None

    def pixels(self, width: int, height: int) -> Pixels:
        """Return the pixels to draw on, (height, width, 4) BGRX, with what was there before.

        They are new if the size is. Where the server takes no more memory, nothing is shown.
        """
        self.finish()
        if self._pixels.shape[:2] != (height, width) and not self._share(width, height):
            self._pixels = np.zeros((height, width, 4), np.uint8)
        return self._pixels

    def show(self) -> None:
        """Show the pixels; they must not be changed before `pixels` returns."""
        if not self._segment:
            return
        height, width = self._pixels.shape[:2]
        whole, origin = (width, height, 0, 0, width, height), (0, 0)
        kind = self._depth, Z_PIXMAP, 0
        self._put(self._window, self._context, *whole, *origin, *kind, self._segment, 0)
        self._read = self._ask()  # answered when the pixels are read
        self._xcb.flush()

    def close(self) -> None:
        """Disconnect; the server then forgets the memory."""
        self._xcb.close()

    def finish(self) -> None:
        """Wait until the server has read what is shown, and so shows it."""
        if self._read is not None:
            self._xcb.reply("xcb_get_input_focus", _Geometry, self._read)
            self._read = None

    def _share(self, width: int, height: int) -> bool:
        """Share memory of another size; return whether the server takes it."""
        if self._segment:
            self._xcb.request("xcb_shm_detach", c_uint32)(self._segment)
            self._segment = 0
        file = os.memfd_create("cubeling-picture")
        try:
            size = 4 * width * height
            os.ftruncate(file, size)
            memory = mmap.mmap(file, size)
            segment = self._xcb.new_id()
            attach = self._xcb.request("xcb_shm_attach_fd_checked", c_uint32, c_int, c_uint8)
            if not self._xcb.succeeded(attach(segment, os.dup(file), 1)):  # which closes it
                return False
        finally:
            os.close(file)
        self._segment = segment
        self._pixels = np.frombuffer(memory, np.uint8).reshape(height, width, 4)
        return True
