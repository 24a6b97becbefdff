"""Score finished runs from the files in their folders: in camera images, and on the floor.

Reference boxes depend on the camera, and on what the tracker's boxes enclose: torsos or whole people.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Final

from pydantic import Field

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.finished_run import cameras_of, incomplete, read_run
from peopleboy.scenarios.run_folder.run_files import (
    BELIEFS,
    PEOPLE,
    POSE,
    as_squares,
    check_end,
    check_robot,
    check_whole,
    is_on_floor_alone,
    places_of_people,
    places_of_tracks,
    read_table,
    true_boxes,
    truth_files,
)
from peopleboy.scenarios.run_folder.run_tables import ROBOT, TRACKS, TRUTH
from peopleboy.scenarios.scores.people_ranges import (
    OcclusionRange,
    PeopleRange,
    ReadOccluded,
    occluded_in,
)
from peopleboy.sim.geometry.panorama import around_px
from peopleboy.sim.world_config import CONTROL_HZ
from peopleboy.tracker.evaluation.evaluate import Scores, evaluate
from peopleboy.tracker.evaluation.latency import read_latency
from peopleboy.tracker.evaluation.mot_files import read_tracks
from peopleboy.tracker.evaluation.occlusion_scores import OccludedShares
from peopleboy.tracker.evaluation.protocols import RULES, Protocol, Surroundings, recount
from peopleboy.tracker.evaluation.sequence import TrackBoxes, TrueBoxes
from peopleboy.tracker.footage.box_kinds import BoxKind, width_per_height
from peopleboy.tracker.footage.footage_truth import GivenTruth, find_truth, load_truth
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.tracker_names import split_name
from peopleboy.tracker.trackers import TRACKERS

# Position between the widths of both kinds of ground truth boxes from which boxes count as the other kind.
# Trackers of torsos reach 0.45 in 210 runs, and 0.52 with wide ellipses.
_NEAR_OTHER: Final = 0.75
_LEAST_APART: Final = 0.1  # least difference of the log widths for a decision
_WIDEST: Final = 2.0  # widths of whole people; boxes of a tracker are never wider
CALLED: Final = {BoxKind.TORSO: "torsos", BoxKind.WHOLE: "whole people"}


@dataclass(frozen=True, slots=True)
class BoxReference:
    """The ground truth boxes that tracks are scored against.

    Attributes:
        camera: camera of the images.
        boxes: what the ground truth boxes enclose.
    """

    camera: str = THERMAL
    boxes: BoxKind = BoxKind.TORSO

    def __str__(self) -> str:
        """Return the reference as text."""
        return f"{CALLED[self.boxes]} in {self.camera} images"

    def to_json(self) -> dict[str, str]:
        """Return the reference as in metrics.json."""
        return {"camera": self.camera, "boxes": str(self.boxes)}


def read_reference_boxes(folder: Path, by: BoxReference) -> tuple[TrueBoxes, TrackBoxes]:
    """Read ground truth and tracked boxes of a run; in a panorama they extend across the seam.

    Raises:
        BadInput: there are no boxes in images of this camera, or a file is unreadable.
    """
    text, table = truth_files(folder, by.camera)
    if by.camera == THERMAL:
        return true_boxes(text, table, by.boxes), read_tracks(folder / "tracks.txt")
    cameras, given = cameras_of(folder), folder / "tracks" / f"{by.camera}.txt"
    if by.camera not in cameras:
        raise BadInput(f"{folder}: unknown camera {by.camera!r}; choose from {', '.join(cameras)}")
    for path in (text, given):
        if not path.is_file():
            raise BadInput(f"{path}: no such file; the tracker returned no boxes in camera {by.camera!r}")
    around = around_px(cameras[by.camera].camera)
    return replace(true_boxes(text, table, by.boxes), around_px=around), read_tracks(given)


def kind_of_boxes(folder: Path, camera: str, tracker: str | None, said: BoxKind) -> BoxKind:
    """Return what a tracker's boxes in a camera's images enclose, as stated for the run.

    PeopleBoy's own trackers are stated to enclose torsos, which holds in planar images; in panoramas their
    boxes enclose whole people.

    Args:
        folder: folder of the run.
        camera: name of the camera.
        tracker: name of the tracker; None for a tracker without a name.
        said: kind of boxes stated for the run.
    """
    if tracker is None or split_name(tracker)[0] not in TRACKERS.shipped or camera == THERMAL:
        return said
    config = cameras_of(folder).get(camera)
    is_round = config is not None and math.isfinite(around_px(config.camera))
    return BoxKind.WHOLE if is_round else said


def own_camera(folder: Path) -> str:
    """Return the camera by which a run is scored: `thermal`, or the only camera with boxes.

    A tracker without boxes in `thermal`, but with floor positions, is scored on the floor.
    """
    cameras = boxed_cameras(folder)
    if THERMAL in cameras or len(cameras) != 1:
        return THERMAL
    beliefs = read_table(folder / "tracks.parquet", TRACKS, BELIEFS)
    return THERMAL if is_on_floor_alone(beliefs) else cameras[0]


def boxed_cameras(folder: Path) -> tuple[str, ...]:
    """Return the cameras in whose images the tracker of a run has boxes."""
    further = sorted((folder / "tracks").glob("*.txt"))
    named = [(THERMAL, folder / "tracks.txt"), *((path.stem, path) for path in further)]
    return tuple(camera for camera, path in named if path.is_file() and path.stat().st_size)


def notes_on(folder: Path, by: BoxReference, truth: TrueBoxes, tracks: TrackBoxes) -> tuple[str, ...]:
    """Return notes if the boxes are in another camera's images, or of another kind, than expected."""
    cameras = boxed_cameras(folder)
    if not cameras:
        return ()
    where = ", ".join(cameras)
    if by.camera not in cameras:
        return (f"all boxes are in images of {where}; evaluate RUN --camera {cameras[0]} scores them there",)
    away = f"all boxes are in images of {where}, and scored there; behaviours use thermal boxes only"
    return tuple(
        note
        for note in (away if THERMAL not in cameras else "", _of_other_kind(folder, by, truth, tracks))
        if note
    )


def _of_other_kind(folder: Path, by: BoxReference, truth: TrueBoxes, tracks: TrackBoxes) -> str:
    """Return a note if boxes are wider than people, or about as wide as ground truth of the other kind."""
    other = BoxKind.TORSO if by.boxes is BoxKind.WHOLE else BoxKind.WHOLE
    there = true_boxes(*truth_files(folder, by.camera), other)
    given, wide, elsewhere = (width_per_height(rows) for rows in (tracks, truth, there))
    if not all(one > 0.0 for one in (given, wide, elsewhere)):
        return ""
    if given > _WIDEST * max(wide, elsewhere):
        return (
            f"boxes are {given:.2f} as wide as high, and whole people {max(wide, elsewhere):.2f}; "
            "boxes must be left, top, width and height, not corners"
        )
    if abs(math.log(elsewhere / wide)) < _LEAST_APART:
        return ""
    if math.log(given / wide) / math.log(elsewhere / wide) < _NEAR_OTHER:
        return ""
    return (
        f"boxes are {given:.2f} as wide as high, ground truth {CALLED[by.boxes]} {wide:.2f}, "
        f"{CALLED[other]} {elsewhere:.2f}; --boxes {other} scores them against {CALLED[other]}"
    )


@dataclass(frozen=True, slots=True, eq=False)
class ScoredPeople:
    """Scores of tracking people, and their reference.

    Attributes:
        scores: the scores.
        by: ground truth boxes of the scores; None for squares on the floor, and for footage.
        notes: caveats of the scores, one line each.
    """

    scores: Scores
    by: BoxReference | None = None
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True, kw_only=True)
class ScoreOptions:
    """People and boxes that are scored; positions on the floor are scored with thermal boxes."""

    protocol: Annotated[
        Protocol | None,
        Field(
            description="Which people are scored: as in a benchmark, or peopleboy, which ignores people "
            "who are fully occluded.  [default: peopleboy for rendered runs, else the benchmark of the "
            "ground-truth file, or mot17 if unknown]"
        ),
    ] = None
    min_visible: Annotated[
        float | None,
        Field(
            ge=0.0,
            lt=1.0,
            description="Score only people with more than this visible fraction. For example, 0.3 "
            "excludes slivers at the image border.  [default: 0 with peopleboy; benchmarks score all]",
        ),
    ] = None
    camera: Annotated[
        str | None,
        Field(
            description="Camera whose boxes are scored.  [default: thermal, or the only camera that has "
            "boxes]"
        ),
    ] = None
    boxes: Annotated[
        BoxKind | None,
        Field(
            description="Ground-truth boxes to score against: torso or whole person.  [default: the kind "
            "that each run was scored against]"
        ),
    ] = None
    people_range: PeopleRange | None = None

    def least_visible(self, protocol: Protocol) -> float | None:
        """Return the visible fraction up to which people are ignored; None if all are scored."""
        return RULES[protocol].min_visible if self.min_visible is None else self.min_visible


_DEFAULT: Final = ScoreOptions()


def score_people(
    folder: Path,
    held: tuple[TrueBoxes, TrackBoxes],
    frames: int,
    by: BoxReference,
    options: ScoreOptions = _DEFAULT,
) -> ScoredPeople:
    """Score the tracks of a run: their boxes in a camera's image, and their positions on the floor.

    Boxes are scored in frames with an image of the camera, as others have no ground truth. Positions are
    scored together with thermal boxes. A tracker without thermal boxes, but with positions, is scored on the
    floor alone: people and tracks are squares there (`floor_squares`), and all box metrics refer to squares.

    Args:
        folder: folder of the run, with its tables.
        held: `read_reference_boxes` of the run: ground truth boxes, and the tracker's boxes.
        frames: number of frames.
        by: the ground truth boxes to score against.
        options: which people are scored.

    Raises:
        BadInput: a table is missing or unreadable.
    """
    truth, tracks = held
    protocol = options.protocol or Protocol.PEOPLEBOY
    min_visible = options.least_visible(protocol)

    def recounted(truth: TrueBoxes, every: int = 1) -> tuple[TrueBoxes, Surroundings]:
        counted, around = recount(truth, protocol)
        return _in_range(counted, options, lambda: occluded_in(folder, by.camera, truth, every)), around

    if by.camera != THERMAL:
        every = CONTROL_HZ // (cameras_of(folder)[by.camera].rate_hz or CONTROL_HZ)
        tracks = tracks.take((tracks.frame - 1) % every == 0)
        counted, around = recounted(truth, every)
        scores = evaluate(counted, tracks, frames=frames, min_visible=min_visible, around=around)
        images = replace(scores.counts, frames=len(range(0, frames, every)))
        return ScoredPeople(replace(scores, counts=images), by, notes_on(folder, by, truth, tracks))
    robot = read_table(folder / "robot.parquet", ROBOT, POSE)
    check_robot(folder, robot, frames)
    people = read_table(folder / "truth.parquet", TRUTH, PEOPLE)
    beliefs = read_table(folder / "tracks.parquet", TRACKS, BELIEFS)
    is_on_floor = is_on_floor_alone(beliefs)
    if is_on_floor:
        truth, tracks = as_squares(folder, people, beliefs, robot)
    counted, around = recounted(truth)
    scores = evaluate(
        counted,
        tracks,
        frames=frames,
        min_visible=min_visible,
        around=around,
        standing=places_of_people(people, robot),
        believed=places_of_tracks(beliefs),
    )
    if is_on_floor:
        return ScoredPeople(scores)
    return ScoredPeople(scores, by, notes_on(folder, by, truth, tracks))


def evaluate_files(
    truth: Path,
    tracks: Path,
    frames: int | None = None,
    min_visible: float | None = None,
    protocol: Protocol | None = None,
    note: Callable[[str], None] = lambda _: None,
    people_range: PeopleRange | None = None,
) -> Scores:
    """Score MOTChallenge or KITTI tracks against ground truth in any supported format of footage.

    By default, the people are scored that the truth's benchmark scores; `protocol` chooses another one.
    People with at most the visible fraction min_visible, and those outside the range, are ignored. Metrics
    that need all people are undefined if the ground truth annotates one person only. `note` receives
    assumptions about the input.
    """
    given = load_truth(truth, None, protocol=protocol, tracks=tracks)
    for text in given.notes:
        note(text)
    if isinstance(people_range, OcclusionRange):
        raise BadInput("--per occlusion-time: files do not state their frame rate; give folders of runs")
    options = ScoreOptions(protocol=protocol, min_visible=min_visible, people_range=people_range)
    return _score(given, read_tracks(tracks), frames, options)


def evaluate_runs(folders: Sequence[Path], options: ScoreOptions | None = None) -> list[ScoredPeople]:
    """Score the runs in these folders, one by one.

    Raises:
        BadInput: a folder holds no run, or one whose files do not belong together, or one of footage without
            truth.
    """
    return [_evaluate_run(folder, options or ScoreOptions()) for folder in folders]


def _evaluate_run(folder: Path, options: ScoreOptions) -> ScoredPeople:
    about = read_run(folder)
    people = _evaluate_opened(folder, about, options)
    people = replace(people, scores=replace(people.scores, latency=read_latency(folder)))
    note = incomplete(about)
    return replace(people, notes=(*people.notes, note)) if note else people


def _evaluate_opened(folder: Path, about: Mapping[str, Any], options: ScoreOptions) -> ScoredPeople:
    if "footage" in about or not (folder / "truth.parquet").is_file():
        return _evaluate_texts(folder, about, options)
    by = reference_of(folder, about, options)
    if by == BoxReference():
        given, found = _read_texts(folder, about["frames"])
        held = (given.truth, found)
    else:
        held = read_reference_boxes(folder, by)
    return score_people(folder, held, about["frames"], by, options)


def reference_of(folder: Path, about: Mapping[str, Any], options: ScoreOptions) -> BoxReference:
    """Return the ground truth boxes to score a run against, given the contents of its run.json."""
    camera = options.camera or own_camera(folder)
    return BoxReference(camera, options.boxes or _said(folder, camera, about))


def _in_range(truth: TrueBoxes, options: ScoreOptions, occluded: ReadOccluded) -> TrueBoxes:
    """Return the truth, in which only people in the range are counted, if there is a range."""
    return truth if options.people_range is None else options.people_range.take(truth, occluded)


def _evaluate_texts(folder: Path, about: Mapping[str, Any], options: ScoreOptions) -> ScoredPeople:
    """Score a run of footage, which has one camera and boxes of one kind."""
    for option, value in (("--camera", options.camera), ("--boxes", options.boxes)):
        if value is not None and value != THERMAL:
            raise BadInput(f"{option} {value}: {folder} has no scenario tables; omit the option")
    frames, rate_hz = about["frames"], about.get("rate_hz", CONTROL_HZ)
    given, found = _read_texts(folder, frames, options.protocol)
    return ScoredPeople(_score(given, found, frames, options, rate_hz))


def _read_texts(folder: Path, frames: int, protocol: Protocol | None = None) -> tuple[GivenTruth, TrackBoxes]:
    truth = find_truth(folder)
    if truth is None:
        raise BadInput(f"{folder}: has no ground truth; give --truth with --tracks")
    given, found = load_truth(truth, None, protocol=protocol), read_tracks(folder / "tracks.txt")
    check_end(given.truth, truth, frames)
    check_end(found, folder / "tracks.txt", frames)
    check_whole(folder, given.truth, found)
    return given, found


def _said(folder: Path, camera: str, about: Mapping[str, Any]) -> BoxKind:
    """Return the kind of boxes a run was scored with; earlier versions do not state it, and used torsos."""
    said = about.get("boxes", BoxKind.TORSO)
    if said not in set(BoxKind):
        raise BadInput(
            f"{folder / 'run.json'}: boxes: must be {' or '.join(BoxKind)}, got {said!r}; run it again"
        )
    tracker = None if about.get("adopted") else about.get("tracker")
    return kind_of_boxes(folder, camera, tracker, BoxKind(said))


def _score(
    given: GivenTruth,
    found: TrackBoxes,
    frames: int | None,
    options: ScoreOptions = _DEFAULT,
    rate_hz: float = CONTROL_HZ,
) -> Scores:
    hidden = 1.0 - given.truth.visible  # the only occlusion that files state
    return evaluate(
        _in_range(given.truth, options, lambda: OccludedShares(hidden, rate_hz)),
        found,
        frames=frames,
        min_visible=options.least_visible(given.protocol),
        around=given.around,
        is_single=given.is_single,
    )
