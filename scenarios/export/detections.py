"""Detections of PeopleBoy's detector in the images of a thermal camera, as MOTChallenge text."""

import math
from collections.abc import Callable
from pathlib import Path

import cv2
import numpy as np

from peopleboy.geometry.pose2 import Pose2
from peopleboy.scenarios.export.replay import OneCamera
from peopleboy.scenarios.run_folder.run_tables import odometry_pose
from peopleboy.sim.cameras.camera_config import calibrations_of
from peopleboy.tracker.camera_mount import mount_of
from peopleboy.tracker.detector.detector import PeopleDetector
from peopleboy.tracker.evaluation.mot_files import detection_line
from peopleboy.tracker.frame import Odometry
from peopleboy.tracker.tracking.config import ExistenceConfig


def detections_text(shots: OneCamera, image_path: Callable[[int], Path]) -> str:
    """Return one line for each detection in a camera's images, with probabilities as scores.

    Each image is searched as a whole, without tracks. As in the tracker `detection`, the detector also uses
    the change since an image 0.2 s before, and the odometry.

    Args:
        shots: the camera and its run.
        image_path: returns the file of an image from its number, from 1.
    """
    run, lines = shots.run, list[str]()
    detector = PeopleDetector(least_score=ExistenceConfig().weakest)
    calibration = calibrations_of(run.robot.cameras)[shots.name]
    before: Pose2 | None = None
    for row in run.files().robot.to_pylist():
        if row["frame"] not in shots.frames:
            continue
        number, now = shots.number(row["frame"]), odometry_pose(row)
        grey = np.asarray(cv2.imread(str(image_path(number)), cv2.IMREAD_GRAYSCALE), np.uint8)
        moved = None if before is None else Odometry.between(before, now)
        found = detector.update(grey, row["time_s"], moved, mount_of(calibration, grey.shape[0]))
        lines += [
            detection_line(number, box, 1.0 / (1.0 + math.exp(-score)))
            for box, score in zip(found.box.tolist(), found.score.tolist(), strict=True)
        ]
        before = now
    return "".join(lines)
