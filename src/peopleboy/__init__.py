"""A robot testbed in simulation: thermal and colour cameras among walking people, with exact truth."""

from peopleboy.registration import register_environments

register_environments()
