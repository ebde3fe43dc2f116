"""What can be read of a session without its index: its metadata, and whether it is whole."""

import os
import struct
from typing import BinaryIO

from mcap.exceptions import McapError
from mcap.records import DataEnd, Metadata
from mcap.stream_reader import StreamReader
from zstandard import ZstdError

from cubeling.app.session.file_start import MCAP_MAGIC

READ_ERRORS = (
    *(McapError, EOFError, ValueError, struct.error, LookupError, OSError, ZstdError),
    *(OverflowError, RuntimeError),
)
"""What the MCAP reader raises for a damaged file: one that ends early, an index that points to no
channel (KeyError) or before the file (OSError), a chunk that cannot be decompressed."""


def metadata_of(file: BinaryIO, size: int) -> dict[str, dict[str, str]]:
    """Return the metadata of a session without its index: all records are read, no messages."""
    metadata: dict[str, dict[str, str]] = {}
    file.seek(0)
    try:
        for record in StreamReader(file, emit_chunks=True, record_size_limit=size).records:
            if isinstance(record, Metadata):
                metadata[record.name] = record.metadata
            elif isinstance(record, DataEnd):
                break
    except READ_ERRORS:
        pass  # what is whole of it
    return metadata


def is_whole(file: BinaryIO) -> bool:
    """Whether a file that begins with `MCAP_MAGIC` was written to its end."""
    size = file.seek(0, os.SEEK_END)
    file.seek(-min(size, len(MCAP_MAGIC)), os.SEEK_END)
    return file.read() == MCAP_MAGIC and size > len(MCAP_MAGIC)
