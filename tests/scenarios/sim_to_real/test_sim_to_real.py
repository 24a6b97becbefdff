"""Rendered beside real: figures by closed forms, a judge that is fair, and what is refused."""

import json
import re
from pathlib import Path

import cv2
import numpy as np
import pytest

from peopleboy.scenarios.sim_to_real.clips import (
    SIDE,
    ClipFrame,
    background_patches,
    find_clips,
    person_patches,
)
from peopleboy.scenarios.sim_to_real.compare import classify_patches, features
from peopleboy.scenarios.sim_to_real.measures import (
    background_deviation,
    contrasts_of,
    measure_images,
    noise_of,
    radial_power,
)
from tests.helpers.calls.command_line import refusal, run_cli
from tests.helpers.calls.refused import assert_names, refused

RNG = np.random.default_rng(7)
BOX = np.array([[90.0, 60.0, 40.0, 100.0]])


def moment(grey: np.ndarray, later: np.ndarray | None = None, boxes: np.ndarray = BOX) -> ClipFrame:
    return ClipFrame(grey, later, boxes, np.ones(len(boxes), bool))


def textures(scenes: int, sigma: float, patches: int = 30) -> list[list[np.ndarray]]:
    """Blurred noise, of an own strength in each scene."""
    found = []
    for strength in RNG.uniform(8.0, 20.0, scenes):
        many = [cv2.GaussianBlur(RNG.normal(0.0, 1.0, (SIDE, SIDE)), (0, 0), sigma) for _ in range(patches)]
        found.append([np.uint8(np.clip(128 + strength * one / one.std(), 0, 255)) for one in many])
    return found


def write_clip(folder: Path, sigma: float = 1.0, size: tuple[int, int] = (200, 240), frames: int = 4) -> Path:
    (folder / "thermal").mkdir(parents=True)
    for number in range(1, frames + 1):
        noise = cv2.GaussianBlur(RNG.normal(0.0, 1.0, size), (0, 0), sigma)
        grey = np.uint8(np.clip(110 + 25 * noise / noise.std(), 0, 255))
        grey[50:150, 40:80], grey[60:140, 150:180] = 200, 190
        cv2.imwrite(str(folder / "thermal" / f"{number:06d}.png"), grey)
    rows = [f"{n},{k},{x},{y},{w},{h},1,1,1" for n in range(1, frames + 1) for k, x, y, w, h in
            ((1, 40, 50, 40, 100), (2, 150, 60, 30, 80))]  # fmt: skip
    (folder / "gt.txt").write_text("\n".join(rows) + "\n")
    return folder


def test_white_noise_has_its_variance_at_every_frequency() -> None:
    power = np.mean([radial_power(RNG.normal(0.0, 3.0, (64, 64))) for _ in range(60)], axis=0)
    assert np.allclose(power[2:], 9.0, rtol=0.12)


def test_a_wave_shows_at_its_frequency_alone() -> None:
    wave = np.tile(10.0 * np.sin(2.0 * np.pi * 8.0 * np.arange(64) / 64.0), (64, 1))
    power = radial_power(wave)
    assert power.argmax() == 8 - 1
    assert power[:4].max() < 1e-3 * power.max()


def test_noise_is_that_of_one_picture_and_something_that_moves_is_none() -> None:
    still = np.full((200, 240), 120.0)
    pair = [np.rint(still + RNG.normal(0.0, 4.0, still.shape)).astype(np.uint8) for _ in range(2)]
    assert noise_of(moment(*pair)) == pytest.approx(4.0, rel=0.04)
    pair[1][:3, :] = 255
    assert noise_of(moment(*pair)) == pytest.approx(4.0, rel=0.1)
    assert noise_of(moment(pair[0], pair[0])) == 0.0


def test_contrast_and_deviation_are_those_that_were_painted() -> None:
    grey = np.full((200, 240), 50, np.uint8)
    grey[:, :40] = 90
    grey[60:160, 90:130] = 200
    ((apart, in_ring),) = contrasts_of(moment(grey))
    assert apart == pytest.approx(150.0)
    assert in_ring == pytest.approx(150.0)  # the ring is even, and counts as if it had a deviation of 1
    outside = np.ones(grey.shape, bool)
    outside[45:175, 84:136] = False
    assert background_deviation(moment(grey)) == pytest.approx(grey[outside].std())
    stats = measure_images([moment(grey, grey)], RNG)
    assert stats.clipped == 0.0
    assert stats.grey.sum() == pytest.approx(1.0) == stats.gradient.sum()


def test_patches_of_background_hold_nobody_and_people_are_all_as_high() -> None:
    grey = np.full((200, 240), 50, np.uint8)
    grey[60:160, 90:130] = 200
    assert {int(patch.max()) for patch in background_patches(moment(grey), 8, RNG)} == {50}
    (person,) = person_patches(moment(grey))
    rows = np.flatnonzero((person > 125).any(axis=1))
    assert person.shape == (SIDE, SIDE)
    assert len(rows) == pytest.approx(SIDE / 1.25, abs=1)
    assert person_patches(moment(grey, boxes=np.array([[90.0, 60.0, 10.0, 20.0]]))) == []


def test_gradients_alone_are_looked_at() -> None:
    patch = RNG.integers(40, 90, (SIDE, SIDE)).astype(np.uint8)
    assert np.allclose(features(patch), features(patch + np.uint8(100)), atol=1e-6)


def test_what_is_alike_is_not_told_apart_and_what_is_not_is() -> None:
    alike = classify_patches(textures(6, 1.5), textures(4, 1.5), 0, "patches")
    apart = classify_patches(textures(6, 1.0), textures(4, 2.5), 0, "patches")
    assert 0.35 < alike.auc.mean < 0.65
    assert apart.auc.mean > 0.99
    assert apart.scenes == (6, 4)
    assert apart.patches == (180, 120)
    assert len(apart.folds) == 4 * 4
    assert alike.auc.low <= alike.auc.mean <= alike.auc.high


def test_what_tells_a_single_scene_is_of_no_use_on_others() -> None:
    """Each scene has a grain of its own; drawn anew for either side, it says nothing about the side."""
    sides = [[scene for sigma in RNG.uniform(0.6, 3.0, 8) for scene in textures(1, sigma)] for _ in range(2)]
    assert classify_patches(*sides, 0, "patches").auc.mean < 0.8


@pytest.mark.thorough
def test_a_page_that_needs_nothing_else_and_the_same_figures_as_json(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    for name, sigma in (("a", 0.7), ("b", 0.8)):
        write_clip(tmp_path / "rendered" / name, sigma)
    real = [write_clip(tmp_path / "real" / name, 2.0) for name in ("c", "d")]
    order = ("sim-to-real", tmp_path / "rendered", "--real", real[0], "--real", real[1])
    page = tmp_path / "page.html"
    assert run_cli(*order, "--out", page, "--json") == 0
    figures = json.loads(capsys.readouterr().out)
    assert figures["auc"]["auc"]["mean"] > 0.95
    assert figures["auc"]["scenes"] == [2, 2]
    assert "people" in figures["lacking"]
    assert set(figures["real"]["scenes"]) == {"c", "d"}
    text = page.read_text()
    assert not re.findall(r'(?:src|href)="(?!data:|#)', text)
    assert text.count("data:image/png;base64,") == 4
    assert text.count("<svg") == 5
    assert run_cli(*order, "--out", tmp_path / "again.html", "--json") == 0
    assert json.loads(capsys.readouterr().out) == figures
    assert (tmp_path / "again.html").read_text() == text


def test_runs_of_one_scenario_are_one_scene(tmp_path: Path) -> None:
    for name in ("walk-0", "walk-1"):
        folder = write_clip(tmp_path / name)
        (folder / "run.json").write_text(json.dumps({"scenario": "walk"}))
    assert {clip.scene for clip in find_clips([tmp_path])} == {"walk"}


@pytest.mark.parametrize(
    ("spoil", "named"),
    [
        (lambda home: (home / "gt.txt").unlink(), ("boxes", "gt.txt")),
        (lambda home: [path.unlink() for path in (home / "thermal").iterdir()], ("pictures", "thermal/")),
        (
            lambda home: cv2.imwrite(str(home / "thermal" / "000001.png"), np.zeros((200, 240), np.uint16)),
            ("000001.png", "8 bits"),
        ),
        (
            lambda home: cv2.imwrite(str(home / "thermal" / "000001.png"), np.zeros((100, 120), np.uint8)),
            ("000001.png", "at least 192", "120x100"),
        ),
        (
            lambda home: cv2.imwrite(str(home / "thermal" / "000002.png"), np.zeros((200, 200), np.uint8)),
            ("000002.png", "size of the first"),
        ),
    ],
)
def test_clips_that_cannot_be_used_are_refused_by_name(tmp_path: Path, spoil, named: tuple[str, ...]) -> None:
    home = write_clip(tmp_path / "clip")
    spoil(home)
    with refused(*named):
        for clip in find_clips([home]):
            list(clip.moments(4))


def test_one_scene_is_too_few_and_a_folder_must_be_there(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    one, other = write_clip(tmp_path / "one"), write_clip(tmp_path / "other")
    out = ("--out", tmp_path / "page.html")
    assert_names(refusal(capsys, "sim-to-real", one, "--real", other, *out), "rendered", "at least 2")
    assert_names(refusal(capsys, "sim-to-real", tmp_path / "no", "--real", other, *out), "no such folder")
    (tmp_path / "mine.html").write_text("do not lose me")
    separability = refusal(capsys, "sim-to-real", one, "--real", other, "--out", tmp_path / "mine.html")
    assert_names(separability, "mine.html", "not be replaced")
    assert not (tmp_path / "page.html").exists()
