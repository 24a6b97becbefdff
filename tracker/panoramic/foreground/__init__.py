"""Which pixels of the panorama are people, on a robot that may drive: a background, and what judges by it."""
