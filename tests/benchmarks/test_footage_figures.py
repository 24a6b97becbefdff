import cv2
import numpy as np
from click.testing import CliRunner

from benchmarks.footage import main
from tests.helpers.calls.refused import assert_names


def write_clip(folder, *, with_truth):
    folder.mkdir()
    for frame in range(20):
        image, x = np.full((120, 160), 60, np.uint8), 50 + frame
        cv2.ellipse(image, (x, 30), (5, 7), 0, 0, 360, 180, cv2.FILLED)
        cv2.ellipse(image, (x, 55), (11, 20), 0, 0, 360, 180, cv2.FILLED)
        cv2.rectangle(image, (x - 8, 60), (x + 8, 96), 180, cv2.FILLED)
        cv2.imwrite(str(folder / f"{frame}.png"), image)
    if with_truth:
        lines = [f"{50 + frame - 11},23,22,74\n" for frame in range(20)]
        (folder / "groundtruth_rect.txt").write_text("".join(lines), encoding="utf-8")
    return folder


def test_a_clip_is_tracked_with_several_seeds(tmp_path):
    clip = write_clip(tmp_path / "clip", with_truth=True)
    result = CliRunner().invoke(main, ["--clip", str(clip), "--seeds", "2"])
    assert result.exit_code == 0
    assert "mean of 2 seeds" in result.output


def test_a_clip_without_truth_is_refused(tmp_path):
    clip = write_clip(tmp_path / "clip", with_truth=False)
    result = CliRunner().invoke(main, ["--clip", str(clip), "--seeds", "1"])
    assert result.exit_code == 2
    assert_names(result.output.splitlines()[-1], clip)
