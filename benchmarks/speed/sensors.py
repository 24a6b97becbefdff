"""`python -m benchmarks.speed.sensors`: CPU time per image of sensors and detectors, compared with a peer.

Times are medians. The peer is OpenCV's HOG, or for the panorama the thermal camera.
"""

from collections.abc import Iterator
from functools import partial

import click
import cv2
import numpy as np

from benchmarks import call
from benchmarks.compare import Turns, spent_ms, timed_ms
from peopleboy.random_streams import stream
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.random_worlds.random_world import random_scenario
from peopleboy.scenarios.running.blind_drive import blind_drive
from peopleboy.sim.cameras.camera_config import DepthConfig, calibrations_of
from peopleboy.sim.cameras.depth import structured_light
from peopleboy.sim.world import SimulatedWorld
from peopleboy.tracker.camera_mount import mount_of
from peopleboy.tracker.frame import DEPTH, DEPTH_COLOUR, PANORAMA, THERMAL, Frame, Odometry
from peopleboy.tracker.sensors.thermal.detector.detector import PeopleDetector
from peopleboy.tracker.trackers import make_tracker

CROWD = "crossing_4"
RGBD_SCENARIO = "crossing_3"  # three people in front of a standing robot
SHIFT_PX, SCALE = 4, 1.05  # the source's slowest and best sliding window (SA table 4.3)
WORLDS = (0, 1, 2, 3)
LASTS_S = 1.5  # duration of each world
COMPILED = 3  # instants after which all kernels are compiled
_RGBD_WARM_UP, _DETECTOR_WARM_UP = 20, 4  # images for warming up the trackers
_SLIDE_EVERY = 6  # images; a slow sliding window is timed less often
_TWICE = 2.0  # enlargement: OpenCV's detector finds people from about 96 px, in this image 48 px


def _hog() -> cv2.HOGDescriptor:
    cv2.setNumThreads(1)
    hog = cv2.HOGDescriptor()
    hog.setSVMDetector(cv2.HOGDescriptor.getDefaultPeopleDetector())
    return hog


def depth(instants: int = 30) -> Iterator[str]:
    """Compare a depth camera with HOG on its colour image: view, depth and colour, and noise alone."""
    config = load_scenario(CROWD).mounting((DEPTH,)).world(seed=0)
    camera, rng, hog = config.robot.cameras[DEPTH], stream(0, "benchmark"), _hog()
    assert isinstance(camera, DepthConfig)
    turns = Turns()
    with SimulatedWorld(config) as world:
        for number in range(instants + COMPILED):
            world.step(0.0, 0.0)
            images = world.observe().images
            view_ms = spent_ms(partial(world._see, camera))
            whole_ms = view_ms + spent_ms(partial(images.__getitem__, DEPTH))
            noise_ms = spent_ms(partial(structured_light, world._see(camera).view, camera, rng))
            hog_ms = spent_ms(partial(hog.detectMultiScale, images[DEPTH_COLOUR]))
            if number >= COMPILED:
                turns.add(
                    {"HOG": hog_ms, "view": view_ms, "view, depth and colour": whole_ms, "noise": noise_ms}
                )
    yield f"HOG: {turns.median('HOG'):.1f} ms"
    for name in ("view", "view, depth and colour", "noise"):
        cost_ms = turns.median(name)
        yield f"{name}: {cost_ms:.2f} ms, {cost_ms / turns.median('HOG'):.3f} of HOG"


def panorama(instants: int = 60) -> Iterator[str]:
    """Compare the view and truth of a panorama with those of the thermal camera."""
    config = load_scenario(CROWD).mounting((PANORAMA,)).world(seed=0)
    truths, whole = Turns(), Turns()
    with SimulatedWorld(config) as world:
        for number in range(instants + COMPILED):
            world.step(0.0, 0.0)
            images = world.observe().images
            times = {}
            for name in (THERMAL, PANORAMA):
                truth_ms = spent_ms(partial(world.truth, name))
                times[name] = truth_ms, truth_ms + spent_ms(partial(images.__getitem__, name))
            if number >= COMPILED:
                truths.add({name: pair[0] for name, pair in times.items()})
                whole.add({name: pair[1] for name, pair in times.items()})
    for name, turns in (("view and truth", truths), ("with image", whole)):
        one_ms, round_ms = turns.median(THERMAL), turns.median(PANORAMA)
        yield (f"{name}: thermal {one_ms:.2f} ms, panorama {round_ms:.2f} ms, {round_ms / one_ms:.2f} times")


def rgbd(instants: int = 60) -> Iterator[str]:
    """Compare the RGB-D tracker with HOG, and with HOG at the source's step and scale."""
    scenario = load_scenario(RGBD_SCENARIO).mounting((DEPTH,))
    calibrations = calibrations_of(scenario.world(0).robot.cameras)
    tracker, hog, turns, counts = make_tracker("rgbd"), _hog(), Turns(), []
    for number, (_, seen) in enumerate(blind_drive(scenario, 0)):
        if number >= _RGBD_WARM_UP + instants:
            break
        images = {name: seen.images[name] for name in (DEPTH, DEPTH_COLOUR)}
        frame = Frame(images=images, time_s=seen.time_s, calibrations=calibrations)
        tracker_ms, tracks = timed_ms(partial(tracker.update, frame))
        if number >= _RGBD_WARM_UP:
            search = partial(hog.detectMultiScale, images[DEPTH_COLOUR])
            slide = partial(search, winStride=(SHIFT_PX, SHIFT_PX), scale=SCALE)
            hog_ms, slid_ms = spent_ms(search), spent_ms(slide) if number % _SLIDE_EVERY == 0 else np.nan
            turns.add({"rgbd": tracker_ms, "HOG": hog_ms, "slid": slid_ms})
            counts.append(len(tracks))
    rgbd_ms, hog_ms, slid_ms = map(turns.median, ("rgbd", "HOG", "slid"))
    yield f"HOG: {hog_ms:.1f} ms; shift {SHIFT_PX} px, scale {SCALE}: {slid_ms:.0f} ms"
    yield (
        f"rgbd, {np.mean(counts):.1f} people: {rgbd_ms:.1f} ms, {rgbd_ms / hog_ms:.2f} of HOG; "
        f"slid: {slid_ms / rgbd_ms:.0f}x"
    )


def detector() -> Iterator[str]:
    """Compare the thermal detector, with and without a known mount, with HOG on images of twice the size."""
    hog, turns = _hog(), Turns()
    for seed in WORLDS:
        scenario = random_scenario(seed, LASTS_S)
        calibration = calibrations_of(scenario.world(seed).robot.cameras).get(THERMAL)
        known, unknown = PeopleDetector(), PeopleDetector()
        for number, (_, seen) in enumerate(blind_drive(scenario, seed)):
            grey, time_s = seen.images[THERMAL].copy(), seen.time_s
            larger = cv2.resize(grey, None, fx=_TWICE, fy=_TWICE)
            mount = mount_of(calibration, len(grey))
            search = partial(hog.detectMultiScale, larger, winStride=(8, 8), padding=(16, 16), scale=1.07)
            (turns if number >= _DETECTOR_WARM_UP else Turns()).measure(
                {
                    "known": partial(known.update, grey, time_s, Odometry(), mount),
                    "unknown": partial(unknown.update, grey, time_s),
                    "HOG": search,
                }
            )
    known_ms, unknown_ms, hog_ms = map(turns.median, ("known", "unknown", "HOG"))
    yield (
        f"mount known {known_ms:.1f} ms, unknown {unknown_ms:.1f} ms; HOG {hog_ms:.1f} ms, "
        f"{hog_ms / known_ms:.0f} and {hog_ms / unknown_ms:.0f} times as long"
    )


SENSORS = {"depth": depth, "panorama": panorama, "rgbd": rgbd, "detector": detector}
"""The measurements by name."""


@click.command()
@click.argument("sensor", type=click.Choice(tuple(SENSORS)))
def main(sensor: str) -> None:
    """Print the CPU time per image of SENSOR, compared with its peer."""
    for line in SENSORS[sensor]():
        click.echo(line)


if __name__ == "__main__":
    call(main, "benchmarks.speed.sensors")
