"""PyBullet's own rays, as the second way to find what rays meet."""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from peopleboy.sim.physics.bullet import Bullet


class PyBulletRays:
    """Casts a world's rays by PyBullet alone, as `Physics.cast_rays` would."""

    def __init__(self, bullet: Bullet) -> None:
        self._bullet = bullet

    def cast_rays(
        self, from_m: ArrayLike, to_m: ArrayLike, ignore: str | None = None
    ) -> tuple[NDArray[np.float64], NDArray[np.int64]]:
        bullet = self._bullet
        mask = -1 if ignore is None else ~bullet._group_of(bullet._bodies[ignore])
        starts, ends = np.asarray(from_m).tolist(), np.asarray(to_m).tolist()
        hits = bullet._client.rayTestBatch(starts, ends, collisionFilterMask=mask)
        parts = [bullet._bodies.part_of(number, link) for number, link, *_ in hits]
        return np.array([hit[2] for hit in hits]), np.array(parts)
