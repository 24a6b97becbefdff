"""The detector's networks fine-tuned on other real clips: how much better real training images would be.

The cascade stays that of the shipped detector. The networks are only used here, and never shipped.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any, Final

import numpy as np

from benchmarks.footage.real_clips import ClipResult, RealClip, run_clip
from benchmarks.peers.ours import Ours
from peopleboy.bad_input import BadInput
from peopleboy.scenarios.footage.options import DEFAULT_RATE_HZ, TrackOptions
from peopleboy.scenarios.footage.views import open_views
from peopleboy.scenarios.running.engine.task import ReportProgress, Workers
from peopleboy.studies.training.detector.augmentation import augment
from peopleboy.studies.training.detector.crop_samples import CropSamples, CropTraining, Version, fit_crops
from peopleboy.studies.training.detector.electronics import simulate_electronics
from peopleboy.studies.training.detector.train_box_refinement import BoxRefinementTraining
from peopleboy.studies.training.detector.train_rescoring import RescoringTraining
from peopleboy.studies.training.detector.world_sequences import ThermalImage
from peopleboy.studies.training.samples import SampleTask, Split, collect_missing
from peopleboy.tracker.camera_mount import Mount
from peopleboy.tracker.footage.box_kinds import person_of, torso_of
from peopleboy.tracker.frame import THERMAL
from peopleboy.tracker.networks.inference import CropNetwork
from peopleboy.tracker.sensors.thermal.detector.detector import PeopleDetector
from peopleboy.tracker.sensors.thermal.detector.image_change import PastImages
from peopleboy.tracker.sensors.thermal.people_finder import ThermalFinder
from peopleboy.tracker.sensors.thermal.scheduled_detector import ScheduledDetector
from peopleboy.tracker.sensors.thermal.thermal_sensor import ThermalSensor
from peopleboy.tracker.trackers import DEFAULT_TRACKER
from peopleboy.tracker.tracking.config import PeopleTrackerConfig
from peopleboy.tracker.tracking.people_tracker import PeopleTracker

NAME: Final = "detection, networks trained on the other clips"
_IMAGES: Final = 50  # per clip
_VERSIONS: Final = 4  # augmented versions of each image
_MOST_CROPS: Final = 1500  # per clip, so that crowds do not outweigh the other clips
_EPOCHS: Final = 2
_NOWHERE: Final = Mount(0.0, 1.0, 1.0)  # the mounts of clips are unknown, and not given to the networks
_TRAININGS: Final = (RescoringTraining(), BoxRefinementTraining())


@dataclass(frozen=True, slots=True, eq=False)
class RealTrainingTask:
    """Fine-tune the networks on some clips, and track the people of another one.

    Attributes:
        clip: the clip to track.
        others: names of the clips to train on.
        folder: folder of the samples of all clips.
        rate_hz: frame rate of the camera; None for the default of folders.
    """

    clip: RealClip
    others: Sequence[str]
    folder: Path
    rate_hz: float | None = None

    @property
    def name(self) -> str:
        """Name of clip and tracker."""
        return f"{self.clip.name}, {NAME}"

    @property
    def size(self) -> int:
        """Number of frames to track."""
        return self.clip.frames

    def __call__(self, report_progress: ReportProgress) -> ClipResult:
        """Train, then run the tracker from the first frame on."""
        rescoring, box_refinement = (self._fine_tuned(training) for training in _TRAININGS)
        config = PeopleTrackerConfig()
        detector = PeopleDetector(
            rescoring=rescoring, box_refinement=box_refinement, least_score=config.existence.weakest
        )
        sensor = ThermalSensor(config, ScheduledDetector(config, ThermalFinder(detector)))
        ours = Ours(PeopleTracker((sensor,), config), boxes_whole=True)
        return run_clip(self.clip, ours, DEFAULT_TRACKER, self.rate_hz, report_progress)

    def _fine_tuned(self, training: CropTraining) -> Any:
        network: type[CropNetwork] = training.NETWORK
        shipped = network.shipped()
        paths = [_path(self.folder, name, network) for name in self.others]
        samples = CropSamples.join([CropSamples.load(path) for path in paths])
        weights = fit_crops(
            network.ARCHITECTURE,
            training.loss,
            samples,
            epochs=_EPOCHS,
            dropout=training.DROPOUT,
            first=shipped.weights,
        )
        return network({**shipped.weights, **weights})


def _path(folder: Path, clip: str, network: type[CropNetwork]) -> Path:
    """Return the path of the samples of a clip for a network."""
    return folder / f"{clip}_{network.MODEL}.npz"


def _samples(clip: RealClip, training: CropTraining, rate_hz: float | None) -> CropSamples:
    """Return the samples of a clip."""
    rng = np.random.default_rng(0)
    size = training.NETWORK.ARCHITECTURE.crop
    parts = [CropSamples.empty(size, training.TARGETS)]
    for image in annotated_images(clip, _IMAGES, rate_hz):
        for _ in range(_VERSIONS):
            own = np.random.default_rng(rng.integers(2**63))
            varied = simulate_electronics(augment(image, own), own)
            parts.append(training.sample(Version(varied, None, own), augments=True))
    samples = CropSamples.join(parts)
    return samples.take(rng.permutation(len(samples))[:_MOST_CROPS])


def annotated_images(clip: RealClip, count: int, rate_hz: float | None = None) -> Iterator[ThermalImage]:
    """Yield images of a clip at equal distances, with the annotated people as upright and visible."""
    truth, past = clip.given.truth, PastImages()
    step = max(clip.frames // count, 1)
    options = TrackOptions(
        footage=clip.folder, out=Path(), tracker=DEFAULT_TRACKER, rate_hz=rate_hz or DEFAULT_RATE_HZ
    )
    for number, frame in enumerate(islice(open_views(options), clip.frames), start=1):
        grey = frame.grey(THERMAL)
        past.keep(grey, frame.time_s)
        if number % step:
            continue
        people = truth.take((truth.frame == number) & truth.counted)
        wholes = [tuple(box) for box in people.box.tolist()]
        every = np.ones(len(wholes), np.bool_)
        yield ThermalImage(
            grey=grey,
            change=past.change(),
            mount=_NOWHERE,
            box=np.array([torso_of(box) for box in wholes]).reshape(-1, 4),
            is_good=every,
            is_clear=every,
            whole=np.array([person_of(box) for box in wholes]).reshape(-1, 4),
            posture=np.zeros(len(wholes), np.int64),
            visible=every.astype(np.float64),
        )


def real_training_tasks(
    clips: Sequence[RealClip], rate_hz: float | None, folder: Path, workers: Workers
) -> list[RealTrainingTask]:
    """Collect the samples of all clips of which everybody is annotated, and return a task for each.

    Args:
        clips: the clips.
        rate_hz: frame rate of the cameras; None for the default of folders.
        folder: for the samples.
        workers: pool that collects them.

    Raises:
        BadInput: there are fewer than two such clips.
        TasksFailed: samples of some clips could not be collected.
    """
    usable = [clip for clip in clips if not clip.given.is_single]
    if len(usable) < 2:
        raise BadInput(
            f"--real-training: needs two or more clips with everybody annotated, got {len(usable)}"
        )
    collected = [
        SampleTask(_path(folder, clip.name, one.NETWORK), _samples, (clip, one, rate_hz))
        for clip in usable
        for one in _TRAININGS
    ]
    collect_missing(Split(collected, []), workers)
    names = [clip.name for clip in usable]
    return [
        RealTrainingTask(clip, [name for name in names if name != clip.name], folder, rate_hz)
        for clip in usable
    ]
