"""One track for one person ahead of the robot: by heat, and by depth with colour."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import replace

import numpy as np

from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.fusion.fusion_config import FusionConfig
from peopleboy.tracker.fusion.matching import apart, pairs
from peopleboy.tracker.fusion.outline import outline
from peopleboy.tracker.fusion.peek import peek
from peopleboy.tracker.fusion.person import Person, newborn
from peopleboy.tracker.fusion.senses import Depth, Heat, glance_for
from peopleboy.tracker.fusion.told import Told
from peopleboy.tracker.panoramic.robot_pose import RobotPose
from peopleboy.tracker.rgbd.people.look_at import Body
from peopleboy.tracker.rgbd.people.looks import BINS, similarity
from peopleboy.tracker.rgbd.rgbd_tracker import RgbdTracker
from peopleboy.tracker.thermal.people_tracker import PeopleTracker
from peopleboy.tracker.track import Box, Status, Track

_LONGEST_STEP_S = 0.5


class AheadTracker:
    """People whom a thermal tracker and one by depth tell of, each with one number."""

    def __init__(self, thermal: PeopleTracker, rgbd: RgbdTracker, config: FusionConfig) -> None:
        self._config = config
        self._heat, self._depth = Heat(thermal, config), Depth(rgbd, config)
        self._pose = RobotPose()
        self._people: tuple[Person, ...] = ()
        self._time_s = -math.inf
        self._newest = 0

    def update(self, frame: Frame) -> tuple[Track, ...]:
        if frame.odometry is not None:
            self._pose = self._pose.moved(frame.odometry)
        dt_s = min(frame.time_s - self._time_s, _LONGEST_STEP_S)
        self._time_s = frame.time_s
        deep, warm = self._depth.told(frame, self._pose), self._heat.told(frame, self._pose)
        people = [one.later(dt_s, self._config) for one in self._people]
        if self._config.heat_first:
            people = self._with_heat(people, warm or ())
            people = self._with_depth(people, deep or ())
        else:
            people = self._with_depth(people, deep or ())
            people = self._with_heat(people, warm or ())
        people = self._exchanged(people)
        if self._config.peeks and deep is not None:
            people = [self._peeked(p, people, frame) for p in people]
        people = self._widths(self._without_doubles(people), frame)
        self._people = tuple(p for p in people if frame.time_s - p.seen_s <= self._config.remembered_s)
        return tuple(self._track(p, frame) for p in self._people if self._is_shown(p, frame))

    def _with_depth(self, people: Sequence[Person], told: Sequence[Told]) -> list[Person]:
        take: Callable[[Person, Told], Person] = lambda p, t: p.with_depth(t, self._time_s, self._config)
        return self._joined(people, told, [p.depth for p in people], take)

    def _with_heat(self, people: Sequence[Person], told: Sequence[Told]) -> list[Person]:
        take: Callable[[Person, Told], Person] = lambda p, t: p.with_heat(t, self._time_s, self._config)
        return self._joined(people, told, [p.heat for p in people], take)

    def _joined(self, people: Sequence[Person], told: Sequence[Told], owns, take) -> list[Person]:
        found = pairs(people, told, owns, self._config)
        joined = [take(p, told[found[k]]) if k in found else p for k, p in enumerate(people)]
        for k, one in enumerate(told):
            if k in found.values() or not one.is_seen:
                continue
            known = self._returned(joined, one, owns)
            if known is not None:
                joined[known] = take(replace(joined[known], motion=newborn(1, one, 0.0).motion), one)
            elif not any(self._is_on(one, p) for p in joined):
                self._newest += 1
                joined.append(take(newborn(self._newest, one, self._time_s), one))
        return joined

    def _returned(self, people: Sequence[Person], one: Told, owns) -> int | None:
        config = self._config
        best, least = None, np.inf
        slack = 2.0 * math.sqrt(float(np.linalg.eigvalsh(one.error_m2)[-1]))
        for k, p in enumerate(people):
            if p.is_seen or k >= len(owns):
                continue
            late = self._time_s - p.seen_s
            reach = config.reach_m + config.fastest_m_s * late + slack
            away = float(np.hypot(*(one.place_m - p.motion.place_m)))
            if away > reach:
                continue
            cost = away / reach
            knows = one.looks is not None and p.looks is not None
            if knows:
                alike = similarity(p.looks, one.looks)
                if alike < config.least_alike:
                    continue
                cost += 5.0 * (1.0 - alike)
            if one.tall_m is not None and p.depth is not None:
                off = abs(one.tall_m - p.tall_m)
                if off > config.tallest_off_m:
                    continue
                cost += off / config.tallest_off_m
            if one.id == owns[k]:
                cost -= 1.0
            elif not knows and late > 3.0:
                continue
            if cost < least:
                best, least = k, cost
        return best

    def _is_on(self, one: Told, p: Person) -> bool:
        return p.is_seen and one.tall_m is None and apart(p, one, self._config.floor_m) < self._config.own_gate

    def _without_doubles(self, people: list[Person]) -> list[Person]:
        """Make one of two of whom one is only warm, and the other only deep, at one place."""
        kept = list(people)
        for a in people:
            if a not in kept or a.deep is None or a.warm is not None or not a.deep.is_seen:
                continue
            for b in kept:
                if b.deep is None and b.warm is not None and b.warm.is_seen and apart(a, b.warm, self._config.floor_m) < self._config.gate:
                    both = replace(a, warm=b.warm, heat=b.heat)
                    if b.id < a.id:
                        both = replace(both, id=b.id, born_s=b.born_s, looks=a.looks if b.looks is None else b.looks)
                    kept = [both if p is a else p for p in kept if p is not b]
                    break
        return kept

    def _widths(self, people: list[Person], frame: Frame) -> list[Person]:
        return [self._measured(p, frame) for p in people]

    def _measured(self, p: Person, frame: Frame) -> Person:
        if p.warm is None or not p.warm.is_clear or p.warm.box is None:
            return p
        _, _, width, height = p.warm.box
        if p.deep is not None and p.deep.is_clear and p.deep.span_m is not None:
            x, y = self._pose.locate(p.motion.place_m)
            c = frame.calibrations[THERMAL].project(np.array([[x, y, p.tall_m], [x, y, 0.0]]))
            contour = width * p.tall_m / (c[1, 1] - c[0, 1])
            wide = 0.045 * p.tall_m + 0.32 * contour + 0.47 * p.deep.span_m
        else:
            wide = p.tall_m * (0.065 + 0.715 * width / height)
        return replace(p, wide_m=p.wide_m + self._config.torso_per_contour * (wide - p.wide_m))

    def _exchanged(self, people: list[Person]) -> list[Person]:
        """Let people whose looks are another's have that one's number."""
        config = self._config
        known = {p.id: p for p in people}
        for a in people:
            a = known.get(a.id)
            if a is None or a.deep is None or a.deep.looks is None or not a.deep.is_clear:
                continue
            is_young, is_strange = self._time_s - a.born_s < config.young_s, a.strange >= config.strange
            if not is_young and not is_strange:
                continue
            best, most = None, config.least_alike if is_strange else config.least_young
            for b in known.values():
                if b is a or b.looks is None or (b.is_seen and (b.strange < 2 or not is_strange)):
                    continue
                if b.born_s > a.born_s - 1.0 and not is_strange:
                    continue
                away = float(np.hypot(*(a.motion.place_m - b.motion.place_m)))
                if not b.is_seen and away > config.reach_m + config.fastest_m_s * (self._time_s - b.seen_s + 1.0):
                    continue
                alike = similarity(b.looks, a.deep.looks)
                if alike > most and abs(a.deep.tall_m - b.tall_m) < config.tallest_off_m:
                    best, most = b, alike
            if best is None:
                continue
            known[best.id] = a.named(best)
            if is_young and not best.is_seen:
                del known[a.id]
            else:
                known[a.id] = best.named(a)
        return list(known.values())

    def _peeked(self, p: Person, people: Sequence[Person], frame: Frame) -> Person:
        if any(one.is_clear for one in p.told) or self._time_s - p.seen_s > self._config.peek_s or p.depth is None:
            return p
        here = self._pose.locate(p.motion.place_m)
        for q in people:
            if q.id != p.id and q.is_seen:
                there = self._pose.locate(q.motion.place_m)
                if abs(there[0] - here[0]) < 0.5 and abs(there[1] - here[1]) < 0.7:
                    return p
        found = peek(here, p.span_m, p.tall_m, frame)
        if found is None or (found.warm is not None and found.warm < self._config.peek_warm):
            return p
        place = self._pose.place(float(np.hypot(*found.place_m)), float(np.arctan2(found.place_m[1], found.place_m[0])))
        motion = p.motion.corrected(place, np.eye(2) * self._config.peek_m**2)
        return replace(p, motion=motion, peeked=True, seen_s=self._time_s)

    def _is_shown(self, p: Person, frame: Frame) -> bool:
        if p.is_seen:
            return True
        late, config = self._time_s - p.seen_s, self._config
        if late > config.hidden_s:
            return False
        body = Body(p.wide_m, p.tall_m, 0.0, np.zeros(BINS))
        found = glance_for(self._pose.locate(p.motion.place_m), body, 0.4, frame)
        if found is not None:
            return found.nearer > config.hidden_share
        return p.warm is not None or late <= config.blink_s

    def _track(self, p: Person, frame: Frame) -> Track:
        box = outline(p, frame, self._pose)
        return Track(
            id=p.id,
            boxes={} if box is None else {THERMAL: box},
            place=p.floor_place(self._pose, self._config.shared_m),
            confidence=max((t.confidence for t in p.told), default=0.1),
            status=p.status,
            age_s=self._time_s - p.born_s,
        )
