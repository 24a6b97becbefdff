"""Augmentation of thermal images: mirroring, crops, other cameras, and other temperature spans."""

import math
from dataclasses import replace
from typing import Final

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.studies.training.detector.world_sequences import HIGHEST, ThermalImage
from peopleboy.tracker.sensors.thermal.detector.window import WindowKind

Grey = NDArray[np.uint8]
Floats = NDArray[np.float32]
Draw = np.random.Generator

# Shares of the images, unless noted otherwise.
_SPANNED: Final = 0.5
_NEGATED: Final = 0.15  # a camera that shows hot objects dark, or people colder than the background
_FAINT: Final = 0.15  # hotter and colder objects take up most of the grey range
_SOFT: Final = 0.5
_TEXTURED: Final = 0.35
_DIMMED: Final = 0.3
_CROPPED: Final = 0.3
_CROPPED_AT_THE_FEET: Final = 0.7  # of the cropped images; the others are cropped at the head
_MOST_CROPPED: Final = 0.4  # of the height
_FEWEST_ROWS: Final = 60
_TALL_PX: Final = 36.0  # least height of a person at whose head or feet an image is cropped
_MOST_BLACK: Final = 0.97
_LEAST_SPAN: Final = 60.0  # [grey]
_GAINS: Final = (0.6, 1.6)
_BLURS_PX: Final = (0.4, 2.2)
_MOST_NOISE: Final = 4.0  # [grey]
_CURVES: Final = (-0.6, 0.6)  # logarithm of the power
_FAINT_GAINS: Final = (0.15, 0.6)
_MOST_TEXTURE: Final = 18.0  # [grey]
_OCTAVES_PX: Final = (3, 7, 16, 40)
_DIM_GAINS: Final = (0.2, 1.0)
_DARK: Final = 0.25  # share of the dimmed people who become darker than their surroundings
_RING: Final = 0.15  # width of the surroundings, in heights


def augment(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Mirror, crop and recolour an image, each with some probability."""
    image = mirror(image) if rng.random() < 0.5 else image
    if rng.random() < _CROPPED:
        image = crop(image, rng)
    return recolour(image, rng)


def mirror(image: ThermalImage) -> ThermalImage:
    """Swap left and right."""
    box, whole = image.box.copy(), image.whole.copy()
    for one in (box, whole):
        one[:, 0] = image.grey.shape[1] - 1.0 - (one[:, 0] + one[:, 2])
    grey, change = (np.ascontiguousarray(one[:, ::-1]) for one in (image.grey, image.change))
    return replace(image, grey=grey, change=change, box=box, whole=whole)


def recolour(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Change greys, each with some probability: dim people, add texture, negate, soften, change the span."""
    if rng.random() < _DIMMED:
        image = dim_people(image, rng)
    if rng.random() < _TEXTURED:
        image = add_texture(image, rng)
    if rng.random() < _NEGATED:
        image = replace(image, grey=255 - image.grey)
    if rng.random() < _SOFT:
        image = soften(image, rng)
    if rng.random() < _SPANNED:
        return change_span(image, rng)
    return _fade(image, rng) if rng.random() < _FAINT else image


def dim_people(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Reduce the contrast of each person with the surroundings, as with thick clothes or in the sun."""
    grey, change = image.grey.astype(np.float64), image.change.astype(np.float64)
    for left, top, width, height in image.whole.tolist():
        gain = rng.uniform(*_DIM_GAINS)
        sign = -1.0 if rng.random() < _DARK else 1.0
        rows, columns = slice(*span(top, height, len(grey))), slice(*span(left, width, grey.shape[1]))
        here, changed = grey[rows, columns], change[rows, columns]
        if not here.size:
            continue
        edge = np.concatenate([here[:, 0], here[:, -1], here[0]])
        v = (np.arange(rows.start, rows.stop) - top - height / 2.0) / (height / 2.0)
        u = (np.arange(columns.start, columns.stop) - left - width / 2.0) / (width / 2.0)
        inside = _fall(v)[:, None] * _fall(u)[None]
        factor = 1.0 + inside * (sign * gain - 1.0)
        surroundings = float(np.median(edge))
        here[:] = surroundings + factor * (here - surroundings)
        changed *= np.abs(factor)
    return replace(image, grey=to_grey(grey), change=to_grey(change))


def span(begin: float, length: float, most: int, ring: float = _RING) -> tuple[int, int]:
    """Return the first pixel of an interval with its surroundings, and the one after the last, of `most`."""
    margin = ring * length
    low, high = (int(np.clip(edge, 0, most)) for edge in (begin - margin, begin + length + margin + 1.0))
    return low, high


def _fall(off: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return weights that fall from 1 inside to 0 at the margin's end, for offsets in half lengths."""
    return np.asarray(np.clip((1.0 + 2.0 * _RING - np.abs(off)) / (2.0 * _RING), 0.0, 1.0))


def add_texture(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Add random texture of several scales, as of foliage, gravel and facades."""
    rows, columns = image.grey.shape
    texture = np.zeros((rows, columns))
    for length in _OCTAVES_PX:
        coarse = rng.normal(0.0, rng.uniform(0.0, 1.0), (rows // length + 2, columns // length + 2))
        texture += cv2.resize(coarse, (columns, rows), interpolation=cv2.INTER_CUBIC)
    level = rng.uniform(0.0, _MOST_TEXTURE) / max(float(texture.std()), 1e-6)
    patchy = cv2.resize(rng.uniform(0.0, 1.0, (3, 4)), (columns, rows))
    return replace(image, grey=to_grey(image.grey + level * patchy * texture))


def soften(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Simulate a camera with poorer optics, more noise, and another grey curve."""
    blur, noise = rng.uniform(*_BLURS_PX), rng.uniform(0.0, _MOST_NOISE)
    curve = 255.0 * (np.arange(256.0) / 255.0) ** math.exp(rng.uniform(*_CURVES))
    soft = cv2.GaussianBlur(curve[image.grey], (0, 0), blur) + rng.normal(0.0, noise, image.grey.shape)
    change = cv2.GaussianBlur(image.change.astype(np.float64), (0, 0), blur)
    return replace(image, grey=to_grey(soft), change=np.rint(change).astype(np.uint8))


def change_span(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Simulate a camera with another temperature span: colder is black, hotter is white."""
    coldest = np.quantile(image.grey[::4, ::4], rng.uniform(0.0, _MOST_BLACK))
    gain = rng.uniform(*_GAINS) * 255.0 / max(255.0 - coldest, _LEAST_SPAN)
    grey = np.clip((image.grey - coldest) * gain, 0.0, 255.0)
    # Pixels that were black before count as unchanged; elsewhere, a change outside the span is lost.
    was_black = image.grey.astype(np.float64) + image.change <= coldest
    change = np.where(was_black, 0.0, np.clip(image.change * gain, 0.0, 255.0))
    return replace(image, grey=grey.astype(np.uint8), change=change.astype(np.uint8))


def _fade(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Reduce contrast, as when one object is much hotter or colder than the rest of the image."""
    gain = rng.uniform(*_FAINT_GAINS)
    grey = 255.0 * rng.uniform(0.0, 1.0 - gain) + gain * image.grey
    return replace(image, grey=to_grey(grey), change=np.rint(gain * image.change).astype(np.uint8))


def to_grey(values: NDArray[np.floating]) -> Grey:
    """Round and clip values to greys."""
    return np.asarray(np.rint(np.clip(values, 0.0, 255.0)), np.uint8)


def crop(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Crop an image at a person's feet or head, so that a part of the person is outside."""
    top, bottom = image.box[:, 1], image.box[:, 1] + image.box[:, 3]
    tall = np.flatnonzero(image.is_good & (image.box[:, 3] > _TALL_PX))
    if not len(tall):
        return image
    one = int(rng.choice(tall))
    if rng.random() < _CROPPED_AT_THE_FEET:
        end = bottom[one] - rng.uniform(0.0, _MOST_CROPPED) * image.box[one, 3]
        return take_rows(image, 0, end, _FEWEST_ROWS)
    first = top[one] + rng.uniform(0.0, HIGHEST) * image.box[one, 3]
    return take_rows(image, first, len(image.grey), _FEWEST_ROWS)


def take_rows(image: ThermalImage, first: float, end: float, fewest: int) -> ThermalImage:
    """Return a range of rows of an image; the whole image if the range is too small."""
    begin, stop = max(round(first), 0), min(round(end), len(image.grey))
    if stop - begin < fewest:
        return image
    top, bottom = image.box[:, 1], image.box[:, 1] + image.box[:, 3]
    shown = np.minimum(bottom, stop) - np.maximum(top, begin)
    is_left = shown > 0.0
    is_good = (
        image.is_good
        & (shown >= (1.0 - _MOST_CROPPED) * image.box[:, 3])
        & (begin - top <= HIGHEST * image.box[:, 3])
    )
    return ThermalImage(
        grey=image.grey[begin:stop],
        change=image.change[begin:stop],
        mount=replace(image.mount, horizon_px=image.mount.horizon_px - begin),
        box=(image.box - np.array([0.0, begin, 0.0, 0.0]))[is_left],
        is_good=is_good[is_left],
        is_clear=image.is_clear[is_left],
        whole=(image.whole - np.array([0.0, begin, 0.0, 0.0]))[is_left],
        posture=image.posture[is_left],
        visible=image.visible[is_left],
    )


# Images that truncate people: near people of whom a camera shows only legs, or face and shoulders.

_UNCUT: Final = 0.2
_CUT_AT_THE_FEET: Final = 0.4  # of the others; the same share at the head, and the rest at both
_CUT_AT_THE_HEAD: Final = 0.4
_CUT_TALL_PX: Final = 60.0  # least height of a person that is truncated
_CUT_FEWEST_ROWS: Final = 40
_ABOVE: Final = (0.15, 0.65)  # shares of the height
_BELOW: Final = (0.3, 0.65)
_BOTH: Final = (0.2, 0.4)
_LEAST_ABOVE: Final = 0.2  # least share of a person above the image ...
_LEAST_BELOW: Final = 0.35  # ... or below it, for windows of truncated people
_MOST_BEYOND: Final = 0.66
_MOST_ASIDE: Final = 0.5  # of the width


def augment_for(image: ThermalImage, rng: Draw, kind: WindowKind) -> ThermalImage:
    """Augment an image for windows of a kind; the good people in it are positives of that kind."""
    if kind is WindowKind.WHOLE:
        return augment(image, rng)
    side = mirror(image) if rng.random() < 0.5 else image
    if rng.random() >= _UNCUT:
        side = cut_off(side, rng)
    return recolour(replace(side, is_good=is_cut_off(side)), rng)


def calibration_pair(image: ThermalImage, rng: Draw, kind: WindowKind) -> tuple[ThermalImage, ThermalImage]:
    """Return two versions of an image, for calibrating the scores of windows of a kind."""
    if kind is WindowKind.WHOLE:
        return image, change_span(image, rng)
    return augment_for(image, rng, kind), augment_for(image, rng, kind)


def has_people(image: ThermalImage, kind: WindowKind) -> bool:
    """Return whether an image has people to train windows of a kind on."""
    return bool((image.is_good if kind is WindowKind.WHOLE else _is_tall(image)).any())


def is_cut_off(image: ThermalImage) -> NDArray[np.bool_]:
    """Return which of the clear people (P,) are truncated at head or feet, but not almost entirely."""
    rows, columns = image.grey.shape
    left, top, width, height = image.box.T
    above = np.maximum(-top, 0.0) / height
    below = np.maximum(top + height - rows, 0.0) / height
    aside = (np.maximum(-left, 0.0) + np.maximum(left + width - columns, 0.0)) / width
    is_cut = (above > _LEAST_ABOVE) | (below > _LEAST_BELOW)
    is_enough = (above + below <= _MOST_BEYOND) & (aside <= _MOST_ASIDE)
    return np.asarray(image.is_clear & is_cut & is_enough, np.bool_)


def _is_tall(image: ThermalImage) -> NDArray[np.bool_]:
    return np.asarray(image.is_clear & (image.box[:, 3] > _CUT_TALL_PX), np.bool_)


def cut_off(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Crop an image in the middle of a person."""
    tall = np.flatnonzero(_is_tall(image))
    if not len(tall):
        return image
    _, top, _, height = image.box[int(rng.choice(tall))].tolist()
    where = rng.random()
    if where < _CUT_AT_THE_FEET:
        end = top + (1.0 - rng.uniform(*_BELOW)) * height
        return take_rows(image, 0, end, _CUT_FEWEST_ROWS)
    if where < _CUT_AT_THE_FEET + _CUT_AT_THE_HEAD:
        first = top + rng.uniform(*_ABOVE) * height
        return take_rows(image, first, len(image.grey), _CUT_FEWEST_ROWS)
    upper, lower = (rng.uniform(*_BOTH) for _ in range(2))
    return take_rows(image, top + upper * height, top + (1.0 - lower) * height, _CUT_FEWEST_ROWS)
