"""Data sets in the formats of hubs: labelled images, and episodes."""
