"""Analyse a run: occlusions, track losses, identity changes and their causes."""
