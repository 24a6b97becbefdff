"""Other people's trackers on the same frames as ours: detectors of OpenCV with ByteTrack and SORT."""
