"""Images in glTF files: measured before they are decoded, and written back as PNG."""

import io
import warnings
from typing import Literal

import numpy as np
import PIL.Image
from numpy.typing import NDArray
from PIL import UnidentifiedImageError

from characters.formats.gltf.document import DamagedFileError, label
from characters.formats.gltf.file import GltfFile

Image = NDArray[np.uint8]
"""(height, width, 3 or 4), RGB or RGBA."""

MAX_SIDE_PX = 8192  # graphics cards guarantee hardly more


class ImageDecoder:
    """Decodes each requested image of a file once."""

    def __init__(self, file: GltfFile) -> None:
        self._file = file
        self._decoded: dict[tuple[int, str], Image] = {}

    def texture(self, index: int, mode: Literal["RGB", "RGBA"]) -> Image | None:
        """Return the image of a texture, or None if it has none."""
        source = self._file.document["textures"][index].get("source")
        if source is None:
            return None
        if (source, mode) not in self._decoded:
            image = self._file.document["images"][source]
            name = label("image", source, image)
            if "uri" in image:
                data: bytes | memoryview = self._file.resource(image["uri"])
            elif "bufferView" in image:
                data = self._file.view(image["bufferView"])
            else:
                raise DamagedFileError(f"{name} has no data")
            self._decoded[source, mode] = self._decode(data, name, mode)
        return self._decoded[source, mode]

    def _decode(self, data: bytes | memoryview, name: str, mode: Literal["RGB", "RGBA"]) -> Image:
        try:
            # Warnings of the library, for example about palettes, need no action.
            with warnings.catch_warnings():
                warnings.simplefilter("ignore")
                with PIL.Image.open(io.BytesIO(data), formats=("PNG", "JPEG")) as opened:
                    self._check_size(opened.size, name)
                    if opened.mode.startswith("I;16") or opened.mode == "I":
                        grey = (np.asarray(opened).astype(np.uint32) >> 8).astype(np.uint8)
                        return np.asarray(PIL.Image.fromarray(grey).convert(mode))
                    return np.asarray(opened.convert(mode))
        except UnidentifiedImageError:
            raise DamagedFileError(f"{name} is neither PNG nor JPEG") from None
        except PIL.Image.DecompressionBombError:
            raise DamagedFileError(f"{name} is larger than {MAX_SIDE_PX} pixels per side") from None
        # PIL raises any of these for a truncated or invalid file.
        except (OSError, SyntaxError, EOFError, IndexError, OverflowError, TypeError) as error:
            raise DamagedFileError(f"{name} is damaged ({error})") from None

    def _check_size(self, size: tuple[int, int], name: str) -> None:
        """Refuse an image by its header, before it is decoded."""
        width, height = size
        if not (0 < width <= MAX_SIDE_PX and 0 < height <= MAX_SIDE_PX):
            raise DamagedFileError(
                f"{name} has {width} × {height} pixels; scale it to {MAX_SIDE_PX} at most"
            )
        self._file.budget.spend_pixels(width * height, name)


def png(image: Image) -> bytes:
    """Return an image as a PNG file."""
    data = io.BytesIO()
    PIL.Image.fromarray(image).save(data, "PNG")
    return data.getvalue()
