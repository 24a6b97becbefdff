"""The tracks of the people tracker, and their life: initiated, confirmed or re-identified, deleted."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import count

import numpy as np
from numpy.typing import NDArray

from peopleboy.tracker.boxes import iou
from peopleboy.tracker.tracking.association import CLEAR, shared_area
from peopleboy.tracker.tracking.camera_motion import FrameMotion
from peopleboy.tracker.tracking.config import KalmanConfig, ReidentificationConfig
from peopleboy.tracker.tracking.motion_filter import NO_STATES, Floats, StateEstimates, predict
from peopleboy.tracker.tracking.people_gallery import KnownPerson, PeopleGallery
from peopleboy.tracker.tracking.reidentification import (
    Candidates,
    assign_lost,
    is_same_again,
    known_person_log_odds,
    resolve_identity_swaps,
    same_person_log_odds,
)
from peopleboy.tracker.tracking.sensor import Predictions, SensorDetections
from peopleboy.tracker.tracking.track_state import Continuation, TrackState
from peopleboy.tracker.tracking.viewpoint import Position


class Tracks:
    """K tracks, by rows.

    Attributes:
        items: the state of each track, apart from the motion filter.
        states: of the motion filters, in the level frame.
        last_seen: the same when each track was last detected.
        origin_m: origin of the level frame in the robot frame; None without a calibrated camera.
        gallery: the people of earlier runs, kept up to date; None to forget people with their tracks.
    """

    def __init__(self) -> None:
        self.items: list[TrackState] = []
        self.states = self.last_seen = NO_STATES
        self.origin_m: Position | None = None
        self.gallery: PeopleGallery | None = None
        self._keys, self._ids = count(), count(1)

    def predict(self, dt_s: float, moved: FrameMotion, config: KalmanConfig) -> StateEstimates:
        """Predict the tracks, and return the states before that in the present level frame."""
        before = predict(self.states, 0.0, moved, config)
        self.states = predict(self.states, dt_s, moved, config)
        self.last_seen = predict(self.last_seen, 0.0, moved, config)
        for one in self.items:
            if one.continuation is not None:
                last_seen = predict(one.continuation.last_seen, 0.0, moved, config)
                one.continuation = one.continuation._replace(last_seen=last_seen)
        return before

    def predictions(self) -> Predictions:
        """Return what sensors may know of the tracks."""
        return Predictions(
            keys=tuple(one.key for one in self.items),
            states=self.states,
            ratio=np.array([one.ratio for one in self.items]),
            log_odds=np.array([one.log_odds for one in self.items]),
            is_confirmed=self.are_confirmed(),
            origin_m=self.origin_m,
        )

    def are_confirmed(self, count: int | None = None) -> NDArray[np.bool_]:
        """Return which tracks are confirmed, or which of the first ones."""
        return np.array([one.is_confirmed for one in self.items[:count]], np.bool_)

    def of_confirmed(self, found: Mapping[int, int]) -> list[int]:
        """Return the detections of confirmed tracks, from those by row."""
        return [column for row, column in found.items() if self.items[row].is_confirmed]

    def odds_of_lost(
        self, rows: Sequence[int], found: Candidates, time_s: float, config: ReidentificationConfig
    ) -> Floats:
        """Return the log-odds (L, M) that people who are found are lost ones, less those needed."""
        lost = Candidates.of(
            self.last_seen.take(np.array(rows, np.intp)), [self.items[row].colours for row in rows]
        )
        gone_s = np.array([time_s - self.items[row].seen_s for row in rows])
        return same_person_log_odds(lost, gone_s, found, config)

    def correct(
        self,
        rows: Sequence[int],
        detections: SensorDetections,
        columns: Sequence[int],
        was_lost: Sequence[bool],
    ) -> None:
        """Update the motion filters; that of a lost track starts again, as its path was extrapolated."""
        later = detections.measurement.update(self.states.take(np.array(rows)), columns)
        if any(was_lost):
            lost = np.flatnonzero(was_lost)
            restarted = detections.measurement.initiate([columns[row] for row in lost.tolist()])
            later = later.replaced(lost, restarted)
        self.states = self.states.replaced(np.array(rows), later)
        self.last_seen = self.last_seen.replaced(np.array(rows), later)

    def stop(self, row: int, states: StateEstimates) -> None:
        """Let a hidden person stand where some states have them."""
        self.states.mean[row], self.states.mean[row, 3:6] = states.mean[row], 0.0
        self.items[row].is_pinned = True

    def initiate(
        self, found: Mapping[int, int], detections: SensorDetections, boxes: Floats, time_s: float
    ) -> dict[int, int]:
        """Initiate tracks from detections away from all tracks, of boxes (K, 4); return their detections."""
        existence, lost_s = detections.settings.existence, detections.settings.association.lost_s
        is_free = detections.scores >= existence.birth
        is_free[list(found.values())] = False
        recent = np.array([one.seen_s > time_s - lost_s for one in self.items], bool)
        if recent.any():
            is_free &= (iou(detections.boxes[:, None], boxes[recent][None]) < existence.taken).all(axis=1)
        if not detections.is_masked:
            is_mixed = shared_area(detections.boxes, self.of_confirmed(found)) > CLEAR
            detections = detections.without_colours(is_mixed)
        return self._add(np.flatnonzero(is_free), detections, time_s)

    def initiate_at(self, box: Floats, detections: SensorDetections, time_s: float) -> None:
        """Initiate a track at a hint (4,) by its detection, replacing any track that was there."""
        taken = detections.settings.existence.taken
        self._keep(np.flatnonzero(iou(detections.expected, box[None]) < taken))
        self._add(np.zeros(1, int), detections, time_s)
        self._confirm(self.items[-1], -np.inf)  # a hint is certain

    def _add(self, free: NDArray[np.intp], detections: SensorDetections, time_s: float) -> dict[int, int]:
        """Initiate tracks from some of the detections, and return their detections by row."""
        if len(free) == 0:
            return {}
        first, existence = len(self.items), detections.settings.existence
        new = detections.measurement.initiate(free)
        self.states, self.last_seen = self.states.joined(new), self.last_seen.joined(new)
        self.items += [
            TrackState(
                key=next(self._keys),
                born_s=time_s,
                seen_s=time_s,
                pattern=detections.pattern[column],
                colours=detections.colours[column],
                ratio=detections.ratio(column),
                existence=existence,
                shown={detections.camera: (time_s, detections.boxes[column])},
                log_odds=min(float(detections.scores[column]), existence.highest_score),
                surest=float(detections.scores[column]),
            )
            for column in free.tolist()
        ]
        return {first + number: column for number, column in enumerate(free.tolist())}

    def settle(self, time_s: float, config: ReidentificationConfig) -> None:
        """Confirm, re-identify and delete tracks."""
        self._verify_continuations(time_s, config)
        self._reidentify(time_s, config)
        resolve_identity_swaps(self.items, time_s, config)
        self._update_gallery()
        kept = [row for row, one in enumerate(self.items) if not one.is_deleted(time_s)]
        self._keep(np.array(kept, int))

    def _verify_continuations(self, time_s: float, config: ReidentificationConfig) -> None:
        """End continuations of lost tracks by other people, whose appearance was unclear at first."""
        for one in list(self.items):
            found = one.continuation
            if found is None:
                continue
            is_same = is_same_again(one, found.lost, config)
            if one.id != found.lost.id:  # an exchange of identities has decided it
                one.continuation = None
            elif is_same is False:
                one.begin_again()
                self.items.append(found.lost)
                self.states = self.states.joined(found.last_seen)
                self.last_seen = self.last_seen.joined(found.last_seen)
            elif is_same or time_s - found.time_s > config.provisional_s:
                one.continuation = None

    def _reidentify(self, time_s: float, config: ReidentificationConfig) -> None:
        """Let new tracks continue lost ones, or confirm them as new people."""
        items = self.items
        fresh = [
            row
            for row, one in enumerate(items)
            if one.seen_s == time_s
            and (one.is_confirmed or one.has_enough_evidence())
            and time_s - one.confirmed_s <= config.revised_s
        ]
        lost = [row for row, one in enumerate(items) if one.is_lost(time_s, config.lost_s)]
        known = [] if self.gallery is None else self.gallery.absent({one.id for one in items})
        before: dict[int, int] = {}
        is_open = np.zeros(len(fresh), bool)
        if fresh and (lost or known):
            states = self.states.take(np.array(fresh, np.intp))
            found = Candidates.of(states, [items[row].colours for row in fresh])
            parts = [self.odds_of_lost(lost, found, time_s, config)] if lost else []
            parts += [self._odds_of_known(known, found, config)] if known else []
            odds = np.concatenate(parts)
            ids = [items[row].id for row in lost] + known
            excluded = [[number in items[row].not_ids for row in fresh] for number in ids]
            odds[np.array(excluded)] = -np.inf
            before, is_open = assign_lost(odds), odds.max(axis=0) > -config.unclear
        for number, row in enumerate(fresh):
            one = items[row]
            if number in before:
                self._continue(one, before[number], lost, known, time_s)
            elif not one.is_confirmed and not (is_open[number] and time_s - one.born_s < config.undecided_s):
                self._confirm(one, time_s)

    def _odds_of_known(
        self, known: Sequence[int], found: Candidates, config: ReidentificationConfig
    ) -> Floats:
        """Return the log-odds (G, M) that people who are found are those of the gallery.

        A detection that resembles several people of the gallery is none of them.
        """
        assert self.gallery is not None
        odds = known_person_log_odds(self.gallery.candidates(known), found, config)
        share = np.exp(odds)
        return np.asarray(odds - np.log1p(share.sum(axis=0) - share))

    def _continue(
        self, one: TrackState, before: int, lost: Sequence[int], known: Sequence[int], time_s: float
    ) -> None:
        """Let a new track continue a lost track or, after all of these, a person of the gallery."""
        if self.gallery is not None and one.is_confirmed:
            self.gallery.people.pop(one.id, None)  # it was not a new person
        if before < len(lost):
            row = lost[before]
            last_seen = self.last_seen.take(np.array([row]))
            one.continuation = Continuation(replace(self.items[row], continuation=None), last_seen, time_s)
            one.inherit(self.items[row])
        elif self.gallery is not None:
            number = known[before - len(lost)]
            one.recognise(number, self.gallery.people[number].colours)

    def _update_gallery(self) -> None:
        """Keep what is known of each person whose track is neither brief nor without colours."""
        if self.gallery is None:
            return
        for one, mean, covariance in zip(
            self.items, self.last_seen.mean, self.last_seen.covariance, strict=True
        ):
            if (
                one.continuation is None
                and one.is_confirmed
                and one.watched_s > one.existence.brief_s
                and one.colours.any()
            ):
                known = KnownPerson(one.colours, float(mean[6]), float(covariance[6, 6]))
                self.gallery.people[one.id] = known

    def _confirm(self, one: TrackState, time_s: float) -> None:
        one.id = next(self._ids) if self.gallery is None else self.gallery.take_id()
        one.confirmed_s = time_s
        one.log_odds = max(one.log_odds, one.existence.confirmed)

    def _keep(self, rows: NDArray[np.intp]) -> None:
        self.states, self.last_seen = self.states.take(rows), self.last_seen.take(rows)
        self.items = [self.items[row] for row in rows]
