"""Draw movement on a plan: the robot with its field of view, people's paths, and objects that are moved."""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import Circle, Polygon
from numpy.typing import NDArray

from peopleboy.scenarios.drawing.plan_sheet import Labels, footprints
from peopleboy.scenarios.files.check import ROBOT_M
from peopleboy.scenarios.files.robot import CommandSpec
from peopleboy.scenarios.files.scenario import Scenario
from peopleboy.scenarios.scores.goal_metrics import REACHED_M
from peopleboy.sim.cameras.kinds import flat_geometry
from peopleboy.sim.people.person_config import PersonConfig, Waypoint
from peopleboy.sim.people.walking.walker import ALONE, Walker
from peopleboy.sim.places.moving import ActionKind, Mover, Stance
from peopleboy.sim.places.place import Fixture, Place
from peopleboy.sim.robot.robot_config import RobotConfig
from peopleboy.sim.truth.events import STANDS_S
from peopleboy.sim.truth.truth import COUNTED_FARTHEST_M, COUNTED_NEAREST_M

_STEP_S = 0.05
_MARK_EVERY_S = 5.0
_SHORTEST_PAUSE_S = 0.5
_ARRIVED_M = 0.05


@dataclass(frozen=True, slots=True, eq=False)
class _Way:
    """Path of an undisturbed person: times (T,) [s], positions (T, 2) [m], and whether it ends in leaving."""

    times: NDArray[np.float64]
    places: NDArray[np.float64]
    leaves: bool

    @property
    def walks(self) -> bool:
        """Whether the person walks."""
        return bool(np.ptp(self.places, axis=0).max() > _ARRIVED_M)


def draw_person(axes: Axes, labels: Labels, person: PersonConfig, end_s: float, colour: str) -> None:
    """Draw a person's path with times and pauses, and the name at its start."""
    way = _walk(person, end_s)
    axes.plot(way.places[:, 0], way.places[:, 1], color=colour, lw=1.6, alpha=0.9, zorder=7)
    _draw_arrows(axes, way, colour)
    start = way.places[0]
    axes.add_patch(Circle(start, 0.11, facecolor=colour, edgecolor="white", lw=1.0, zorder=8))
    labels.block(start[0], start[1], 0.12)
    for x, y in np.unique(np.round(way.places, 1), axis=0):  # once where the person stands still
        labels.block(x, y, 0.05)
    name = f"{person.name} {person.height_m:.2f} m{_presence(person, way)}"
    labels.write(start[0], start[1], name, size=8, color=colour, weight="bold")
    manner = _manner(person)
    if manner:
        labels.write(start[0], start[1], manner, size=6.5, color=colour, style="italic")
    _draw_pauses(axes, labels, person, way, colour)
    _draw_times(axes, labels, way, colour)


def _presence(person: PersonConfig, way: _Way) -> str:
    """Describe when a person arrives and leaves; a walker's departure is labelled at the path's end."""
    enters = f"from {person.enter_s:.1f}" if person.enter_s > 0.0 else ""
    leaves = f"until {person.leave_s:.1f}" if way.leaves and not way.walks else ""
    return f", {' '.join(filter(None, (enters, leaves)))} s" if enters or leaves else ""


def _manner(person: PersonConfig) -> str:
    """Describe whether a person gives way to others, and how the person treats the robot."""
    parts = ["yields"] if person.yields else []
    if person.reacts is not None:
        near = "" if person.reacts.from_m is None else f" from {person.reacts.from_m:g} m"
        parts.append(f"robot: {person.reacts.way.replace('_', ' ')}{near}")
    if person.leads is not None:
        parts.append("leads the robot")
    return ", ".join(parts)


def _waits(waypoint: Waypoint) -> str:
    """Describe a wait for the robot; empty without one."""
    if waypoint.until_robot_within_m is None:
        return ""
    return (
        f"waits for the robot within {waypoint.until_robot_within_m:g} m,\n"
        f"at most {waypoint.waits_at_most_s:g} s more"
    )


def _walk(person: PersonConfig, end_s: float) -> _Way:
    walker = Walker(person.path, yields=False, radius_m=0.0)
    end = end_s if person.leave_s is None else min(end_s, person.leave_s)
    places = [walker.position.copy()]
    for _ in range(max(round((end - person.enter_s) / _STEP_S), 1)):
        walker.step(_STEP_S, ALONE)
        places.append(walker.position.copy())
    times = person.enter_s + _STEP_S * np.arange(len(places), dtype=np.float64)
    leaves = person.leave_s is not None and person.leave_s < end_s
    return _Way(times=times, places=np.array(places), leaves=leaves)


def _draw_arrows(axes: Axes, way: _Way, colour: str) -> None:
    """Draw an arrow head every two metres walked, between the time marks."""
    steps = np.linalg.norm(np.diff(way.places, axis=0), axis=1)
    walked = np.cumsum(steps)
    for distance in np.arange(1.0, walked[-1], 2.0):
        index = int(np.searchsorted(walked, distance))
        tail, head = way.places[index], way.places[min(index + 2, len(way.places) - 1)]
        if math.dist(tail, head) > 1e-3:
            axes.annotate(
                "",
                head,
                tail,
                arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.2, "shrinkA": 0, "shrinkB": 0},
                zorder=7,
            )


def _draw_pauses(axes: Axes, labels: Labels, person: PersonConfig, way: _Way, colour: str) -> None:
    for waypoint in person.path:
        waits = _waits(waypoint)
        if not waits and (waypoint.pause_s < _SHORTEST_PAUSE_S or waypoint is person.path[-1]):
            continue
        gaps = np.linalg.norm(way.places - np.array(waypoint.at_m), axis=1)
        if gaps.min() > 0.1:
            continue  # the scenario ends before the pause
        axes.add_patch(Circle(waypoint.at_m, 0.16, facecolor="none", edgecolor=colour, lw=1.2, zorder=8))
        labels.block(*waypoint.at_m, 0.16)
        what = "" if waypoint.posture == "standing" else f" {waypoint.posture.replace('_', ' ')}"
        facing = f", faces {waypoint.face}" if isinstance(waypoint.face, str) else ""
        pause = f"pauses {waypoint.pause_s:g} s{what}{facing}" if waypoint.pause_s or not waits else ""
        text = "\n".join(filter(None, (pause, waits)))
        labels.write(*waypoint.at_m, text, size=6.5, color=colour, style="italic")


def _draw_times(axes: Axes, labels: Labels, way: _Way, colour: str) -> None:
    """Draw a dot every five seconds along the path, and label its end."""
    far = np.linalg.norm(way.places - way.places[-1], axis=1)
    on_the_way = np.flatnonzero(far > _ARRIVED_M)
    if len(on_the_way) == 0:
        return
    arrival = int(on_the_way[-1]) + 1
    before = way.places[0]
    first = math.floor(way.times[0] / _MARK_EVERY_S) + 1
    for time_s in np.arange(first * _MARK_EVERY_S, way.times[arrival] - 0.5, _MARK_EVERY_S):
        place = way.places[round((time_s - way.times[0]) / _STEP_S)]
        if math.dist(place, before) > 0.1:
            axes.plot(*place, "o", ms=4.0, mfc="white", mec=colour, mew=1.1, zorder=8)
            labels.write(place[0], place[1], f"{time_s:g} s", size=6.8, color=colour)
        before = place
    x, y = way.places[-1]
    axes.plot(x, y, "s", ms=4.5, mfc=colour, mec="white", mew=0.8, zorder=8)
    stays = way.times[-1] - way.times[arrival] > _SHORTEST_PAUSE_S
    end = f"{'leaves' if way.leaves else 'run ends'} at {way.times[-1]:.0f} s"
    what = f"stays from {way.times[arrival]:.0f} s{f', {end}' if way.leaves else ''}" if stays else end
    labels.write(x, y, what, size=6.8, color=colour, weight="bold")


COLOUR = "#8a5a00"
_SHORTEST_M = 0.15
_CLEAR_M = 0.2  # between the middle of an outline and its label


@dataclass(frozen=True, slots=True)
class _Leg:
    """An object's path from one resting place to the next; from None it appears, to None it vanishes."""

    start: Stance | None
    end: Stance | None
    at_s: float
    by: str | None


def draw_moves(axes: Axes, labels: Labels, place: Place) -> None:
    """Draw moved objects: their resting places, paths, start times, and the people who move them."""
    for mover in place.movers:
        own = [fixture for fixture in place.fixtures if fixture.name.split("/")[0] == mover.name]
        for leg in _legs(mover):
            if leg.end is not None:
                _draw_ghost(axes, own, leg.end)
            _draw_arrow(axes, leg)
            _label(labels, leg)


def _legs(mover: Mover) -> Iterator[_Leg]:
    """Return the paths of an object between its resting places."""
    here: Stance | None = None if mover.is_hidden_at_start else mover.start
    setting_off: tuple[Stance | None, float, str | None] | None = None
    for index, action in enumerate(mover.actions):
        if setting_off is None:
            setting_off = (here, action.at_s, action.by)
        here = None if action.kind is ActionKind.VANISH else action.target
        follows = mover.actions[index + 1 : index + 2]
        lasts = bool(action.takes_s) and any(
            after.takes_s and after.at_s - action.ends_s < STANDS_S for after in follows
        )
        if not lasts:
            start, at_s, by = setting_off
            yield _Leg(start, here, at_s, by)
            setting_off = None


def _draw_ghost(axes: Axes, fixtures: list[Fixture], stance: Stance) -> None:
    for fixture in fixtures:
        moved = replace(fixture, position=stance.position_m, orientation=stance.orientation)
        for corners in footprints(moved):
            axes.add_patch(
                Polygon(corners, facecolor="none", edgecolor=COLOUR, lw=0.7, ls=(0, (2, 1.5)), zorder=5)
            )


def _draw_arrow(axes: Axes, leg: _Leg) -> None:
    if leg.start is None or leg.end is None:
        return
    tail, head = leg.start.position_m[:2], leg.end.position_m[:2]
    if math.dist(tail, head) > _SHORTEST_M:
        axes.annotate(
            "", head, tail, zorder=6,
            arrowprops={"arrowstyle": "-|>", "color": COLOUR, "lw": 1.1, "shrinkA": 0, "shrinkB": 2},
        )  # fmt: skip


def _label(labels: Labels, leg: _Leg) -> None:
    spot = leg.end if leg.end is not None else leg.start
    assert spot is not None
    what = "vanishes" if leg.end is None else "appears" if leg.start is None else "moved"
    by = "" if leg.by is None else f" by {leg.by}"
    x, y, _ = spot.position_m
    labels.block(x, y, _CLEAR_M)
    labels.write(x, y, f"{what} {leg.at_s:.0f} s{by}", size=6.2, color=COLOUR)


_COLOUR = "#c0392b"
_RAYS = 721
_FAR_M = 100.0


def draw_robot(axes: Axes, labels: Labels, scenario: Scenario, robot: RobotConfig) -> None:
    """Draw the robot at its start, its goal, and the field of view of its thermal camera up to the walls."""
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
    if scenario.robot.goal_m is not None:
        x, y = scenario.robot.goal_m
        for radius_m in (REACHED_M, ROBOT_M / 2.0):
            axes.add_patch(Circle((x, y), radius_m, facecolor="none", edgecolor=_COLOUR, lw=1.4, zorder=6))
        labels.block(x, y, ROBOT_M)
        labels.write(x, y, "goal", size=7.5, color=_COLOUR, weight="bold")


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
    """Label the end of an arc with its distance, if any of the arc is visible."""
    seen = arc[np.isfinite(arc[:, 0])]
    if len(seen):
        x, y = seen[len(seen) // 12]
        labels.write(x, y, text, size=6.8, color=_COLOUR)


def _distance_to_walls(
    eye: NDArray[np.float64], rays: NDArray[np.float64], place: Place
) -> NDArray[np.float64]:
    """Return the distance (R,) [m] along each ray (R, 2) to the first wall (slab method)."""
    boxes = place.obstacles[[name.startswith("wall_") for name in place.obstacle_names]]
    way = np.where(np.abs(rays) < 1e-9, 1e-9, rays)[:, None, :]
    first, second = (boxes[None, :, :2] - eye) / way, (boxes[None, :, 2:] - eye) / way
    near = np.minimum(first, second).max(axis=2)
    far = np.maximum(first, second).min(axis=2)
    hits: NDArray[np.float64] = np.where((near < far) & (far > 0.0), np.maximum(near, 0.0), _FAR_M)
    return np.asarray(hits.min(axis=1))


def _script_track(scenario: Scenario, robot: RobotConfig) -> NDArray[np.float64]:
    """Return the path (T, 2) [m] of a robot that follows a script without delay."""
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
