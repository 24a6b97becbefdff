"""Draw all pictures, or the named ones, into docs/pictures."""

from __future__ import annotations

import sys
from collections.abc import Callable, Mapping
from pathlib import Path

from matplotlib.figure import Figure
from PIL.Image import Image

from docs.generate.pictures import (
    all_round,
    attention,
    core,
    depth,
    occlusion,
    panorama,
    rays,
    rgbd,
    scene_model,
    thermal,
    tracker,
)
from docs.generate.pictures.front import runs
from docs.generate.pictures.paper import COLOURS, save
from docs.generate.pictures.worlds import detections, failures, hard_scenes, light, reactions, skins
from peopleboy.studies.reproductions.pictures.panoramic_figures import draw_features
from peopleboy.studies.reproductions.pictures.situation_figures import draw_part_scores

FOLDER = Path(__file__).parents[2] / "pictures"

PICTURES: Mapping[str, Callable[[], Figure | Image]] = {
    "first_run": runs.first_run,
    "my_scene": runs.my_scene,
    "thermal_steps": thermal.steps,
    "thermal_bars": thermal.bars,
    "thermal_mirror": thermal.mirror,
    "thermal_gains": thermal.gains,
    "thermal_faults": thermal.faults,
    "people_finely": thermal.finely,
    "light": light.light,
    "skins": skins.skins,
    "equipment": skins.equipment,
    "people_at_distances": skins.distances,
    "hard_scenes": hard_scenes.hard_scenes,
    "failures": failures.failures,
    "rays": rays.layers,
    "silhouettes": rays.silhouettes,
    "panorama": panorama.raw_and_unrolled,
    "depth": depth.scales,
    "moved": depth.moved,
    "rgbd": rgbd.steps,
    "scene_model": scene_model.scenes,
    "reactions": reactions.reactions,
    "panoramic_features": draw_features,
    "panoramic_errors": panorama.errors_over_distance,
    "attention": attention.absence,
    "attention_parts": draw_part_scores,
    "all_round": all_round.all_round,
    "handed_over": all_round.handed_over,
    "detections": detections.detections,
    "one_frame": core.one_frame,
    "detector": tracker.detector,
    "contour": tracker.contour,
    "explained_away": occlusion.explained_away,
    "walking_on": occlusion.walking_on,
    "timeline": occlusion.timeline,
}

# Pictures for which fewer colours are sufficient.
FEWER_COLOURS = {
    "first_run": 80,
    "panorama": 96,
    "scene_model": 192,
    "failures": 48,
    "skins": 48,
    "equipment": 40,
    "people_at_distances": 64,
}

for name in sys.argv[1:] or PICTURES:
    print(save(PICTURES[name](), FOLDER / f"{name}.png", FEWER_COLOURS.get(name, COLOURS)))
