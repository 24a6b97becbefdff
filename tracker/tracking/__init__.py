"""Tracking by detection: a learned people detector and a Kalman filter, for any camera and any room."""
