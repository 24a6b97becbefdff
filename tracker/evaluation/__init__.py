"""Evaluation of trackers: thesis, paper and MOT metrics over boxes, from MOTChallenge files or arrays.

`evaluate.evaluate` combines the rest; nothing here depends on images or on a tracker.
"""
