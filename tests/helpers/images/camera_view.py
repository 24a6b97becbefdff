"""What a camera at the origin sees of parts that lie there, too, for tests of what forms images."""

from typing import Any

import numpy as np

from peopleboy.sim.cameras.imaging.camera_view import CameraView, MaterialTable
from peopleboy.sim.rendering.view import View


def camera_view(view: View, materials: MaterialTable, **more: Any) -> CameraView:
    usual = {"surroundings_c": 21.0, "light_level": 1.0, "turn_rad_s": 0.0, "time_s": 0.0}
    poses = np.tile(np.eye(4), (len(materials.thermal), 1, 1))
    return CameraView(
        view=view,
        draw=lambda _: view,
        world_from_camera=np.eye(4),
        world_from_part=poses,
        materials=materials,
        **usual | more,
    )
