import numpy as np

from peopleboy.sim.places.painting.sunlight import _shade


def test_a_point_is_in_the_shade_of_a_box_that_its_ray_enters() -> None:
    rng = np.random.default_rng(0)
    points, way = rng.uniform(-2.0, 2.0, (20, 15, 3)), np.array([0.3, -0.5, 0.8])
    low = rng.uniform(-2.0, 2.0, (6, 3))
    boxes = np.stack([low, low + rng.uniform(0.5, 1.5, (6, 3))], axis=1)
    lit = np.ones((20, 15), bool)
    lit[0] = False  # where it was dark before
    _shade(lit, points, way, boxes)
    along = points[..., None, :] + np.linspace(0.02, 8.0, 3000)[:, None] * way
    shaded = np.zeros((20, 15), bool)
    for box in boxes:
        shaded |= ((along > box[0]) & (along < box[1])).all(axis=-1).any(axis=-1)
    assert 30 < shaded[1:].sum() < 240
    assert (lit[1:] == ~shaded[1:]).mean() > 0.99  # of which some steps are longer than what a ray cuts off
    assert not lit[1:][shaded[1:]].any()
    assert not lit[0].any()
