"""Comparison with other trackers on the same frames: OpenCV's detectors with ByteTrack and SORT."""
