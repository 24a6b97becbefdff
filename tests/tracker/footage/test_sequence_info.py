import json

import pytest

from tests.helpers.calls.footage_calls import call, refusal
from tests.helpers.calls.refused import assert_names
from tests.helpers.images.footage_files import write_folder


def sequence(tmp_path, text):
    write_folder(tmp_path / "seq" / "img1", 2)
    info = tmp_path / "seq" / "seqinfo.ini"
    info.write_text(text)
    return info


def rate(tmp_path, footage, *more):
    result = call(footage, "--out", tmp_path / "out", "--overwrite", *more)
    assert result.exit_code == 0, result.output
    return json.loads((tmp_path / "out" / "run.json").read_text())["rate_hz"], result.stderr


def test_the_rate_of_a_sequence_is_taken_and_told_unless_one_is_given(tmp_path):
    info = sequence(tmp_path, "[Sequence]\nname=a\nimDir=img1\nframeRate=30\nseqLength=2\n")
    for footage in (tmp_path / "seq", tmp_path / "seq" / "img1"):
        given, told = rate(tmp_path, footage)
        assert given == 30.0
        assert_names(told, "note: ", info, "30 pictures a second")
        assert rate(tmp_path, footage, "--rate-hz", 12) == (12.0, "")


@pytest.mark.parametrize("text", ["[Sequence]\nname=a\n", "[Other]\nframeRate=30\n", ""])
def test_without_a_rate_there_it_is_the_default(tmp_path, text):
    sequence(tmp_path, text)
    assert rate(tmp_path, tmp_path / "seq") == (15.0, "")


@pytest.mark.parametrize("told", ["fast", "0", "-30", "nan", "inf", "1e9", ""])
def test_a_rate_that_is_none_is_refused_unless_one_is_given(tmp_path, told):
    info = sequence(tmp_path, f"[Sequence]\nframeRate={told}\n")
    assert_names(
        refusal(tmp_path / "seq", "--out", tmp_path / "out"), info, "0.1..1000", repr(told), "--rate-hz"
    )
    assert rate(tmp_path, tmp_path / "seq", "--rate-hz", 12) == (12.0, "")


def test_a_file_that_cannot_be_read_is_refused(tmp_path):
    info = sequence(tmp_path, "frameRate: no section\n")
    assert_names(refusal(tmp_path / "seq", "--out", tmp_path / "out"), info, "cannot be read")
