"""Prediction of where people walk, on unseen scenes."""
