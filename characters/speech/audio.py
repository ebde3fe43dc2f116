"""Sound files: read as one channel, at their own rate; WAV without a library, the rest by PyAV."""

import io
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import IO

import numpy as np
from numpy.typing import NDArray

from cubeling.characters.errors import CharacterError
from cubeling.characters.speech.speech import Samples, Speech
from cubeling.files import FileKind

SOUND_FILE = FileKind(
    "sound",
    (".wav", ".flac", ".mp3", ".ogg"),
    CharacterError,
    4 << 30,
    "cubeling.characters.speech.audio:read_speech",
)
"""A sound of at most `MAX_S`, or the sound of a video."""

MAX_S = 2 * 3600.0
"""Longest sound that is read [s]: at 48 kHz its samples take 1.4 GB."""

RATES = (4000, 768_000)
"""Lowest and highest sample rate [Hz]; a telephone has 8000."""

BLOCK_BYTES = 1 << 22
"""Bytes of a WAV file that are converted at once."""

PCM, FLOAT, EXTENSIBLE = 1, 3, 0xFFFE  # formats of a WAV file

SINC_ZEROS = 16
"""Zero crossings of the interpolating kernel on each side."""


def read_speech(path: Path, most_s: float = MAX_S) -> Speech:
    """Read a sound file of any kind; its text is not known, its channels are averaged.

    Parameters
    ----------
    path
        The file.
    most_s
        Longest sound that is read [s].

    Raises
    ------
    CharacterError
        There is no such file, it is no sound file or broken, it has no sound, or too much.
    """
    try:
        with SOUND_FILE.open(path) as file:
            rate, blocks = _wave(file, path) or _decode(path)
            samples = _join(blocks, rate, path, most_s)
    except OSError as error:
        raise CharacterError(f"cannot read '{path}': {error.strerror or error}") from error
    if not len(samples):
        raise CharacterError(f"'{path}' has no sound: its audio is empty or broken")
    low, high = float(samples.min()), float(samples.max())
    if not np.isfinite(low + high):
        raise CharacterError(f"'{path}' has samples that are not numbers; write it again")
    peak = max(high, -low)
    if peak > 1.0:  # a float file may be louder than full scale
        samples /= np.float32(peak)
    return Speech(samples, rate)


def resample(samples: Samples, rate: int, new_rate: int) -> Samples:
    """Return a sound at another sample rate, without what the lower rate cannot carry.

    Interpolates with a sinc kernel under a Hann window (J. O. Smith, "Digital Audio Resampling Home
    Page", CCRMA, 2002).
    """
    if rate == new_rate or not len(samples):
        return samples
    divisor = int(np.gcd(rate, new_rate))
    up, down = new_rate // divisor, rate // divisor
    cutoff = min(1.0, 0.97 * up / down)
    half = int(np.ceil(SINC_ZEROS / cutoff))
    count = -(-len(samples) * up // down)
    padded = np.pad(samples, (half, half + down + 1))
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * half)
    made = np.zeros(count, np.float32)
    taps = np.arange(1 - half, half + 1)
    for phase in range(min(up, count)):
        whole, part = divmod(phase * down, up)
        at = taps - part / up
        kernel = cutoff * np.sinc(cutoff * at) * (0.5 + 0.5 * np.cos(np.pi * at / half))
        kernel[np.abs(at) >= half] = 0.0
        own = windows[whole + 1 :: down][: len(made[phase::up])]
        made[phase::up] = own @ kernel.astype(np.float32)
    return made


def _join(blocks: Iterator[NDArray[np.float32]], rate: int, path: Path, most_s: float) -> Samples:
    """Return all blocks as one array."""
    if not RATES[0] <= rate <= RATES[1]:
        raise CharacterError(f"'{path}' has {rate} samples a second: {RATES[0]} to {RATES[1]} work")
    parts, count = [], 0
    for block in blocks:
        parts.append(block)
        count += len(block)
        if count > most_s * rate:
            longest = f"{most_s / 3600:g} hours" if most_s >= 3600 else f"{most_s:g} s"
            raise CharacterError(f"'{path}' is longer than {longest}: cut it")
    return np.concatenate(parts) if parts else np.zeros(0, np.float32)


def _wave(file: IO[bytes], path: Path) -> tuple[int, Iterator[NDArray[np.float32]]] | None:
    """Return the rate and the blocks of a WAV file; None if it is none, or one for PyAV."""
    head = file.read(12)
    if head[:4] != b"RIFF" or head[8:] != b"WAVE":
        return None
    form: tuple[int, ...] | None = None
    while len(chunk := file.read(8)) == 8:
        name, size = chunk[:4], int.from_bytes(chunk[4:], "little")
        if name == b"fmt ":
            body = file.read(size + size % 2)
            if len(body) < 16:
                break
            form = struct.unpack("<HHIIHH", body[:16])
            if form[0] == EXTENSIBLE and len(body) >= 26:
                form = (int.from_bytes(body[24:26], "little"), *form[1:])
        elif name == b"data" and form is not None:
            kind, channels, rate, _, frame_bytes, bits = form
            dtype = _sample_type(kind, bits)
            if dtype is None or channels < 1 or frame_bytes != channels * dtype.itemsize:
                return None
            return rate, _wave_blocks(file, size, channels, dtype)
        else:
            file.seek(size + size % 2, io.SEEK_CUR)
    raise CharacterError(f"'{path}' is a broken WAV file: it has no format or no data")


def _sample_type(kind: int, bits: int) -> np.dtype[np.generic] | None:
    """Return the type of a sample in a WAV file; three bytes for 24 bits."""
    names = {(PCM, 8): "u1", (PCM, 16): "<i2", (PCM, 24): "V3", (PCM, 32): "<i4"}
    names |= {(FLOAT, 32): "<f4", (FLOAT, 64): "<f8"}
    return np.dtype(names[kind, bits]) if (kind, bits) in names else None


def _wave_blocks(
    file: IO[bytes], size: int, channels: int, dtype: np.dtype[np.generic]
) -> Iterator[NDArray[np.float32]]:
    """Yield the samples of a WAV file's data; a file that ends early, or says no size, is read."""
    frame = channels * dtype.itemsize
    unknown = size in (0, 0xFFFFFFFF)  # written by a pipe
    left = np.inf if unknown else size
    while left > 0 and (data := file.read(int(min(left, BLOCK_BYTES // frame * frame)))):
        left -= len(data)
        whole = np.frombuffer(data[: len(data) // frame * frame], dtype)
        yield _as_float(whole).reshape(-1, channels).mean(1, dtype=np.float32)


def _as_float(values: NDArray[np.generic]) -> NDArray[np.float32]:
    """Return samples of a WAV file from −1 to 1."""
    if values.dtype.kind == "f":
        return values.astype(np.float32)
    if values.dtype.kind == "V":
        wide = np.zeros((len(values), 4), np.uint8)
        wide[:, 1:] = values.view(np.uint8).reshape(-1, 3)
        values = wide.view("<i4")[:, 0]
    offset, full = {"u1": (128.0, 2.0**7), "i2": (0.0, 2.0**15), "i4": (0.0, 2.0**31)}[
        values.dtype.str[1:]
    ]
    return ((values.astype(np.float64) - offset) / full).astype(np.float32)


def _decode(path: Path) -> tuple[int, Iterator[NDArray[np.float32]]]:
    """Return the rate and the blocks of a sound or video file that PyAV reads."""
    import av  # slow to load, and a WAV file does not need it

    try:
        container = av.open(  # "file:", as a name with a colon is no address
            f"file:{path}", metadata_errors="replace"
        )
    except av.error.FFmpegError as error:
        raise CharacterError(f"'{path}' is no sound file that can be read") from error
    if not container.streams.audio:
        container.close()
        raise CharacterError(f"'{path}' has no sound")
    stream = container.streams.audio[0]
    rate = getattr(stream, "rate", None)
    if not rate:  # no decoder, or no header
        container.close()
        raise CharacterError(f"'{path}' has sound of a kind that cannot be read")

    def blocks() -> Iterator[NDArray[np.float32]]:
        resampler = av.AudioResampler(format="fltp", layout=stream.layout, rate=rate)
        with container:
            try:
                for frame in container.decode(stream):
                    for each in resampler.resample(frame):
                        yield each.to_ndarray().mean(0, dtype=np.float32)
            except av.error.FFmpegError:
                return  # a file that is cut off: what came before it counts

    return int(rate), blocks()
