"""Records of drives, of which a test says what it is about."""

import numpy as np

from peopleboy.scenarios.scores.drive_record import DriveRecord


def made_drive(time_s, robot, **more):
    """A robot at these times and poses, which touched nothing, in a place without people."""
    frames = len(time_s)
    usual = {
        "speed_m_s": np.zeros(frames),
        "is_contact": np.zeros(frames, bool),
        "target": np.full((frames, 2), np.nan),
        "track": np.zeros(frames, np.int64),
        "is_wrong": None,
        "count": np.zeros(frames, np.int64),
        "people": np.zeros((0, 4)),
    }
    return DriveRecord(time_s=time_s, robot=robot, **(usual | more))
