"""Films of one drawn person an image, for what learns from films."""

from __future__ import annotations

import numpy as np

from peopleboy.studies.training.detector.world_sequences import ThermalSequence

ROWS, COLUMNS = 120, 160
WIDTH_PER_HEIGHT = 0.3


def drawn_film(seed: int, images: int = 6) -> ThermalSequence:
    """One person an image, upright, of 30 to 60 px; a head, a trunk and two legs that move."""
    rng = np.random.default_rng(seed)
    greys, changes, boxes = [], [], []
    for _ in range(images):
        grey = np.kron(rng.normal(90.0, 12.0, (ROWS // 4, COLUMNS // 4)), np.ones((4, 4)))
        change = np.abs(rng.normal(0.0, 1.0, (ROWS, COLUMNS)))
        tall = float(rng.uniform(30.0, 60.0))
        left, top = float(rng.uniform(20.0, 110.0)), float(rng.uniform(5.0, 55.0))
        wide = WIDTH_PER_HEIGHT * tall
        for shown, begin, end in ((0.5, 0.0, 0.15), (1.0, 0.18, 0.55), (0.35, 0.55, 1.0)):
            middle = left + wide / 2.0
            for side in (-1, 1) if end == 1.0 else (0,):
                a = round(middle + side * 0.3 * wide - shown * wide / 2.0)
                where = np.s_[
                    round(top + begin * tall) : round(top + end * tall), a : a + round(shown * wide)
                ]
                grey[where] = 180.0 + rng.normal(0.0, 4.0)
                change[where] += 30.0 * (end == 1.0)
        greys.append(np.clip(grey + rng.normal(0.0, 1.0, grey.shape), 0.0, 255.0).astype(np.uint8))
        changes.append(np.clip(change, 0.0, 255.0).astype(np.uint8))
        boxes.append((left, top, wide, tall))
    return ThermalSequence(
        grey=np.array(greys),
        change=np.array(changes),
        mount=np.array([59.5, 150.0, 1.2]),
        image=np.arange(images),
        box=np.array(boxes),
        whole=np.array([(x - 0.2 * wide, y, 1.4 * wide, tall) for x, y, wide, tall in boxes]),
        posture=np.zeros(images, np.int64),
        visible=np.ones(images),
        inside=np.ones(images),
        shown_px=np.full(images, 200.0),
        is_upright=np.ones(images, np.bool_),
    )
