"""Augmentation of thermal images: mirroring, crops, other cameras, and other temperature spans."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Final, NamedTuple

import cv2
import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.cameras.imaging.electronics import compress
from peopleboy.studies.training.detector.world_sequences import HIGHEST, ThermalImage
from peopleboy.tracker.camera_mount import Mount
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
_FENCED: Final = 0.12  # shares of images with fences, ...
_TWIGGY: Final = 0.1  # ... twigs, ...
_COVERED: Final = 0.1  # ... and things in front of people
_LIT: Final = 0.2
_MOST_LIGHT: Final = 60.0  # [grey]
_BLACKED: Final = 0.08  # share of images with black borders ...
_INSCRIBED: Final = 0.1  # ... and with burnt-in figures


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
        rows, columns = slice(*_span(top, height, len(grey))), slice(*_span(left, width, grey.shape[1]))
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
    return replace(image, grey=_to_grey(grey), change=_to_grey(change))


def _span(begin: float, length: float, most: int, ring: float = _RING) -> tuple[int, int]:
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
    return replace(image, grey=_to_grey(image.grey + level * patchy * texture))


def clutter(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Add sun and shade, fences, twigs and things in front of people, each with some probability."""
    if rng.random() < _LIT:
        image = add_light(image, rng)
    for share, hide in ((_FENCED, _fence), (_TWIGGY, _twigs), (_COVERED, _things)):
        if rng.random() < share:
            image = put_in_front(image, hide(image.grey.shape, rng), rng)
    return image


def overlay(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Add figures and black borders, each with some probability."""
    if rng.random() < _INSCRIBED:
        image = inscribe(image, rng)
    if rng.random() < _BLACKED:
        image = blacken_borders(image, rng)
    return image


def add_light(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Add patches of sun and shade with edges, as on sunlit ground and facades."""
    rows, columns = image.grey.shape
    lit = np.zeros((rows, columns), np.float32)
    for _ in range(int(rng.integers(1, 5))):
        corners = rng.uniform(-0.3, 1.3, (int(rng.integers(3, 6)), 2)) * (columns, rows)
        patch = np.zeros_like(lit)
        cv2.fillConvexPoly(patch, cv2.convexHull(corners.astype(np.int32)), 1.0)
        lit += rng.uniform(-_MOST_LIGHT, _MOST_LIGHT) * patch
    return replace(image, grey=_to_grey(image.grey + cv2.GaussianBlur(lit, (0, 0), rng.uniform(0.7, 6.0))))


def put_in_front(image: ThermalImage, mask: Floats, rng: Draw) -> ThermalImage:
    """Put something of one temperature in front of an image, where a mask (H, W) in 0..1 is not 0."""
    level = np.quantile(image.grey[::4, ::4], rng.uniform()) + rng.normal(0.0, 20.0)
    shown = 1.0 - cv2.GaussianBlur(mask, (0, 0), rng.uniform(0.4, 1.0))
    grey = level + shown * (image.grey - level) + rng.normal(0.0, 1.5, mask.shape) * mask
    visible = image.visible.copy()
    for one, (left, top, width, height) in enumerate(image.whole.tolist()):
        rows, columns = (
            slice(*_span(top, height, len(mask), 0.0)),
            slice(*_span(left, width, mask.shape[1], 0.0)),
        )
        visible[one] *= float(shown[rows, columns].mean()) if shown[rows, columns].size else 1.0
    return replace(image, grey=_to_grey(grey), change=_to_grey(shown * image.change), visible=visible)


def _fence(shape: tuple[int, ...], rng: Draw) -> Floats:
    """Draw bars side by side, with rails."""
    mask = np.zeros(shape, np.float32)
    apart, top = rng.uniform(5.0, 24.0), int(rng.uniform(0.1, 0.8) * shape[0])
    bottom, slope = top + int(rng.uniform(0.2, 0.6) * shape[0]), rng.normal(0.0, 0.15) * (rng.random() < 0.3)
    thick = max(round(rng.uniform(0.08, 0.3) * apart), 1)
    for u in np.arange(rng.uniform(0.0, apart), shape[1], apart).tolist():
        cv2.line(mask, (int(u), top), (int(u + slope * (bottom - top)), bottom), 1.0, thick)
    for v in rng.integers(top, bottom, int(rng.integers(0, 3))).tolist():
        cv2.line(mask, (0, v), (shape[1], v), 1.0, thick)
    return mask


def _twigs(shape: tuple[int, ...], rng: Draw) -> Floats:
    """Draw crooked lines in a part of the image."""
    mask = np.zeros(shape, np.float32)
    middle, reach = rng.uniform(0.0, 1.0, 2) * shape[::-1], rng.uniform(0.1, 0.5) * shape[1]
    for _ in range(int(rng.integers(5, 50))):
        steps = rng.normal(0.0, 0.12 * reach, (6, 2)) + rng.normal(0.0, 0.1 * reach, 2)
        points = middle + rng.normal(0.0, reach / 2.0, 2) + np.cumsum(steps, axis=0)
        cv2.polylines(
            mask, [points.astype(np.int32)], isClosed=False, color=1.0, thickness=int(rng.integers(1, 3))
        )
    return mask


def _things(shape: tuple[int, ...], rng: Draw) -> Floats:
    """Draw poles, bushes and boxes."""
    mask = np.zeros(shape, np.float32)
    for _ in range(int(rng.integers(1, 5))):
        u, v = (int(rng.integers(0, side)) for side in shape[::-1])
        if rng.random() < 0.5:
            width, height = int(rng.uniform(2.0, 30.0)), int(rng.uniform(10.0, shape[0]))
            cv2.rectangle(mask, (u, v), (u + width, v + height), 1.0, -1)
        else:
            axes = int(rng.uniform(5.0, 40.0)), int(rng.uniform(5.0, 40.0))
            cv2.ellipse(mask, (u, v), axes, rng.uniform(0.0, 180.0), 0.0, 360.0, 1.0, -1)
    return mask


def soften(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Simulate a camera with poorer optics, more noise, and another grey curve."""
    blur, noise = rng.uniform(*_BLURS_PX), rng.uniform(0.0, _MOST_NOISE)
    curve = 255.0 * (np.arange(256.0) / 255.0) ** math.exp(rng.uniform(*_CURVES))
    soft = cv2.GaussianBlur(curve[image.grey], (0, 0), blur) + rng.normal(0.0, noise, image.grey.shape)
    change = cv2.GaussianBlur(image.change.astype(np.float64), (0, 0), blur)
    return replace(image, grey=_to_grey(soft), change=np.rint(change).astype(np.uint8))


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
    return replace(image, grey=_to_grey(grey), change=np.rint(gain * image.change).astype(np.uint8))


def _to_grey(values: NDArray[np.floating]) -> Grey:
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


# Effects of a camera's electronics and file format: gain control, edge sharpening, compression.

_EQUALISED: Final = 0.25
_MOST_EQUALISED: Final = 0.8  # share of full histogram equalisation
_SHARPENED: Final = 0.3
_RADII_PX: Final = (0.8, 3.0)
_MOST_SHARPENED: Final = 1.5
_COMPRESSED: Final = 0.4
_QUALITIES: Final = (25, 92)


def simulate_electronics(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Simulate, with some probability, a camera that processes its images for display."""
    if rng.random() < _EQUALISED:
        image = equalise(image, rng.uniform(0.0, _MOST_EQUALISED))
    if rng.random() < _SHARPENED:
        radius_px, gain = rng.uniform(*_RADII_PX), rng.uniform(0.0, _MOST_SHARPENED)
        image = replace(image, grey=sharpen(image.grey, radius_px, gain))
    if rng.random() < _COMPRESSED:
        image = replace(image, grey=compress(image.grey, int(rng.integers(*_QUALITIES))))
    return image


def inscribe(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Burn figures and a cross into the image."""
    grey, (rows, columns) = image.grey.copy(), image.grey.shape
    level = int(rng.choice((0, 255)))
    for _ in range(int(rng.integers(1, 5))):
        figures = "".join(rng.choice(list("0123456789:.-C"), int(rng.integers(2, 12))))
        corner = (
            int(rng.integers(0, columns)),
            int(rng.choice((rng.uniform(0.03, 0.15), rng.uniform(0.9, 1.0))) * rows),
        )
        cv2.putText(grey, figures, corner, int(rng.integers(0, 4)), rng.uniform(0.25, 0.8), level, 1)
    if rng.random() < 0.3:
        u, v, arm = columns // 2, rows // 2, int(rng.integers(4, 16))
        cv2.line(grey, (u - arm, v), (u + arm, v), level, 1)
        cv2.line(grey, (u, v - arm), (u, v + arm), level, 1)
    return replace(image, grey=grey)


def blacken_borders(image: ThermalImage, rng: Draw) -> ThermalImage:
    """Blacken opposite borders, as of a picture that was fitted into another format."""
    grey, change = image.grey.copy(), image.change.copy()
    for axis in (0, 1):
        if rng.random() < 0.6:
            width = int(rng.uniform(0.02, 0.15) * grey.shape[axis])
            for one in (np.moveaxis(grey, axis, 0), np.moveaxis(change, axis, 0)):
                one[:width] = one[len(one) - width :] = 0
    return replace(image, grey=grey, change=change)


def equalise(image: ThermalImage, share: float) -> ThermalImage:
    """Equalise the histogram partly, like an automatic gain control with plateau equalisation.

    The image of changes is multiplied by the slope of the grey curve.
    """
    counts = np.bincount(image.grey.ravel(), minlength=256)
    rank = 255.0 * np.cumsum(counts) / counts.sum()
    curve = (1.0 - share) * np.arange(256.0) + share * rank
    slope = cv2.GaussianBlur(np.gradient(curve)[None], (0, 0), 4.0)[0]
    change = np.clip(image.change * slope[image.grey], 0.0, 255.0)
    return replace(
        image, grey=np.rint(curve).astype(np.uint8)[image.grey], change=np.rint(change).astype(np.uint8)
    )


def sharpen(grey: Grey, radius_px: float, gain: float) -> Grey:
    """Sharpen details finer than a radius, which leaves rims around warm objects.

    The simulated camera sharpens in kelvin, before greys are encoded; here only the greys are available.
    """
    values = grey.astype(np.float32)
    finer = values - cv2.GaussianBlur(values, (0, 0), radius_px)
    return np.asarray(np.rint(np.clip(values + gain * finer, 0.0, 255.0)), np.uint8)


_AS_RENDERED: Final = 0.25
_CUT: Final = 0.25
_MOUNT_KNOWN: Final = 0.6


class Version(NamedTuple):
    """An image to take crops of.

    Attributes:
        image: the image.
        mount: mount of the camera, if known.
        rng: random generator for further draws.
    """

    image: ThermalImage
    mount: Mount | None
    rng: Draw


def versions(images: Sequence[ThermalImage], rng: Draw, count: int) -> Iterator[Version]:
    """Yield `count` augmented versions of each image; for 0, the unchanged image with its mount."""
    for image in images:
        if count == 0:
            yield Version(image, image.mount, rng)
        for _ in range(count):
            own = np.random.default_rng(rng.integers(2**63))
            varied = image if own.random() < _AS_RENDERED else simulate_electronics(augment(image, own), own)
            shown = cut_off(varied, own) if own.random() < _CUT else varied
            yield Version(shown, shown.mount if own.random() < _MOUNT_KNOWN else None, own)
