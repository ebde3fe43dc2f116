"""Pictures in glTF files: measured before they are decoded, and written back as PNG."""

import io
import warnings
from typing import Literal

import cv2
import numpy as np
from numpy.typing import NDArray
from PIL import Image, UnidentifiedImageError

from characters.formats.gltf.document import DamagedFileError, called
from characters.formats.gltf.file import GltfFile

Picture = NDArray[np.uint8]

_LARGEST = 8192
"""Width and height [px]; graphics cards promise hardly more."""


class Images:
    """Decodes each picture of a file once, and only those that are asked for."""

    def __init__(self, file: GltfFile) -> None:
        self._file = file
        self._decoded: dict[tuple[int, str], Picture] = {}

    def texture(self, index: int, mode: Literal["RGB", "RGBA"]) -> Picture | None:
        """Return the picture of a texture, (height, width, 3 or 4), or None if it has none.

        Raises
        ------
        DamagedFileError
            If it is no PNG or JPEG, truncated, or larger than pictures on a character are.
        """
        source = self._file.document["textures"][index].get("source")
        if source is None:
            return None
        if (source, mode) not in self._decoded:
            image = self._file.document["images"][source]
            if "uri" in image:
                data: bytes | memoryview = self._file.resource(image["uri"])
            elif "bufferView" in image:
                data = self._file.view(image["bufferView"])
            else:
                raise DamagedFileError(f"{called('image', source, image)} has no data")
            name = called("image", source, image)
            self._decoded[source, mode] = self._decode(data, name, mode)
        return self._decoded[source, mode]

    def _decode(self, data: bytes | memoryview, name: str, mode: Literal["RGB", "RGBA"]) -> Picture:
        try:
            # What the library has to say, of odd palettes for one, is nothing to act on.
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                with Image.open(io.BytesIO(data), formats=("PNG", "JPEG")) as picture:
                    self._measure(picture.size, name)
                    if picture.mode.startswith("I;16") or picture.mode == "I":
                        grey = (np.asarray(picture).astype(np.uint32) >> 8).astype(np.uint8)
                        return np.asarray(Image.fromarray(grey).convert(mode))
                    return np.asarray(picture.convert(mode))
        except UnidentifiedImageError:
            raise DamagedFileError(f"{name} is neither PNG nor JPEG") from None
        except Image.DecompressionBombError:
            raise DamagedFileError(f"{name} is larger than {_LARGEST} pixels") from None
        # PIL reports a file that is cut or contradicts itself by any of these.
        except (OSError, SyntaxError, EOFError, IndexError, OverflowError, TypeError) as error:
            raise DamagedFileError(f"{name} is damaged ({error})") from None

    def _measure(self, size: tuple[int, int], name: str) -> None:
        """Refuse a picture by what its header says, before it is unpacked."""
        width, height = size
        if not (0 < width <= _LARGEST and 0 < height <= _LARGEST):
            raise DamagedFileError(
                f"{name} has {width} × {height} pixels; scale it to {_LARGEST} at most"
            )
        self._file.budget.spend_pixels(width * height, name)


def png(picture: Picture) -> bytes:
    """Return a picture, RGB or RGBA, as a PNG file."""
    swap = cv2.COLOR_RGBA2BGRA if picture.shape[2] == 4 else cv2.COLOR_RGB2BGR
    _, data = cv2.imencode(".png", cv2.cvtColor(picture, swap))
    return data.tobytes()
