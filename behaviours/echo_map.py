"""Map of obstacles from sonar echoes, in the frame of odometry, and the cheapest route on it."""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import distance_transform_edt
from scipy.sparse import csr_array
from scipy.sparse.csgraph import dijkstra

from peopleboy.behaviours.percept import Percept, Points
from peopleboy.behaviours.sonar_echoes import BESIDE_RAD, echoes
from peopleboy.geometry.pose2 import Pose2

Cells = NDArray[np.float64]  # (H, W) one value for each cell of the floor
_NEVER: float = -math.inf
_STEPS = ((0, 1), (1, 0), (1, 1), (1, -1))  # to half of a cell's neighbours: the others lead back


@dataclass(frozen=True, slots=True, kw_only=True)
class EchoMapConfig:
    """Size of the map, memory of obstacles, and clearance from them.

    Attributes:
        cell_m: [m] side of a cell.
        around_m: [m] floor in the map around the start and the goal.
        trusted_m: [m] farther echoes are not used, since a cone is too wide there.
        behind_m: [m] floor before an echo that is not counted as free.
        keep_s: [s] time after which an obstacle is forgotten unless it is detected again.
        body_m: [m] routes keep the robot's centre so far from obstacles: half the hull, and a hand's breadth.
        wide_m: [m] nearer obstacles make a route more expensive ...
        near_cost: ... by up to this factor.
        escape_m: [m] from a place too near to obstacles, routes may lead so far through such places.
    """

    cell_m: float = 0.1
    around_m: float = 5.0
    trusted_m: float = 3.0
    behind_m: float = 0.25
    keep_s: float = 60.0
    body_m: float = 0.36
    wide_m: float = 0.9
    near_cost: float = 4.0
    escape_m: float = 0.5


class EchoMap:
    """Floor around two points, in cells; floor without echoes counts as free.

    Args:
        one, other: [m] x, y in the frame of odometry.
        config: settings.
    """

    def __init__(self, one: tuple[float, float], other: tuple[float, float], config: EchoMapConfig) -> None:
        self._config = config
        low, high = np.minimum(one, other) - config.around_m, np.maximum(one, other) + config.around_m
        columns, rows = np.ceil((high - low) / config.cell_m).astype(int).tolist()
        x, y = (low[k] + (np.arange(count) + 0.5) * config.cell_m for k, count in enumerate((columns, rows)))
        self._low = low
        self._centres: Points = np.stack(np.meshgrid(x, y), axis=-1)  # (H, W, 2)
        self._heard_s: Cells = np.full((rows, columns), _NEVER)
        self._edges = _edges(rows, columns)

    def update(self, percept: Percept) -> None:
        """Clear the cells that the sonars' cones pass, and mark those of their echoes."""
        config, pose = self._config, percept.odometry
        row, column = self._cell((pose.x, pose.y))
        reach = round(config.trusted_m / config.cell_m)
        part = np.s_[max(row - reach, 0) : row + reach, max(column - reach, 0) : column + reach]
        local = pose.points_to_local(self._centres[part])
        distance, angle = np.hypot(local[..., 0], local[..., 1]), np.arctan2(local[..., 1], local[..., 0])
        hits = echoes(percept)
        far = np.hypot(hits[:, 0], hits[:, 1])
        for axis, until_m in zip(percept.sonar_angle_rad, far - config.behind_m, strict=True):
            off = np.abs(np.remainder(angle - axis + math.pi, math.tau) - math.pi)
            self._heard_s[part][(off < BESIDE_RAD) & (distance < until_m)] = _NEVER
        turned = hits[far < config.trusted_m] @ pose.rotation.T + (pose.x, pose.y)
        cells = np.floor((turned - self._low) / config.cell_m).astype(int)
        inside = np.all((cells >= 0) & (cells < self._heard_s.shape[::-1]), axis=1)
        self._heard_s[cells[inside, 1], cells[inside, 0]] = percept.time_s

    def find_route(
        self, pose: Pose2, goal_m: tuple[float, float], time_s: float, people: Points, people_m: float
    ) -> Points | None:
        """Return the cheapest route as points (N, 2) [m] from the robot to the goal; None if there is none.

        Args:
            pose: pose of the robot.
            goal_m: [m] x, y of the goal.
            time_s: [s] current time.
            people: (P, 2) [m] positions of people.
            people_m: [m] routes keep so far from people.
        """
        start, goal = self._cell((pose.x, pose.y)), self._cell(goal_m)
        costs = self._costs(time_s, (pose.x, pose.y), people, people_m)
        if not math.isfinite(costs[goal]):
            return None
        one, other, length = self._edges
        flat = costs.ravel()
        weights = length * (flat[one] + flat[other])
        has = np.isfinite(weights)
        graph = csr_array((weights[has], (one[has], other[has])), shape=(flat.size, flat.size))
        first, last = (int(np.ravel_multi_index(cell, costs.shape)) for cell in (start, goal))
        reached, before = dijkstra(graph, directed=False, indices=first, return_predecessors=True)
        if not math.isfinite(reached[last]):
            return None
        cells = [last]
        while cells[-1] != first:
            cells.append(int(before[cells[-1]]))
        route: Points = self._centres.reshape(-1, 2)[cells[::-1]]
        return route

    def _costs(self, time_s: float, robot: tuple[float, float], people: Points, people_m: float) -> Cells:
        """Return the cost of a metre in each cell: 1 on free floor, inf where the robot cannot be."""
        config = self._config
        is_taken = time_s - self._heard_s < config.keep_s
        free_m = np.full(is_taken.shape, math.inf)
        if is_taken.any():
            free_m = distance_transform_edt(~is_taken) * config.cell_m
        nearness = np.maximum(1.0 - free_m / config.wide_m, 0.0)
        costs: Cells = np.where(free_m < config.body_m, math.inf, 1.0 + config.near_cost * nearness)
        for person in people:
            costs[self._is_within(person, people_m)] = math.inf
        is_escape = self._is_within(np.array(robot), config.escape_m) & ~np.isfinite(costs)
        costs[is_escape] = config.near_cost**2
        return costs

    def _is_within(self, point: Points, radius_m: float) -> NDArray[np.bool_]:
        inside: NDArray[np.bool_] = np.hypot(*np.moveaxis(self._centres - point, -1, 0)) < radius_m
        return inside

    def _cell(self, point: tuple[float, float]) -> tuple[int, int]:
        """Return row and column of a point; of the nearest cell if it is outside the map."""
        rows, columns = self._heard_s.shape
        column, row = np.floor((np.array(point) - self._low) / self._config.cell_m).astype(int).tolist()
        return min(max(row, 0), rows - 1), min(max(column, 0), columns - 1)


def _edges(rows: int, columns: int) -> tuple[NDArray[np.int64], NDArray[np.int64], Points]:
    """Return the two cells of each pair of neighbours, and half of their distance in cells."""
    numbers = np.arange(rows * columns).reshape(rows, columns)
    ones, others, lengths = [], [], []
    for down, right in _STEPS:
        left = max(-right, 0)
        one = numbers[: rows - down, left : columns - max(right, 0)]
        other = numbers[down:, max(right, 0) : columns - left]
        ones.append(one.ravel())
        others.append(other.ravel())
        lengths.append(np.full(one.size, math.hypot(down, right) / 2.0))
    return np.concatenate(ones), np.concatenate(others), np.concatenate(lengths)
