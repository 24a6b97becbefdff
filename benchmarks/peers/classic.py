"""JPDA and MHT, which the thesis mentions, from the library Stone Soup, on the boxes of a detector.

JPDA: Bar-Shalom and Fortmann 1988. MHT: Reid 1979, here track-oriented, solved over a window of a few frames
by multi-frame assignment (Xia et al. 2019). Both have the same motion model, noise, and track initiation and
deletion.
"""

import warnings
from collections.abc import Iterable
from datetime import datetime, timedelta
from typing import Any, Final, Protocol

import numpy as np
from numpy.typing import NDArray

from benchmarks.peers.detectors import Boxes, PeerDetections
from peopleboy.tracker.frame import Frame

# Tuned in their favour, like those of the other peers, on crossing_2 and crossing_3.
_ACCELERATION: Final = 400.0  # [px^2/s^3] process noise of the velocity
_GROWTH: Final = 40.0  # [px^2/s] process noise of width and height
_NOISE_PX: Final = (4.0, 6.0, 4.0, 8.0)  # measurement noise of a box's centre and size
_SPEED_PX_S: Final = 60.0  # initial speed of a new track
_FOUND: Final = 0.9  # detection probability
_GATE: Final = 0.999
_CLUTTER: Final = 1e-9  # [1/px^4] density of false boxes over positions and sizes
_BIRTH_FRAMES: Final = 3
_LOST_FRAMES: Final = 75  # frames without detection after which a track is deleted: 5 s
_WINDOW: Final = 3  # frames over which the MHT defers decisions
_EPOCH: Final = datetime(2007, 1, 1)

_PLACES: Final = (0, 2, 4, 5)  # indices of x, y, width and height in the state x, vx, y, vy, w, h


class _Detector(Protocol):
    def detect(self, frame: Frame) -> PeerDetections: ...


class DetectAndFilter:
    """A detector, and a JPDA or MHT filter that uses only its boxes."""

    def __init__(self, detector: _Detector, *, is_joint: bool) -> None:
        """Build the filter.

        Args:
            detector: detector of people.
            is_joint: whether to use JPDA; else MHT.

        Raises:
            SystemExit: Stone Soup is missing.
        """
        self._detector = detector
        self._parts = _Parts()
        self._associate = self._parts.jpda() if is_joint else self._parts.mht()
        self._is_joint = is_joint
        self._initiator = self._parts.initiator()
        self._tracks: set[Any] = set()
        self._missed: dict[Any, int] = {}
        self._numbers: dict[str, int] = {}

    def step(self, frame: Frame) -> tuple[Boxes, list[int]]:
        """Detect, associate, and return the tracks that have a detection."""
        time = _EPOCH + timedelta(seconds=frame.time_s)
        found = set(self._parts.detections(self._detector.detect(frame).box, time))
        claimed = self._carry_on(found, time)
        self._tracks = {track for track in self._tracks if self._missed[track] <= _LOST_FRAMES}
        for track in self._initiator.initiate(found - claimed, time):
            self._tracks.add(track if self._is_joint else self._parts.as_mixture(track))
        shown = [track for track in self._tracks if self._missed.setdefault(track, 0) == 0]
        boxes = np.array([_box(_mean(track.state)) for track in shown]).reshape(-1, 4)
        return boxes, [self._numbers.setdefault(track.id, len(self._numbers) + 1) for track in shown]

    def _carry_on(self, found: set[Any], time: datetime) -> set[Any]:
        """Update all tracks, and return the associated detections."""
        claimed = set()
        with warnings.catch_warnings():
            # If the relaxed problem is infeasible, it solves the integer problem and prints a message.
            warnings.filterwarnings("ignore", "Infeasible primal problem")
            associated = self._associate.associate(self._tracks, found, time)
        for track, hypotheses in associated.items():
            best = max(hypotheses, key=self._chance)
            self._missed[track] = 0 if best else self._missed[track] + 1
            claimed |= {best.measurement} if best else set()
            track.append(self._parts.posterior(hypotheses, time, is_joint=self._is_joint))
        return claimed

    def _chance(self, hypothesis: Any) -> Any:
        return hypothesis.probability if self._is_joint else hypothesis.prediction.weight


class _Parts:
    """Models and associators of Stone Soup, which are imported only here."""

    def __init__(self) -> None:
        try:
            from stonesoup.models.measurement.linear import LinearGaussian
            from stonesoup.models.transition.linear import (
                CombinedLinearGaussianTransitionModel,
                ConstantVelocity,
                RandomWalk,
            )
            from stonesoup.predictor.kalman import KalmanPredictor
            from stonesoup.updater.kalman import KalmanUpdater
        except ImportError as error:
            message = "benchmarks.peers: Stone Soup is missing; pip install --group peers installs it"
            raise SystemExit(message) from error
        steps = [ConstantVelocity(_ACCELERATION)] * 2 + [RandomWalk(_GROWTH)] * 2
        self._measure = LinearGaussian(6, _PLACES, np.diag(np.square(_NOISE_PX)))
        self._predict = KalmanPredictor(CombinedLinearGaussianTransitionModel(steps))
        self._update = KalmanUpdater(self._measure)

    def detections(self, boxes: Boxes, time: datetime) -> Iterable[Any]:
        """Convert boxes (N, 4) to measurements of centre and size."""
        from stonesoup.types.detection import Detection

        for left, top, width, height in boxes.tolist():
            place = np.array([[left + width / 2.0], [top + height / 2.0], [width], [height]])
            yield Detection(place, timestamp=time, measurement_model=self._measure)

    def jpda(self) -> Any:
        """Return the joint probabilistic data association, with an efficient hypothesis tree."""
        from stonesoup.dataassociator.probability import JPDAwithEHM

        return JPDAwithEHM(self._chances())

    def mht(self) -> Any:
        """Return the multi-frame assignment."""
        from stonesoup.dataassociator.mfa import MFADataAssociator
        from stonesoup.hypothesiser.mfa import MFAHypothesiser

        return MFADataAssociator(MFAHypothesiser(self._chances()), slide_window=_WINDOW)

    def initiator(self) -> Any:
        """Return the track initiator: a number of detections, each the nearest to the previous one."""
        from stonesoup.dataassociator.neighbour import GNNWith2DAssignment
        from stonesoup.deleter.time import UpdateTimeStepsDeleter
        from stonesoup.hypothesiser.distance import DistanceHypothesiser
        from stonesoup.initiator.simple import MultiMeasurementInitiator
        from stonesoup.measures import Mahalanobis
        from stonesoup.types.state import GaussianState

        prior = GaussianState(np.zeros((6, 1)), np.diag([0.0, _SPEED_PX_S**2, 0.0, _SPEED_PX_S**2, 0.0, 0.0]))
        nearest = DistanceHypothesiser(self._predict, self._update, Mahalanobis(), missed_distance=4.0)
        return MultiMeasurementInitiator(
            prior,
            UpdateTimeStepsDeleter(_BIRTH_FRAMES),
            GNNWith2DAssignment(nearest),
            self._update,
            self._measure,
            min_points=_BIRTH_FRAMES,
        )

    def as_mixture(self, track: Any) -> Any:
        """Convert a new track to a mixture with one component, as MHT requires."""
        from stonesoup.types.mixture import GaussianMixture
        from stonesoup.types.numeric import Probability
        from stonesoup.types.state import TaggedWeightedGaussianState
        from stonesoup.types.track import Track

        now = track.state
        one = TaggedWeightedGaussianState(
            now.state_vector, now.covar, timestamp=now.timestamp, weight=Probability(1.0), tag=[]
        )
        return Track([GaussianMixture([one])])

    def posterior(self, hypotheses: Any, time: datetime, *, is_joint: bool) -> Any:
        """Return a track's state: one Gaussian for all hypotheses, or the mixture of the remaining ones."""
        from stonesoup.functions import gm_reduce_single
        from stonesoup.types.array import StateVectors
        from stonesoup.types.update import GaussianMixtureUpdate, GaussianStateUpdate

        states = [self._update.update(one) if one else one.prediction for one in hypotheses]
        if not is_joint:
            return GaussianMixtureUpdate(hypothesis=hypotheses, components=states)
        means = StateVectors([state.state_vector for state in states])
        covariances = np.stack([state.covar for state in states], axis=2)
        weights = np.asarray([one.probability for one in hypotheses])
        mean, covariance = gm_reduce_single(means, covariances, weights)
        return GaussianStateUpdate(mean, covariance, hypotheses, time)

    def _chances(self) -> Any:
        from stonesoup.hypothesiser.probability import PDAHypothesiser

        return PDAHypothesiser(
            self._predict, self._update, clutter_spatial_density=_CLUTTER, prob_detect=_FOUND, prob_gate=_GATE
        )


def _mean(state: Any) -> NDArray[np.float64]:
    """Return the mean (6,) of a Gaussian, or of the most likely component of a mixture."""
    components = getattr(state, "components", None)
    best = state if components is None else max(components, key=lambda one: one.weight)
    return np.asarray(best.state_vector, np.float64).reshape(-1)


def _box(mean: NDArray[np.float64]) -> tuple[float, float, float, float]:
    x, y, width, height = (float(mean[k]) for k in _PLACES)
    return x - width / 2.0, y - height / 2.0, width, height
