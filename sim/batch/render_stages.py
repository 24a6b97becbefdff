"""Render stages, which render the images of one camera for several worlds at a time."""

from collections.abc import Callable, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.batch.image_kernels import (
    ColourResponse,
    Detectors,
    JoinedScene,
    KernelCamera,
    Poses,
    RadianceTables,
    ViewBatch,
    detect_thermal,
    render_colour,
    render_radiance,
)
from peopleboy.sim.cameras.camera_config import CameraConfig, ColourConfig, ThermalConfig
from peopleboy.sim.cameras.colour import GAMMA, LIGHT
from peopleboy.sim.cameras.imaging.blur import optics_blur_sheet, optics_margin, sweep_of_one_rad
from peopleboy.sim.cameras.imaging.noise import QUANTILES
from peopleboy.sim.cameras.imaging.surfaces import rays_through
from peopleboy.sim.cameras.sensors import ColourSensor, ThermalSensor
from peopleboy.sim.cameras.thermal import (
    BRIGHTEST,
    DIMMEST,
    HIGHEST_C,
    LOWEST_C,
    RADIANCE,
    TEMPERATURE,
    mirrored,
)
from peopleboy.sim.geometry.pinhole import Pinhole
from peopleboy.sim.rendering.render_canvas import Lens
from peopleboy.sim.shapes.shape_table import Numbers
from peopleboy.sim.world import SimulatedWorld, light_level

Images = tuple[NDArray[Any], ...]
Fill = Callable[[int, int], None]  # fills the rows from one to before another

_TABLES = RadianceTables(RADIANCE, (LOWEST_C, HIGHEST_C), TEMPERATURE, (DIMMEST, BRIGHTEST))


class RenderStage(Protocol):
    """One camera, the same in B worlds."""

    def render(self, worlds: Numbers, poses: Poses) -> tuple[Images, Fill]:
        """Return buffers for the images of worlds (G,), and the tasks that fill them."""
        ...


class ThermalStage:
    """Renders the images of `ThermalSensor`, of a simple camera."""

    def __init__(
        self, name: str, config: ThermalConfig, scene: JoinedScene, worlds: Sequence[SimulatedWorld]
    ) -> None:
        self._name, self._config, self._scene, self._worlds = name, config, scene, tuple(worlds)
        self._camera = _kernel_camera(config.camera)
        self._surroundings = np.array([mirrored(world.config.place.surroundings_c) for world in worlds])
        sensors = [world.rig.sensor(name) for world in worlds]
        detectors = [sensor.detector for sensor in sensors if isinstance(sensor, ThermalSensor)]
        self._detectors = Detectors(
            offset_k=np.stack([each.offset_k for each in detectors]),
            dead=np.stack([each.dead for each in detectors]),
            dead_c=np.float32(detectors[0].dead_c),
            netd_k=np.float32(config.netd_k),
            lowest_c=np.float32(config.lowest_c),
            grey_per_k=np.float32(255.0 / (config.highest_c - config.lowest_c)),
            quantiles=QUANTILES,
        )

    def render(self, worlds: Numbers, poses: Poses) -> tuple[Images, Fill]:
        """See `RenderStage.render`; of greys and temperatures [degC], (G, H, W)."""
        shape = (len(worlds), self._config.camera.height, self._config.camera.width)
        temperature_c, grey = np.empty(shape, np.float32), np.empty(shape, np.uint8)
        surroundings, blur_px = self._surroundings[worlds], self._config.blur_px
        margin = optics_margin(blur_px)
        sensors = [_thermal(self._worlds[number], self._name) for number in worlds.tolist()]
        views = ViewBatch(worlds, self._scene, poses, self._camera)

        def fill(first: int, end: int) -> None:
            words = np.stack([sensor.draw_noise() for sensor in sensors[first:end]])
            sheet = np.empty((end - first, shape[1] + 2 * margin, shape[2]), np.float32)
            render_radiance(first, end, views, _TABLES, surroundings, margin, sheet)
            sheet = optics_blur_sheet(sheet, blur_px)
            detect_thermal(
                first, end, views, _TABLES, self._detectors, margin, sheet, words, temperature_c, grey
            )

        return (grey, temperature_c), fill


class ColourStage:
    """Renders the images of `ColourSensor`."""

    def __init__(
        self, name: str, config: ColourConfig, scene: JoinedScene, worlds: Sequence[SimulatedWorld]
    ) -> None:
        self._name, self._config, self._scene, self._worlds = name, config, scene, tuple(worlds)
        self._camera = _kernel_camera(config.camera)
        self._response = ColourResponse(
            np.float32(config.read_noise), np.float32(config.shot_noise), QUANTILES, LIGHT, GAMMA
        )

    def render(self, worlds: Numbers, poses: Poses) -> tuple[Images, Fill]:
        """See `RenderStage.render`; of (G, H, W, 3) sRGB."""
        image = np.empty((len(worlds), self._config.camera.height, self._config.camera.width, 3), np.uint8)
        own = [self._worlds[number] for number in worlds.tolist()]
        sensors = [_colour(world, self._name) for world in own]
        views = ViewBatch(worlds, self._scene, poses, self._camera)
        level = np.array([light_level(each.config.place, each.time_s) * self._config.gain for each in own])

        def fill(first: int, end: int) -> None:
            words = np.stack([sensor.draw_noise() for sensor in sensors[first:end]])
            render_colour(first, end, views, self._response, level, words, image)

        return (image,), fill


def make_stage(
    name: str, config: CameraConfig, scene: JoinedScene, worlds: Sequence[SimulatedWorld]
) -> RenderStage:
    """Make the render stage of a camera that `has_stage`."""
    if isinstance(config, ThermalConfig):
        return ThermalStage(name, config, scene, worlds)
    assert isinstance(config, ColourConfig)
    return ColourStage(name, config, scene, worlds)


def has_stage(config: CameraConfig) -> bool:
    """Return whether there is a render stage for a camera's images."""
    if not isinstance(config.camera, Pinhole):
        return False
    return isinstance(config, ColourConfig) or (isinstance(config, ThermalConfig) and config.is_simple)


def _kernel_camera(camera: Pinhole) -> KernelCamera:
    lens = Lens(camera.focal_px, *camera.centre_px, camera.width, camera.height)
    return KernelCamera(lens, rays_through(camera), sweep_of_one_rad(camera))


def _thermal(world: SimulatedWorld, name: str) -> ThermalSensor:
    sensor = world.rig.take_over(name)
    assert isinstance(sensor, ThermalSensor)
    return sensor


def _colour(world: SimulatedWorld, name: str) -> ColourSensor:
    sensor = world.rig.take_over(name)
    assert isinstance(sensor, ColourSensor)
    return sensor
