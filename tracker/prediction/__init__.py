"""Prediction: where tracked people will be in the next seconds, from their tracks alone."""
