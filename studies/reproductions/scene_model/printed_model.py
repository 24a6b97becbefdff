"""The articulated scene model as printed: static background, moving entities, movable objects (SA 3.2)."""

from collections.abc import Sequence

import cv2
import numpy as np
from numba import njit

from peopleboy.studies.reproductions.scene_model.clusters import Cloud, CloudMaker, Clusters, find_clusters
from peopleboy.studies.reproductions.scene_model.ellipses import MovingEllipse, MovingEllipses, inside
from peopleboy.studies.reproductions.scene_model.printed_config import PrintedBackground, PrintedConfig
from peopleboy.tracker.frame import Frame
from peopleboy.tracker.scene_model.connected_pieces import Bools, PixelSpan, pieces_of, pixels_by_label
from peopleboy.tracker.scene_model.geometry import Geometry
from peopleboy.tracker.scene_model.scene import (
    Happening,
    Labels,
    ObjectState,
    SceneObject,
    ScenePerson,
    VistaScene,
)

_FEWEST_POINTS = 3  # of a convex hull


class PrintedSceneModel:
    """Learns a place frame by frame, without the changes of objects.

    Args:
        config: kind of background, and settings.
        rng: draws particles.
    """

    def __init__(self, config: PrintedConfig, rng: np.random.Generator) -> None:
        self._config = config
        self._cloud = CloudMaker(config)
        self._ellipses = MovingEllipses(config, rng)
        self._geometry: Geometry | None = None

    def update(self, frame: Frame, moving: Bools | None = None) -> VistaScene:
        """Process the next frame.

        Args:
            frame: with a depth image.
            moving: (H, W) pixels of moving people, which replace those of tracked ellipses, for ablations.

        Raises:
            BadInput: there is no depth image with colours or amplitude, or no calibration.
        """
        if self._geometry is None:
            self._geometry = Geometry.of(frame)
            self._static = np.zeros(self._geometry.shape, np.float32)
            self._count = np.zeros(self._geometry.shape, np.float32)
            self._since = np.full(self._geometry.shape, np.inf, np.float32)
        config, cloud = self._config, self._cloud(frame, self._geometry)
        people = np.zeros(self._geometry.shape, np.int32)
        persons: tuple[ScenePerson, ...] = ()
        if config.background in (PrintedBackground.TRACK, PrintedBackground.ADAPT):
            clusters = find_clusters(cloud, self._candidates(cloud), config)
            ellipses = self._ellipses.update(clusters)
            people = _hulls(ellipses, clusters, people) if moving is None else moving.astype(np.int32)
            persons = tuple(_person(one) for one in ellipses)
        movable = self._learned(cloud, people > 0)
        things, objects = self._things(movable, cloud, frame.time_s)
        return VistaScene(
            time_s=frame.time_s,
            background_m=self._static.copy(),
            people=people,
            things=things,
            persons=persons,
            objects=objects,
        )

    def finish(self) -> tuple[Happening, ...]:
        """Return no changes: the source only marks movable objects."""
        return ()

    def _candidates(self, cloud: Cloud) -> Bools:
        """Return the foreground (SA eq. 3.3); everything without a background.

        Surfaces behind the background are not objects, but a previously occluded background.
        """
        if self._config.background is not PrintedBackground.ADAPT:
            return np.asarray(cloud.depth_m > 0.0)
        return np.asarray((self._count == 0.0) | (self._static - cloud.depth_m > self._config.same_m))

    def _learned(self, cloud: Cloud, dynamic: Bools) -> Bools:
        """Update the background, and return nearer readings (SA fig. 3.7)."""
        config = self._config
        is_used = cloud.depth_m > 0.0
        if config.background in (PrintedBackground.TRACK, PrintedBackground.ADAPT):
            is_used &= ~dynamic
        if config.background in (PrintedBackground.MPIX, PrintedBackground.ADAPT):
            is_used &= cloud.speed_m < config.moving_m
        limit = config.same_m if config.background is PrintedBackground.ADAPT else np.inf
        movable = np.zeros(is_used.shape, np.bool_)
        _learn(self._static, self._count, cloud.depth_m, is_used, np.float32(limit), movable)
        return movable

    def _things(self, movable: Bools, cloud: Cloud, time_s: float) -> tuple[Labels, tuple[SceneObject, ...]]:
        """Segment movable objects in space and time (SA 3.6)."""
        config, geometry = self._config, self._geometry
        assert geometry is not None  # there was a frame
        self._since = np.where(movable, np.minimum(self._since, np.float32(time_s)), self._since)
        self._since[
            (self._count > 0.0) & ~movable & (np.abs(cloud.depth_m - self._static) < config.same_m)
        ] = np.inf
        things = np.zeros(movable.shape, np.int32)
        objects: list[SceneObject] = []
        labels, count = pieces_of(
            movable,
            cloud.depth_m,
            config.thing_m,
            PixelSpan(self._since, self._since, self._since, config.thing_s),
        )
        for _, pixels in pixels_by_label(labels, count):
            if len(pixels) < config.thing_px:
                continue
            things.flat[pixels] = number = len(objects) + 1
            rows, columns = np.divmod(pixels, movable.shape[1])
            left, top = int(columns.min()), int(rows.min())
            x, y, z = np.median(geometry.points(pixels, cloud.depth_m), axis=0).tolist()
            objects.append(
                SceneObject(
                    id=number,
                    box=(
                        float(left),
                        float(top),
                        float(columns.max() - left + 1),
                        float(rows.max() - top + 1),
                    ),
                    place_m=(x, y, z),
                    size_m2=float((cloud.depth_m.ravel()[pixels] ** 2).sum()) / geometry.focal_px**2,
                    first_seen_s=float(np.median(self._since.ravel()[pixels])),
                    state=ObjectState.STANDS,
                )
            )
        return things, tuple(objects)


@njit(cache=True, nogil=True)
def _learn(static, count, depth, used, limit, movable):  # type: ignore[no-untyped-def]
    """Follow fig. 3.7; without a limit all readings are averaged.

    Corrected: a farther reading is a new start, so that the number of accumulated values is reset, too.
    """
    height, width = depth.shape
    for v in range(height):
        for u in range(width):
            if not used[v, u]:
                continue
            z = depth[v, u]
            if count[v, u] == 0.0 or abs(static[v, u] - z) < limit:
                count[v, u] += 1.0
                static[v, u] += (z - static[v, u]) / count[v, u]
            elif z > static[v, u]:
                static[v, u], count[v, u] = z, 1.0
            else:
                movable[v, u] = True


def _hulls(ellipses: Sequence[MovingEllipse], clusters: Clusters, labels: Labels) -> Labels:
    """Mark all pixels within the convex hull of each object's points in the image."""
    for one in ellipses:
        own = clusters.pixels[inside(one.state, clusters.points_m, 1.0)]
        if len(own) >= _FEWEST_POINTS:
            rows, columns = np.divmod(own, labels.shape[1])
            hull = cv2.convexHull(np.stack([columns, rows], axis=1).astype(np.int32))
            cv2.fillConvexPoly(labels, hull, one.id)
    return labels


def _person(one: MovingEllipse) -> ScenePerson:
    x, y = one.state[:2].tolist()
    return ScenePerson(id=one.id, place_m=(x, y))
