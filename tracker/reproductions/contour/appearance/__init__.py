"""Appearance of people: colours of head, torso and legs, compared from frame to frame."""
