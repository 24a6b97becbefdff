"""Make movers from the actions of things; impossible actions are rejected."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from peopleboy.bad_input import BadInput, found_in
from peopleboy.sim.places.extent import fixture_extent
from peopleboy.sim.places.floor_plan import FloorPlan
from peopleboy.sim.places.furniture.thing_config import ActionConfig, ThingConfig
from peopleboy.sim.places.moving import LASTING, Action, ActionKind, Mover, Stance
from peopleboy.sim.places.place import Fixture
from peopleboy.sim.shapes.shapes import UPRIGHT
from peopleboy.wording import hint

_OFF_LINE_M = 0.02  # distance that a sliding thing may deviate from its line
_AFTER_S = 1e-6
FASTEST_M_S = 2.5  # largest mean speed, so that collisions along the path are not skipped
_WANTS: Mapping[ActionKind, tuple[str, ...]] = {
    ActionKind.TURN: ("facing_deg", "hinge_m"),
    ActionKind.SLIDE: ("to_m",),
}
_TAKES: Mapping[ActionKind, tuple[str, ...]] = {
    ActionKind.APPEAR: ("to_m", "base_m", "facing_deg"),
    ActionKind.VANISH: (),
    ActionKind.GLIDE: ("to_m", "base_m", "facing_deg", "takes_s"),
    ActionKind.TURN: ("facing_deg", "hinge_m", "takes_s"),
    ActionKind.SLIDE: ("to_m", "takes_s"),
}


def make_movers(
    things: Sequence[ThingConfig],
    placed: Mapping[str, Sequence[Fixture]],
    plan: FloorPlan,
    people: Sequence[str],
    duration_s: float,
) -> tuple[Mover, ...]:
    """Collect the things that have actions.

    Args:
        things: all things of a place.
        placed: their fixtures by name, in the same order.
        plan: the floor plan.
        people: names of all people.
        duration_s: [s] duration of a run.

    Raises:
        BadInput: an action is impossible; with its key.
    """
    movers = []
    for index, (name, thing) in enumerate(zip(placed, things, strict=True)):
        if thing.actions or thing.hidden_at_start:
            with found_in("things", index):
                _check_thing(thing)
                movers.append(_mover(name, thing, placed[name], plan, people, duration_s))
    return tuple(movers)


def _check_thing(thing: ThingConfig) -> None:
    if thing.name is None:
        raise BadInput("missing key 'name', which a thing with actions needs")
    if not thing.actions:
        raise BadInput("it never appears; add an action of kind 'appear'", key=("hidden_at_start",))


def _mover(
    name: str,
    thing: ThingConfig,
    fixtures: Sequence[Fixture],
    plan: FloorPlan,
    people: Sequence[str],
    duration_s: float,
) -> Mover:
    start = _stance(fixtures[0])
    low, high = _own_box(fixtures)
    mover = Mover(name=name, start=start, low_m=low, high_m=high, is_hidden_at_start=thing.hidden_at_start)
    for index, action in enumerate(thing.actions):
        with found_in("actions", index):
            _check_keys(action)
            _check_time(action, mover, duration_s)
            _check_presence(action, mover)
            if action.by is not None and action.by not in people:
                raise BadInput(f"unknown person {action.by!r}; {hint(action.by, people)}", key=("by",))
            made = _action(action, mover.at(action.at_s).stance)
            _check_target(action, made, mover, plan)
        mover = replace(mover, actions=(*mover.actions, made))
    return mover


def _stance(fixture: Fixture) -> Stance:
    _, _, z, w = fixture.orientation
    return Stance(fixture.position, 2.0 * math.atan2(z, w))


def _own_box(fixtures: Sequence[Fixture]) -> tuple[tuple[float, float, float], tuple[float, float, float]]:
    """Return the corners of the box around a thing, in its own frame."""
    here = [replace(fixture, position=(0.0, 0.0, 0.0), orientation=UPRIGHT) for fixture in fixtures]
    extents = np.array([fixture_extent(fixture) for fixture in here])
    (x0, y0, z0), (x1, y1, z1) = extents[:, 0].min(axis=0).tolist(), extents[:, 1].max(axis=0).tolist()
    return (x0, y0, z0), (x1, y1, z1)


def _check_keys(action: ActionConfig) -> None:
    kind = ActionKind(action.kind)
    for key in ("to_m", "base_m", "facing_deg", "takes_s", "hinge_m"):
        if getattr(action, key) is not None and key not in _TAKES[kind]:
            raise BadInput(f"action '{kind}' does not use it; remove it", key=(key,))
    for key in _WANTS.get(kind, ()):
        if getattr(action, key) is None:
            raise BadInput(f"missing key {key!r}, which action '{kind}' needs")
    wherever = (action.to_m, action.base_m, action.facing_deg)
    if kind is ActionKind.GLIDE and all(value is None for value in wherever):
        raise BadInput("missing key 'to_m', 'base_m' or 'facing_deg': action 'glide' needs one of them")
    if kind in LASTING and action.takes_s is None:
        raise BadInput(f"missing key 'takes_s', which action '{kind}' needs")
    if action.takes_s is not None and action.takes_s <= 0.0:
        raise BadInput(f"{action.takes_s:g} must be more than 0", key=("takes_s",))


def _check_time(action: ActionConfig, mover: Mover, duration_s: float) -> None:
    if action.at_s < 0.0:
        raise BadInput(f"{action.at_s:g} is before the run starts; it must be 0 or more", key=("at_s",))
    if action.at_s >= duration_s:
        raise BadInput(f"{action.at_s:g} must be before the end, duration_s {duration_s:g}", key=("at_s",))
    if not mover.actions:
        return
    before = mover.actions[-1]
    if action.at_s < before.at_s - _AFTER_S:
        raise BadInput(f"{action.at_s:g} must be after {before.at_s:g}, the previous start", key=("at_s",))
    if action.at_s < before.ends_s - _AFTER_S or action.at_s <= before.at_s:
        raise BadInput(
            f"{action.at_s:g} is before the end of the previous action, {before.ends_s:g}", key=("at_s",)
        )


def _check_presence(action: ActionConfig, mover: Mover) -> None:
    is_there = mover.at(action.at_s).is_there
    if (action.kind == ActionKind.APPEAR) == is_there:
        now = "there already" if is_there else "not there"
        way_out = "; with hidden_at_start: true it would not be" if is_there and not mover.actions else ""
        raise BadInput(
            f"'{action.kind}': {mover.name!r} is {now} at {action.at_s:g} s{way_out}", key=("kind",)
        )


def _action(spec: ActionConfig, before: Stance) -> Action:
    x, y, z = before.position_m
    heading = before.heading_rad if spec.facing_deg is None else math.radians(spec.facing_deg)
    x, y = (x, y) if spec.to_m is None else spec.to_m
    target = Stance((x, y, z if spec.base_m is None else spec.base_m), heading)
    if spec.hinge_m is not None:
        turn = math.remainder(heading - before.heading_rad, math.tau)
        target = before.turned_about(spec.hinge_m, turn)
    return Action(
        kind=ActionKind(spec.kind),
        at_s=spec.at_s,
        takes_s=0.0 if spec.takes_s is None else spec.takes_s,
        target=target,
        hinge_m=spec.hinge_m,
        by=spec.by,
    )


def _check_target(spec: ActionConfig, action: Action, mover: Mover, plan: FloorPlan) -> None:
    before = mover.at(action.at_s).stance
    x, y, _ = action.target.position_m
    if not plan.contains(x, y):
        key = "hinge_m" if spec.to_m is None else "to_m"
        raise BadInput(f"({x:g}, {y:g}) is outside the floor; {plan.describe()}", key=(key,))
    way_m = math.dist(before.position_m, action.target.position_m)
    if action.takes_s and way_m > FASTEST_M_S * action.takes_s:
        raise BadInput(
            f"{action.takes_s:g} is too short for {way_m:.2g} m; the fastest speed is {FASTEST_M_S:g} m/s",
            key=("takes_s",),
        )
    if action.kind is ActionKind.SLIDE:
        aside = abs(float(before.locate(np.array(action.target.position_m))[1]))
        if aside > _OFF_LINE_M:
            raise BadInput(
                f"({x:g}, {y:g}) is {aside:.2g} m off the line along which {mover.name!r} slides; "
                "or use action 'glide'",
                key=("to_m",),
            )
