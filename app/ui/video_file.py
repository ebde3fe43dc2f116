"""Writing pictures, and what is heard with them, to a video file or an animation."""

import os
from collections.abc import Callable
from contextlib import suppress
from fractions import Fraction
from pathlib import Path
from typing import Self

import av
import av.filter
import numpy as np
from numpy.typing import NDArray

from cubeling.app.errors import AppError
from cubeling.app.sound import SAMPLE_RATE
from cubeling.app.ui.output_formats import AUTO_CODEC, ENCODERS, VIDEO_FORMATS

AudioSource = Callable[[int], NDArray[np.float32]]
"""Returns the next samples of stereo sound, (count, 2)."""

AUDIO_BIT_RATE = 128_000
"""Size of the sound in the file [bit/s]."""

# Half the processor time of the encoder's default search.
_AUDIO_OPTIONS = {"aac": {"aac_coder": "fast"}}


def has_sound(path: Path) -> bool:
    """Return whether the suffix of a file names a kind of video with sound."""
    format_ = VIDEO_FORMATS.get(path.suffix.lower())
    return format_ is not None and bool(format_.audio_codec)


class VideoFile:
    """Writes pictures to a video or an animated GIF, as the suffix says.

    Until `close` the file is called `PATH.partial`; `discard` removes it.

    Parameters
    ----------
    path
        The file; its suffix is one of `VIDEO_FORMATS`, in upper or lower case.
    size
        Width and height of the pictures [px].
    rate
        Pictures a second.
    sound
        What is heard with the pictures: before a picture is written, it is asked for the samples
        up to that picture. None for a silent video; a GIF is always silent.
    codec
        FFmpeg's name of the encoder, one of `VideoFileFormat.encoders`; "auto" for the first of
        them that FFmpeg has.

    Raises
    ------
    AppError
        The file cannot be written, or FFmpeg lacks the encoder.
    """

    def __init__(
        self,
        path: Path,
        size: tuple[int, int],
        rate: float,
        sound: AudioSource | None = None,
        codec: str = AUTO_CODEC,
    ) -> None:
        encoder = _available_encoder(path, codec)
        self._path = path
        self._partial = path.with_name(path.name + ".partial")
        self._format = VIDEO_FORMATS[path.suffix.lower()]
        self._start: float | None = None
        self._next = 0.0
        self._last = -1
        try:
            self._partial.touch()
            self._file = av.open(
                str(self._partial),
                "w",
                format=self._format.container,
                options=dict(self._format.container_options),
            )
        except OSError as error:
            raise AppError(f"cannot write the video '{path}': {error.strerror}") from error
        stream = self._file.add_stream(
            encoder, rate=Fraction(round(rate)), options=dict(ENCODERS[encoder])
        )
        assert isinstance(stream, av.VideoStream)
        if encoder == "libx265" and self._format.container == "mp4":
            stream.codec_context.codec_tag = "hvc1"  # Apple's players open no other kind of HEVC
        scale = min(1.0, self._format.max_width / size[0])
        stream.width, stream.height = (2 * int(scale * side / 2) for side in size)
        stream.pix_fmt = self._format.pixel_format
        # For the encoder too: in its default steps of 1/rate, frames of a live camera can coincide.
        self._time_base = Fraction(1, self._format.ticks_per_s)
        stream.time_base = stream.codec_context.time_base = self._time_base
        self._stream = stream
        self._picture_time = 1.0 / rate
        self._track: AudioTrack | None = None
        if sound is not None and self._format.audio_codec:
            self._track = AudioTrack(self._file, self._format.audio_codec, sound)
        self._palette: av.filter.Graph | None = None
        if stream.pix_fmt == "pal8":
            self._palette = _palette_graph(size, (stream.width, stream.height), self._time_base)
        self._open = True

    def __enter__(self) -> Self:
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        if kind is None:
            self.close()
        else:
            self.discard()

    def write(self, picture: NDArray[np.uint8], timestamp: float) -> None:
        """Write one picture (H, W, 3) BGR at a time [s]."""
        if self._start is None:
            self._start = timestamp
        elapsed = timestamp - self._start
        if elapsed + 1e-6 < self._next:
            return
        self._next = max(self._next + self._format.interval, elapsed)
        self._last = max(self._last + 1, round(elapsed * self._format.ticks_per_s))
        try:
            if self._track is not None:
                self._track.write_until(elapsed)
            self._file.mux(self._stream.encode(self._frame(picture)))
        except OSError as error:
            raise self._write_error(error) from error

    def _frame(self, picture: NDArray[np.uint8]) -> av.VideoFrame:
        """Return a picture as the encoder takes it."""
        if self._palette is None:
            picture = picture[: self._stream.height, : self._stream.width]
        frame = av.VideoFrame.from_ndarray(np.ascontiguousarray(picture), format="bgr24")
        frame.pts, frame.time_base = self._last, self._time_base
        if self._palette is None:
            return frame
        self._palette.vpush(frame)
        return self._palette.vpull()

    def close(self) -> None:
        """Finish the file and rename it to its final name; without a picture, leave no file."""
        if not self._open:
            return
        if self._start is None:
            self.discard()
            return
        try:
            self._finish()
        except OSError as error:
            raise self._write_error(error) from error
        finally:
            self.discard()

    def _finish(self) -> None:
        if self._track is not None:
            self._track.finish(self._last / self._format.ticks_per_s + self._picture_time)
        self._file.mux(self._stream.encode())
        self._file.close()
        os.replace(self._partial, self._path)
        self._open = False

    def discard(self) -> None:
        """Close and delete the unfinished file."""
        if self._open:
            self._open = False
            with suppress(OSError):  # such as a full disk, the reason for discarding it
                self._file.close()
            self._partial.unlink(missing_ok=True)

    def _write_error(self, error: OSError) -> AppError:
        return AppError(f"writing the video '{self._path}' failed: {error.strerror}")


def _available_encoder(path: Path, codec: str) -> str:
    """Return the encoder of a video's pictures; AppError if FFmpeg lacks it."""
    encoders = VIDEO_FORMATS[path.suffix.lower()].encoders
    available = [name for name in encoders if _is_available(name)]
    chosen = available[:1] if codec == AUTO_CODEC else [codec]
    if not chosen or chosen[0] not in available:
        lacking = ", ".join(chosen or encoders)
        instead = f"; it has {', '.join(available)}" if available else ""
        raise AppError(f"cannot write the video '{path}': PyAV lacks {lacking}{instead}")
    if chosen == ["libsvtav1"]:
        os.environ.setdefault("SVT_LOG", "1")  # errors only: it prints its settings otherwise
    return chosen[0]


def _is_available(encoder: str) -> bool:
    """Return whether the FFmpeg of PyAV's wheel has an encoder."""
    try:
        return av.Codec(encoder, "w").name == encoder  # it finds decoders' names too, such as h264
    except ValueError:
        return False


class AudioTrack:
    """The sound of a video: sample n is heard n / `SAMPLE_RATE` after the first picture appears."""

    def __init__(self, file: av.container.OutputContainer, codec: str, sound: AudioSource) -> None:
        options = _AUDIO_OPTIONS.get(codec, {})
        stream = file.add_stream(codec, rate=SAMPLE_RATE, options=options)
        assert isinstance(stream, av.AudioStream)
        stream.layout = "stereo"
        stream.bit_rate = AUDIO_BIT_RATE
        self._file, self._stream, self._sound = file, stream, sound
        self._count = 0

    def write_until(self, time: float) -> None:
        """Write the samples that are heard before a time of the video [s]."""
        count = round(time * SAMPLE_RATE) - self._count
        if count > 0:
            self._write(self._sound(count))

    def finish(self, time: float) -> None:
        """Write the last samples, up to a time of the video [s]; they fade out."""
        count = max(round(time * SAMPLE_RATE) - self._count, 1)
        self._write(self._sound(count) * np.linspace(1.0, 0.0, count, dtype=np.float32)[:, None])
        self._file.mux(self._stream.encode())

    def _write(self, samples: NDArray[np.float32]) -> None:
        frame = av.AudioFrame.from_ndarray(
            np.ascontiguousarray(samples.T), format="fltp", layout="stereo"
        )
        frame.sample_rate, frame.pts = SAMPLE_RATE, self._count
        frame.time_base = Fraction(1, SAMPLE_RATE)
        self._count += len(samples)
        self._file.mux(self._stream.encode(frame))


def _palette_graph(
    size: tuple[int, int], scaled: tuple[int, int], time_base: Fraction
) -> av.filter.Graph:
    """Return the filters that scale a picture and choose its 256 colours, each for itself."""
    graph = av.filter.Graph()
    source = graph.add_buffer(
        width=size[0], height=size[1], format=av.VideoFormat("bgr24"), time_base=time_base
    )
    scale = graph.add("scale", f"{scaled[0]}:{scaled[1]}:flags=area")
    split = graph.add("split")
    palette = graph.add("palettegen", "stats_mode=single")
    use = graph.add("paletteuse", "new=1:dither=bayer:bayer_scale=4")
    source.link_to(scale)
    scale.link_to(split)
    split.link_to(palette, 0, 0)
    split.link_to(use, 1, 0)
    palette.link_to(use, 0, 1)
    use.link_to(graph.add("buffersink"))
    graph.configure()
    return graph
