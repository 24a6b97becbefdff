"""Pictures of images by camera, for notebooks, which ask an object for `_repr_png_`."""

import io
from collections.abc import Iterable, Mapping
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

HEIGHT_PX: Final = 240


def png_of(images: Mapping[str, NDArray[Any]]) -> bytes | None:
    """Draw 8-bit and 16-bit images side by side, all of one height; None if there is none."""
    from PIL import Image  # here, as only notebooks need it

    pictures = [Image.fromarray(picture) for picture in _pictures(images)]
    if not pictures:
        return None
    sized = [each.resize((max(1, each.width * HEIGHT_PX // each.height), HEIGHT_PX)) for each in pictures]
    sheet = Image.new("RGB", (sum(each.width for each in sized), HEIGHT_PX))
    left = 0
    for each in sized:
        sheet.paste(each, (left, 0))
        left += each.width
    buffer = io.BytesIO()
    sheet.save(buffer, "PNG")
    return buffer.getvalue()


def _pictures(images: Mapping[str, NDArray[Any]]) -> Iterable[NDArray[np.uint8]]:
    for name in images:
        image = images[name]
        if image.dtype == np.uint16:  # depth [mm]: near is dark
            yield (255.0 * image / max(1, int(image.max()))).astype(np.uint8)
        elif image.dtype == np.uint8:
            yield image


def names_of(names: Iterable[str]) -> str:
    """List names in a short repr."""
    return ", ".join(names) or "none"
