"""Panoramas of an empty hall, with people drawn as a conical mirror shows them: feet lower when nearer."""

import math

import numpy as np

from peopleboy.tracker.frame import Frame

WIDTH, HEIGHT = 480, 120
CENTRE_M, HIGHEST_DEG, LOWEST_DEG = 1.7, 8.0, 55.0


class DrawnMirror:
    """A calibration whose rows look evenly from 8 deg down at the top to 55 deg at the bottom."""

    position_m = (0.0, 0.0, CENTRE_M)

    def __init__(self, lowest_deg=LOWEST_DEG):
        self.lowest_deg = lowest_deg

    def rays(self, pixels):
        u, v = np.asarray(pixels, float).T
        turn = math.pi - math.tau * (u + 0.5) / WIDTH
        down = np.radians(HIGHEST_DEG + (self.lowest_deg - HIGHEST_DEG) * v / (HEIGHT - 1))
        return np.stack([np.cos(down) * np.cos(turn), np.cos(down) * np.sin(turn), -np.sin(down)], axis=1)

    def project(self, points_m):
        raise NotImplementedError


def column_of(bearing_rad):
    return (math.pi - bearing_rad) / math.tau * WIDTH - 0.5


def row_of(distance_m, height_m=0.0):
    down = math.degrees(math.atan2(CENTRE_M - height_m, distance_m))
    return (down - HIGHEST_DEG) / (LOWEST_DEG - HIGHEST_DEG) * (HEIGHT - 1)


def empty_hall(rng, noise=2.0):
    rows = np.linspace(150.0, 90.0, HEIGHT)[:, None, None] + np.array([0.0, 10.0, -10.0])
    image = np.broadcast_to(rows, (HEIGHT, WIDTH, 3)) + rng.normal(0.0, noise, (HEIGHT, WIDTH, 3))
    return np.uint8(np.clip(image, 0, 255))


def person_mask(distance_m, bearing_rad, width_m=0.45):
    """Two legs with a gap, and a body above 0.8 m, on the wrapped columns."""
    u = (np.arange(WIDTH) - column_of(bearing_rad) + WIDTH / 2) % WIDTH - WIDTH / 2
    across = np.radians(u * 360 / WIDTH) * distance_m
    rows = np.arange(HEIGHT)[:, None]
    body = (np.abs(across) < width_m / 2) & (rows <= row_of(distance_m, 0.8))
    legs = (np.abs(np.abs(across) - width_m / 3) < width_m / 6) & (rows <= row_of(distance_m))
    return body | legs


def draw(image, mask, rgb=(30, 30, 90)):
    drawn = image.copy()
    drawn[mask] = rgb
    return drawn


def frame(time_s, image=None, **further):
    images = {} if image is None else {"panorama": image}
    return Frame(images=images, time_s=time_s, calibrations={"panorama": DrawnMirror()}, **further)
