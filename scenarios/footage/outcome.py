"""What came of tracking footage, in words."""

from __future__ import annotations

from typing import Final

from peopleboy.scenarios.footage.options import RgbdOptions, TrackOptions
from peopleboy.scenarios.footage.track_footage import Tracked
from peopleboy.tracker.contour.variants import VARIANTS
from peopleboy.tracker.footage.box_kinds import BoxKind
from peopleboy.wording import counted

_ROUND: Final = {
    BoxKind.TORSO: ", boxes round torsos",
    BoxKind.WHOLE: ", boxes round whole people",
    None: "",
}


def outcome_lines(tracked: Tracked, options: TrackOptions) -> tuple[str, str]:
    """Say how much was tracked, and which files show it, or what to look at if nobody was found."""
    count = f"{counted(tracked.frames, 'frame')}, {counted(tracked.tracks, 'track')}{_ROUND[tracked.boxes]}"
    sheet = options.out / "contact_sheet.png"
    if not tracked.tracks:
        shown = f"Nobody was found. Look at {sheet}: {_what_to_look_at(options)}"
    elif options.film:
        shown = f"{sheet} and {options.out / 'overlay.mp4'} show them."
    else:
        shown = f"{sheet} shows them."
    return f"{count}, {tracked.per_second:.0f} frames/s", shown


def _what_to_look_at(options: TrackOptions) -> str:
    if options.rgbd is not None:
        return _what_depth_asks(options.rgbd)
    remedy = "leave --black-hot out" if options.radiometry.is_inverted else "give --black-hot"
    asked = f"is warm bright there? If not, {remedy}."
    if options.tracker in VARIANTS:
        asked += f" Are people {_heights(options.tracker)} of the picture's height, from head to feet?"
        if not options.radiometry.is_known:
            asked += " Are degC known? Then give --temperature-range (8 bit) or --scale (16 bit)."
    return f"{asked} Is their outline to be seen, or only a hot face?"


def _what_depth_asks(rgbd: RgbdOptions) -> str:
    camera = rgbd.camera
    return (
        f"was the camera {camera.height_m:g} m above the floor (--camera-height-m), and looked down by "
        f"{camera.pitch_deg:g} degrees (--pitch-deg)? Do people stand upright? Is depth read where they are?"
    )


def _heights(tracker: str) -> str:
    """Say which people this tracker looks for; one who fills more than the picture is not seen whole."""
    config = VARIANTS[tracker]
    low, high = (config.box.height_per_h * share for share in config.detector.limits.h)
    return f"at least {low:.0%}" if high >= 1 else f"{low:.0%} to {high:.0%}"
