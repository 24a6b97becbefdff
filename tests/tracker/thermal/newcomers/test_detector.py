from dataclasses import replace

import numpy as np
import pytest

from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.thermal.contour.likelihood import ContourModel
from peopleboy.tracker.thermal.newcomers.detector import detected
from peopleboy.tracker.thermal.particle_filter import view_frame
from peopleboy.tracker.thermal.particles import X
from peopleboy.tracker.thermal.variants import PEOPLEBOY
from tests.helpers.images.drawn_people import blank, draw_person


def view(x=100):
    image = blank()
    draw_person(image, x, 120 + 0.36 * 30, 0.38 * 30, 30)
    model = ContourModel.build(image.shape, PEOPLEBOY.contour)
    return view_frame(Frame(images={THERMAL: image}, time_s=1.0), 1 / 15, model, PEOPLEBOY)


def looking(looks):
    return replace(PEOPLEBOY, search=replace(PEOPLEBOY.search, looks=looks))


def confidences(looks, frames):
    """The mean over ten seeds after some frames of somebody who stands."""
    shown, config, last = view(), looking(looks), []
    for seed in range(10):
        rng, belief = np.random.default_rng(seed), None
        for _ in range(frames):
            belief = detected(belief, (), shown, config, rng)
        last.append(belief.confidence)
    return np.mean(last)


def test_looks_at_one_image_tell_as_much_as_images_one_after_the_other():
    assert abs(confidences(looks=2, frames=2) - confidences(looks=1, frames=4)) < 1e-9


def test_more_looks_make_it_sure_sooner():
    assert confidences(looks=2, frames=2) > confidences(looks=1, frames=2) + 0.05


def test_the_camera_turns_once_in_however_many_looks():
    turned = replace(view(), turn_rad=0.2)
    at = float(turned.after_turn(np.array([100.0]))[0])
    after = replace(view(at), turn_rad=0.2)
    config = replace(looking(2), detector=replace(PEOPLEBOY.detector, fresh_share=0.0))
    belief = None
    for seen in (view(), view(), after):
        belief = detected(belief, (), seen, config, np.random.default_rng(0))
    assert belief.estimate[X] == pytest.approx(at, abs=4)
