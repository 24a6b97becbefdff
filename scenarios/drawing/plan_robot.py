"""Draw the robot on a plan: its start, its field of view with the counted range, and its scripted path."""

from __future__ import annotations

import math

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon
from numpy.typing import NDArray

from peopleboy.scenarios.drawing.plan_sheet import Labels
from peopleboy.scenarios.files.check import ROBOT_M
from peopleboy.scenarios.files.robot import CommandSpec
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.sim.cameras.kinds import flat_geometry
from peopleboy.sim.places.place import Place
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.truth.truth import COUNTED_FARTHEST_M, COUNTED_NEAREST_M

_COLOUR = "#c0392b"
_STEP_S = 0.05
_RAYS = 721
_FAR_M = 100.0


def draw_robot(axes: Axes, labels: Labels, scenario: Scenario, robot: RobotConfig) -> None:
    """Draw the robot where it starts, and what its thermal camera sees from there, up to the walls."""
    x, y = robot.at_m
    _draw_view(axes, labels, robot, scenario.place)
    track = _script_track(scenario, robot)
    if np.ptp(track, axis=0).max() > 0.05:
        axes.plot(track[:, 0], track[:, 1], color=_COLOUR, lw=1.4, ls=(0, (4, 2)), zorder=5)
        axes.add_patch(Circle(track[-1], 0.06, color=_COLOUR, zorder=5))
    axes.add_patch(Circle((x, y), ROBOT_M, facecolor="white", edgecolor=_COLOUR, lw=1.4, zorder=6))
    nose = [(1.0, 0.0), (-0.6, 0.55), (-0.3, 0.0), (-0.6, -0.55)]
    c, s = math.cos(robot.heading_rad), math.sin(robot.heading_rad)
    axes.add_patch(
        Polygon(
            [(x + 0.8 * ROBOT_M * (c * u - s * v), y + 0.8 * ROBOT_M * (s * u + c * v)) for u, v in nose],
            color=_COLOUR,
            zorder=6,
        )
    )
    labels.block(x, y, ROBOT_M)
    labels.write(x - 0.2, y - 0.2, "robot", size=7.5, color=_COLOUR, weight="bold")


def _draw_view(axes: Axes, labels: Labels, robot: RobotConfig, place: Place) -> None:
    camera = flat_geometry(robot.cameras, "thermal")
    c, s = math.cos(robot.heading_rad), math.sin(robot.heading_rad)
    forward, left, _ = camera.position_m
    eye = np.array([robot.at_m[0] + c * forward - s * left, robot.at_m[1] + s * forward + c * left])
    half = math.atan(camera.width / 2.0 / camera.focal_px)
    angles = robot.heading_rad + camera.yaw_rad + np.linspace(-half, half, _RAYS)
    rays = np.stack([np.cos(angles), np.sin(angles)], axis=1)
    reach = _distance_to_walls(eye, rays, place)[:, None]
    near, far = COUNTED_NEAREST_M, COUNTED_FARTHEST_M
    inner, outer = np.minimum(reach, near) * rays, np.minimum(reach, far) * rays
    _fill(axes, eye + np.concatenate([reach * rays, np.zeros((1, 2))]))
    _fill(axes, eye + np.concatenate([outer, inner[::-1]]))
    for radius in (near, far):
        arc = np.where(reach >= radius, eye + radius * rays, np.nan)
        axes.plot(arc[:, 0], arc[:, 1], color=_COLOUR, lw=0.9, alpha=0.8, ls=(0, (4, 3)), zorder=2)
        _label_arc(labels, arc, f"{radius:g} m")


def _fill(axes: Axes, corners: NDArray[np.float64]) -> None:
    axes.add_patch(Polygon(corners, facecolor=_COLOUR, lw=0.0, alpha=0.065, zorder=1))


def _label_arc(labels: Labels, arc: NDArray[np.float64], text: str) -> None:
    """Write its distance beside the end of an arc, if any of it is in the open."""
    seen = arc[np.isfinite(arc[:, 0])]
    if len(seen):
        x, y = seen[len(seen) // 12]
        labels.write(x, y, text, size=6.8, color=_COLOUR)


def _distance_to_walls(
    eye: NDArray[np.float64], rays: NDArray[np.float64], place: Place
) -> NDArray[np.float64]:
    """How far (R,) [m] each ray (R, 2) goes until it meets a wall (slab method)."""
    boxes = place.obstacles[[name.startswith("wall_") for name in place.obstacle_names]]
    way = np.where(np.abs(rays) < 1e-9, 1e-9, rays)[:, None, :]
    first, second = (boxes[None, :, :2] - eye) / way, (boxes[None, :, 2:] - eye) / way
    near = np.minimum(first, second).max(axis=2)
    far = np.maximum(first, second).min(axis=2)
    hits: NDArray[np.float64] = np.where((near < far) & (far > 0.0), np.maximum(near, 0.0), _FAR_M)
    return np.asarray(hits.min(axis=1))


def _script_track(scenario: Scenario, robot: RobotConfig) -> NDArray[np.float64]:
    """Where a script would drive a robot that obeys at once: (T, 2) [m]."""
    x, y, heading = *robot.at_m, robot.heading_rad
    track = [(x, y)]
    for step in range(round(scenario.duration_s / _STEP_S)):
        command = _command_at(scenario.robot.commands, step * _STEP_S)
        heading += math.radians(command.angular_deg_s) * _STEP_S
        x += command.linear_m_s * math.cos(heading) * _STEP_S
        y += command.linear_m_s * math.sin(heading) * _STEP_S
        track.append((x, y))
    return np.array(track)


def _command_at(commands: tuple[CommandSpec, ...], time_s: float) -> CommandSpec:
    given = [command for command in commands if command.from_s <= time_s]
    return given[-1] if given else CommandSpec(from_s=0.0)
