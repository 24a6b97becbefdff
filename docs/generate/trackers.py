"""The trackers, from the names that there are."""

from __future__ import annotations

from collections.abc import Mapping

from docs.generate.markdown import table
from peopleboy.tracker.trackers import TRACKERS

ABOUT: Mapping[str, tuple[str, str]] = {
    "detection": (
        "the default: any camera, any room, recorded video",
        "A detector that has seen nothing but rendered random worlds proposes people, and a Kalman filter in "
        "metres follows each. No temperature matters, only contrast; colours tell who came back.",
    ),
    "contour": (
        "thesis, chapters 4 to 7, and beyond",
        "Particles, contour, colour and thermal looks. People who overlap are sorted by depth, those in "
        "front are explained away, hidden people walk on. It knows how the robot moved.",
    ),
    "learned": (
        "the same, taught",
        "The same, but who is in front is told by the classifier that `peopleboy train-occlusion` learned.",
    ),
    "thesis": (
        "thesis, chapters 4 to 7",
        "As it is written: independent filters, colour moments, occlusion handling by a boosted classifier "
        "of who is in front.",
    ),
    "thermal": ("thesis, chapters 4 and 5", "Thermal image alone."),
    "colour": ("thesis, chapters 4 to 6", "With colour, without occlusion handling."),
    "paper": ("the 2005 paper", "Its measurement model, its 30 % best samples, three frames to detect."),
    "panoramic-paper": (
        "the 2003 paper",
        "One person all round a standing robot, by the panoramic camera alone: background subtraction, a "
        "network for the distance, which `peopleboy train-distance` trains, a Kalman filter on the floor.",
    ),
    "panoramic": (
        "the 2003 paper, and beyond",
        "Several people all round a robot that stands or drives, by the panoramic camera alone: a learned "
        "foreground, a learned reading of where people stand and how sure that is, colours by height.",
    ),
    "handover": (
        "thesis, section 8.2",
        "`contour` for what is warm ahead and `panoramic` for all round it, which point people out to each "
        "other: a person keeps one number from the thermal image through the panorama and back.",
    ),
    "rgbd": (
        "the situation-awareness thesis, chapter 4, and beyond",
        "People on the floor by a depth camera with colour, standing or driving: what has the size of a "
        "human and looks like one, and a particle filter for each of them.",
    ),
    "rgbd-printed": (
        "the situation-awareness thesis, chapter 4",
        "The same as it is printed, where it is.",
    ),
    "fused": (
        "both theses, and beyond",
        "`contour` and `rgbd` at once, and `panoramic` where that camera is mounted: thermal says warm, "
        "depth says where, colour says who. It goes on with the cameras that are left, and in the dark.",
    ),
    "attentive": (
        "the situation-awareness thesis, chapter 5, and beyond",
        "`contour`, which learns what everybody looks like, and gives who comes back the old number, "
        "however long the person was away; whoever is not known stays a stranger. A robot that follows "
        "searches on until it sees its person again.",
    ),
    "attentive-printed": (
        "the situation-awareness thesis, chapter 5",
        "The same, but people are known by the attention of that chapter as it is printed.",
    ),
    "attentive-fused": (
        "all of these",
        "`fused`, whose people are known again like those of `attentive`, by every camera of colours.",
    ),
}


def trackers() -> str:
    """List every tracker, what it follows, and what it is."""
    return table(("`--tracker`", "follows", "what it is"), [(f"`{name}`", *ABOUT[name]) for name in TRACKERS])
