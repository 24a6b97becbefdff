import os
import signal
import subprocess
import sys
from contextlib import suppress
from pathlib import Path

import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.drawing.draw_plan import draw_plan
from peopleboy.scenarios.export.make_dataset import SetOptions, render_set
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.run_folder.atomic_output import atomic, atomic_folder
from peopleboy.scenarios.run_folder.folder import claim_folder
from peopleboy.scenarios.running.engine.task import Workers
from peopleboy.scenarios.running.frame_cache import film
from peopleboy.studies.reproductions.units import open_store
from peopleboy.studies.training.specification import MODELS, load_specification, train
from tests.helpers.calls.footage_calls import refusal
from tests.helpers.calls.processes import start
from tests.helpers.images.footage_files import write_folder

WAIT = """
import sys, time
from pathlib import Path
from peopleboy.scenarios.run_folder.atomic_output import atomic_folder
with atomic_folder(Path(sys.argv[1]), {}, overwrite=True) as folder:
    (folder / "half").touch()
    print("begun", flush=True)
    time.sleep(60)
"""


def begin(out: Path) -> "subprocess.Popen[str]":
    """Start a process that writes a folder, and wait until it has begun."""
    process = start([sys.executable, "-c", WAIT, str(out)], stdout=subprocess.PIPE)
    assert process.stdout is not None
    assert process.stdout.readline() == "begun\n"
    return process


def end(process: "subprocess.Popen[str]", how: signal.Signals) -> int:
    process.send_signal(how)
    process.communicate()
    return process.returncode


@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGINT])
def test_a_process_told_to_end_leaves_nothing_behind_and_the_earlier_folder_whole(tmp_path, how):
    with atomic_folder(tmp_path / "out", {}, overwrite=False) as folder:
        (folder / "earlier").touch()
    assert end(begin(tmp_path / "out"), how) in (128 + how, -how)
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert (tmp_path / "out" / "earlier").is_file()


def test_what_a_killed_process_has_left_goes_with_the_next_call_and_a_running_ones_stays(tmp_path):
    out, others = tmp_path / "out", tmp_path / ".out.tex.1.new"
    others.mkdir()
    end(begin(out), signal.SIGKILL)
    assert len(list(tmp_path.iterdir())) == 2
    running = begin(out)
    with atomic_folder(out, {}, overwrite=False):
        left = {path.name for path in tmp_path.iterdir()}
    assert left == {".out.tex.1.new", f".out.{running.pid}.new", f".out.{os.getpid()}.new"}
    end(running, signal.SIGTERM)
    assert {path.name for path in tmp_path.iterdir()} == {"out", ".out.tex.1.new"}


def test_an_earlier_folder_is_back_if_the_new_one_cannot_take_its_place(tmp_path, monkeypatch):
    out = tmp_path / "out"
    with atomic_folder(out, {}, overwrite=False):
        pass

    def fail(*_: Path) -> Path:
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(Path, "replace", fail)
    with pytest.raises(BadInput, match="No space left"), atomic_folder(out, {}, overwrite=True):
        pass
    assert [path.name for path in tmp_path.iterdir()] == ["out"]
    assert (out / "export.json").is_file()


def test_a_file_is_replaced_whole_or_stays_as_it_is(tmp_path):
    page = tmp_path / "page.html"
    for text in ("first", "second"):
        with atomic(page) as part:
            part.write_text(text)
        assert page.read_text() == text
    with suppress(KeyboardInterrupt), atomic(page) as part:
        part.write_text("half")
        raise KeyboardInterrupt
    with atomic(page):
        pass  # made nothing
    with atomic(page, stays=page.exists) as part:
        part.write_text("too late")
    assert page.read_text() == "second"
    assert list(tmp_path.iterdir()) == [page]


def test_handlers_of_sigterm_are_as_before(tmp_path):
    before = signal.getsignal(signal.SIGTERM)
    with atomic_folder(tmp_path / "out", {}, overwrite=False):
        assert signal.getsignal(signal.SIGTERM) != before
    assert signal.getsignal(signal.SIGTERM) == before


def write_run(path):
    with atomic_folder(path, {}, overwrite=False, kind="run"):
        pass


FOLDERS = {
    "export or track": write_run,
    "run": lambda path: claim_folder(path, overwrite=False),
    "render": lambda path: render_set(
        SetOptions(scenarios=("pass_behind",), seeds=range(1), out=path), Workers()
    ),
}
OTHERS = {
    "show": lambda path: draw_plan(load_scenario("pass_behind"), 0, path),
    "reproduce": lambda path: open_store(path / "units.jsonl"),
    **{
        f"train {model}": lambda path, model=model: train(
            load_specification(model)(), path, Workers(), ship=False
        )
        for model in MODELS
    },
    "datasets": lambda path: film(load_scenario("pass_behind"), 0, path),
}


@pytest.mark.parametrize("command", FOLDERS | OTHERS)
def test_a_place_that_cannot_be_written_is_named_as_it_was_given(tmp_path, command):
    place = tmp_path / "README.md" / "x.png"
    place.parent.touch()
    with pytest.raises(BadInput) as caught:
        (FOLDERS | OTHERS)[command](place)
    option = "--frame-cache" if command == "datasets" else "--out"
    assert str(caught.value) == f"{place}: cannot write here: Not a directory; give another {option}"


@pytest.mark.parametrize("write", FOLDERS.values(), ids=FOLDERS)
def test_an_out_without_a_name_is_refused(tmp_path, monkeypatch, write):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(BadInput, match="--out must name a folder"):
        write(Path(""))
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("is_file", [True, False])
def test_what_is_no_run_is_never_offered_for_replacement(tmp_path, is_file):
    mine = tmp_path / "mine"
    if not is_file:
        mine.mkdir()
    (mine if is_file else mine / "thesis.tex").write_text("years of work")
    clip = write_folder(tmp_path / "clip", 3)
    words = f"{mine}: has no run.json, so it will not be replaced; give another --out"
    assert refusal(clip, "--out", mine) == refusal(clip, "--out", mine, "--overwrite") == words
    for overwrite in (False, True):
        with pytest.raises(BadInput, match=r"has no run\.json, so it will not be replaced"):
            claim_folder(mine, overwrite=overwrite)


def test_an_earlier_run_is_replaced_only_if_asked(tmp_path):
    write_run(tmp_path / "out")
    clip = write_folder(tmp_path / "clip", 3)
    assert "exists already; give --overwrite to replace this run" in refusal(clip, "--out", tmp_path / "out")
    with pytest.raises(BadInput, match="exists already; give --overwrite to replace this run"):
        claim_folder(tmp_path / "out", overwrite=False)
