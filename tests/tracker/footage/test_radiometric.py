import io
import struct

import numpy as np
import pytest
from PIL import Image

from peopleboy.bad_input import BadInput
from peopleboy.tracker.footage import radiometric
from peopleboy.tracker.footage.image_sequences import open_footage
from peopleboy.tracker.footage.read_picture import read_picture

R1, B, F, OFFSET, R2 = 17096.453, 1428.0, 1.0, -342, 0.046642166
COUNTS = np.linspace(14000, 18000, 40 * 50).reshape(40, 50).astype("<u2")


def write_flir(path):
    """Write a JPEG with raw counts, for a black body at no distance."""
    camera = bytearray(900)
    for at, value in {32: 1.0, 36: 0.0, 40: 293.15, 44: 293.15, 48: 293.15, 52: 1.0, 60: 0.0}.items():
        struct.pack_into("<f", camera, at, value)
    struct.pack_into("<fff", camera, 88, R1, B, F)
    struct.pack_into("<fffff", camera, 112, 0.006569, 0.01262, -0.002276, -0.00667, 1.9)
    struct.pack_into("<if", camera, 776, OFFSET, R2)
    raw = struct.pack("<HHH", 2, COUNTS.shape[1], COUNTS.shape[0]).ljust(32, b"\0") + COUNTS.tobytes()
    data, directory = b"", b""
    for kind, record in ((1, raw), (32, bytes(camera))):
        directory += struct.pack(">HHIIII", kind, 1, 100, 1, 64 + 64 + len(data), len(record)).ljust(
            32, b"\0"
        )
        data += record
    head = b"FFF\0" + bytes(16) + struct.pack(">III", 100, 64, 4)
    content = head.ljust(64, b"\0") + directory + data
    jpeg = io.BytesIO()
    Image.new("RGB", (50, 40), (200, 100, 0)).save(jpeg, "JPEG")
    segment = b"\xff\xe1" + struct.pack(">H", len(content) + 10) + b"FLIR\0\x01\0\0" + content
    path.write_bytes(jpeg.getvalue()[:2] + segment + jpeg.getvalue()[2:])
    return path


def test_temperatures_follow_plancks_law(tmp_path):
    pytest.importorskip("flyr")
    notes = []
    found = read_picture(write_flir(tmp_path / "a.jpg"), notes)
    expected = B / np.log(R1 / (R2 * (COUNTS.astype(float) + OFFSET)) + F) - 273.15
    assert found.dtype == np.float32
    np.testing.assert_allclose(found, expected, atol=0.05)
    assert "radiometric" in notes[0]


def test_without_the_package_the_refusal_names_it(tmp_path, monkeypatch):
    monkeypatch.setattr(radiometric, "find_spec", lambda _: None)
    with pytest.raises(BadInput, match="flyr"):
        read_picture(write_flir(tmp_path / "a.jpg"), [])


def test_a_damaged_one_is_refused(tmp_path):
    pytest.importorskip("flyr")
    path = write_flir(tmp_path / "a.jpg")
    path.write_bytes(path.read_bytes()[:200])
    with pytest.raises(BadInput, match="segment of FLIR"):
        read_picture(path, [])


def test_an_ordinary_jpeg_stays_a_picture(tmp_path):
    Image.new("L", (50, 40), 90).save(tmp_path / "a.jpg")
    assert read_picture(tmp_path / "a.jpg", []).dtype == np.uint8


@pytest.mark.parametrize("suffix", radiometric.SEQUENCES)
def test_a_sequence_is_refused_with_what_to_do(tmp_path, suffix):
    path = tmp_path / f"film{suffix}"
    path.write_bytes(b"FFF\0")
    with pytest.raises(BadInput, match="16-bit TIFF"):
        open_footage(path)
