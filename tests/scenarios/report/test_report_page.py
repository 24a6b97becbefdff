from __future__ import annotations

import re
import shutil
import subprocess
import sys
from html.parser import HTMLParser
from pathlib import Path

import pytest

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.cli import main
from peopleboy.scenarios.files.load import load_scenario
from peopleboy.scenarios.report.pictures import Origin
from peopleboy.scenarios.report.report_page import write_report
from peopleboy.scenarios.run_folder.folder import versions
from tests.helpers.runs import toy_runs as toy
from tests.helpers.some_of import some_of

WORDS = Path(__file__).parent / "words"
CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
VOID = {"meta", "img", "br", "link", "hr", "input"}
MOST_BYTES = 3_000_000
# Words in drawings that lie outside of them, or on each other.
_MEASURE = """
const d=document.documentElement, misplaced=[];
for (const drawing of document.querySelectorAll('svg[role=img]:not(.plan svg)')) {
  const frame=drawing.getBoundingClientRect(), words=[...drawing.querySelectorAll('text')];
  const boxes=words.map(word=>word.getBoundingClientRect()).filter(box=>box.width>0);
  boxes.forEach((one,k)=>{
    if (one.left<frame.left-1 || one.right>frame.right+1 || one.bottom>frame.bottom+2) misplaced.push(one);
    for (const other of boxes.slice(k+1))
      if (one.left<other.right-1 && other.left<one.right-1
          && one.top<other.bottom-3 && other.top<one.bottom-3)
        misplaced.push(one);
  });
}
parent.postMessage(d.scrollWidth+'/'+innerWidth+'/'+misplaced.length,'*')
"""
_COLLECT = "onmessage=e=>{const b=document.createElement('b');b.textContent=e.data;document.body.append(b)}"


@pytest.fixture(scope="module")
def runs(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("runs")
    hidden = toy.hidden_from_40_to_60
    scenario = load_scenario("corridor_patrol").resolved(0)  # a place to be drawn
    toy.write_run(root / "one", toy.renumbered, hidden, scenario)
    toy.write_run(root / "other", toy.steady, hidden, tracker="thesis")
    return root


@pytest.fixture(scope="module")
def pages(runs: Path, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    out = tmp_path_factory.mktemp("pages")
    write_report([runs / "one"], out / "one.html")
    write_report([runs / "one", runs / "other"], out / "both.html")
    write_report([runs], out / "many.html")
    toy.write_run(out / "blinking", toy.flickering, toy.blinking)
    write_report([out / "blinking"], out / "blinking.html")
    shutil.rmtree(out / "blinking")
    return {path.stem: path for path in out.iterdir()}


class Structure(HTMLParser):
    """Checks that tags are closed in order, and collects what a page is made of."""

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.text = ""
        self.lines: list[str] = []  # what is read out

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))
        self._say(str(dict(attrs).get("alt") or dict(attrs).get("aria-label") or ""))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag: str) -> None:
        assert self.open.pop() == tag

    def handle_data(self, data: str) -> None:
        self.text += data
        if not {"style", "svg"} & set(self.open):
            self._say(data)

    def _say(self, words: str) -> None:
        line = " ".join(words.split())
        if line and line not in self.lines[-1:]:
            self.lines.append(line)

    def attributes(self, name: str) -> list[str]:
        return [str(attrs[name]) for _, attrs in self.tags if name in attrs]


def structure(page: Path) -> Structure:
    parser = Structure()
    parser.feed(page.read_text(encoding="utf-8"))
    assert parser.open == []
    return parser


@pytest.mark.slow
@pytest.mark.parametrize("name", ["one", "both", "many"])
def test_a_page_is_whole_html_that_needs_nothing_else(pages: dict[str, Path], name: str) -> None:
    page = structure(pages[name])
    assert pages[name].stat().st_size < MOST_BYTES
    assert pages[name].read_text(encoding="utf-8").lstrip().startswith("<!doctype html>")
    assert all(address.startswith("data:") for address in page.attributes("src"))
    ids = page.attributes("id")
    assert len(ids) == len(set(ids))
    assert all(address[1:] in ids for address in page.attributes("href"))
    assert not any(tag in ("script", "link", "iframe") for tag, _ in page.tags)
    assert not re.search(r"url\((?!#)", pages[name].read_text(encoding="utf-8"))


@pytest.mark.parametrize("name", ["one", "both", "many"])
def test_a_page_can_be_read_without_seeing_it(pages: dict[str, Path], name: str) -> None:
    page = structure(pages[name])
    tags = page.tags
    assert all(attrs.get("alt") for tag, attrs in tags if tag == "img")
    assert all(attrs.get("aria-label") for tag, attrs in tags if attrs.get("role") == "img")
    assert all("scope" in attrs for tag, attrs in tags if tag == "th")
    levels = [int(tag[1]) for tag, _ in tags if re.fullmatch(r"h[1-6]", tag)]
    assert levels[0] == 1
    assert levels.count(1) == 1
    assert ("html", {"lang": "en-GB"}) in tags


@pytest.mark.parametrize("name", ["one", "both", "many"])
def test_a_page_says_what_it_said(pages: dict[str, Path], runs: Path, name: str) -> None:
    """Holds a page's words, and those for its pictures, against a file in the folder words.

    To renew the file, delete it, run the test, which writes it and fails, and look at what has changed in it.
    """
    made = ", ".join(f"{package} {version}" for package, version in versions().items())
    said = "\n".join(structure(pages[name]).lines).replace(str(runs), "RUNS").replace(made, "VERSIONS")
    file = WORDS / f"{name}.txt"
    if not file.exists():
        file.write_text(said + "\n", encoding="utf-8")
        pytest.fail(f"{file} was written anew")
    assert said.split() == file.read_text(encoding="utf-8").split()


@pytest.mark.slow
@pytest.mark.parametrize("name", some_of(["both", "one", "many"], 3))
def test_a_page_is_the_same_each_time(pages: dict[str, Path], runs: Path, name: str, tmp_path: Path) -> None:
    paths = {"one": [runs / "one"], "both": [runs / "one", runs / "other"], "many": [runs]}
    write_report(paths[name], tmp_path / "page.html")
    assert (tmp_path / "page.html").read_bytes() == pages[name].read_bytes()


@pytest.mark.slow
def test_words_from_files_cannot_become_markup(tmp_path: Path) -> None:
    bad = "<script>alert(1)</script>"
    folder = toy.write_run(tmp_path / "run", scenario={"name": bad, "description": bad})
    write_report([folder], tmp_path / "page.html")
    page = structure(tmp_path / "page.html")
    assert not any(tag == "script" for tag, _ in page.tags)
    assert bad in page.text


@pytest.mark.parametrize("state", ["absent", "empty", "cut off"])
def test_what_is_no_complete_run_is_refused_in_one_line(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], state: str
) -> None:
    folder = tmp_path / "run"
    if state != "absent":
        folder.mkdir()
    if state == "cut off":
        (folder / "run.json").write_text('{"status": "cut off"}')
    with pytest.raises(SystemExit) as ended:
        main(["report", str(folder), "--out", str(tmp_path / "page.html")])
    assert ended.value.code == 2
    assert len(capsys.readouterr().err.splitlines()) == 1
    assert not list(tmp_path.glob("page*"))


def test_a_page_that_cannot_be_written_is_refused_and_nothing_is_left(runs: Path, tmp_path: Path) -> None:
    for out, why in (
        (tmp_path, "is a folder"),
        (tmp_path / "missing" / "page.html", "cannot write here"),
    ):
        with pytest.raises(BadInput, match=why):
            write_report([runs / "other"], out)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(
    ("out", "why"),
    [
        ("README.md", "is not a report and will not be replaced; give --out a file that ends in .html"),
        ("tracks.txt", "is not a report and will not be replaced; give --out a file that ends in .html"),
        ("other.html", "is not a report and will not be replaced; give another --out"),
        ("README.md/x", "a report is an HTML page; give --out a file that ends in .html"),
        ("README.md/x.html", "cannot write here: Not a directory; give another --out"),
        ("new.txt", "a report is an HTML page; give --out a file that ends in .html"),
    ],
)
def test_a_report_replaces_nothing_but_a_report(
    runs: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], out: str, why: str
) -> None:
    for name in ("README.md", "tracks.txt", "other.html"):
        (tmp_path / name).write_text("<title>mine</title>")
    with pytest.raises(SystemExit) as ended:
        main(["report", str(runs / "other"), "--out", str(tmp_path / out)])
    assert ended.value.code == 2
    assert capsys.readouterr().err == f"peopleboy: {tmp_path / out}: {why}\n"
    assert {path.read_text() for path in tmp_path.iterdir()} == {"<title>mine</title>"}
    assert len(list(tmp_path.iterdir())) == 3


@pytest.mark.slow
def test_an_earlier_report_is_replaced(pages: dict[str, Path], runs: Path, tmp_path: Path) -> None:
    page = tmp_path / "page.HTM"
    shutil.copy(pages["both"], page)
    write_report([runs / "one"], page)
    assert page.read_bytes() == pages["one"].read_bytes()


def test_what_a_page_lacks_is_said_on_it_and_on_standard_error(
    runs: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["report", str(runs / "other")])
    assert ended.value.code == 0
    (line,) = capsys.readouterr().err.splitlines()
    said = line.removeprefix("peopleboy: note: ")
    assert "scenario.yaml: " in said
    text = " ".join(structure(runs / "other" / "report.html").text.split())
    assert said in text
    assert "robot stand" not in text
    assert "peopleboy run" not in text  # which could not be done again with it


def test_a_report_without_pybullet_draws_boxes_and_says_so(
    runs: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pybullet", None)
    (line,) = write_report([runs / "one"], tmp_path / "page.html")
    assert line.startswith("PyBullet is not installed")
    page = structure(tmp_path / "page.html")
    assert page.lines.count(f"{line}.") == 1
    assert Origin.NO_PHYSICS in page.lines


@pytest.mark.thorough
def test_the_simulator_is_not_loaded_for_a_report() -> None:
    code = "import sys, peopleboy.scenarios.report.report_page; print('peopleboy.sim.world' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "False"


@pytest.mark.slow
def test_short_losses_that_are_left_out_are_counted_also_when_no_other_is_there(
    pages: dict[str, Path], tmp_path: Path
) -> None:
    text = " ".join(structure(pages["blinking"]).text.split())
    assert "Losses of less than 0.3 s (1 of them) are omitted" in text
    assert "not detected any more, confidence 0.90" in text
    write_report(
        [toy.write_run(tmp_path / "run", lambda frame: toy.flickering(min(frame, 40)))],
        tmp_path / "page.html",
    )
    text = " ".join(structure(tmp_path / "page.html").text.split())
    assert "No track was lost for 0.3 s or more." in text
    assert "Losses of less than 0.3 s (1 of them) are omitted" in text


def test_the_command_writes_the_page_into_the_run(runs: Path, capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as ended:
        main(["report", str(runs / "other")])
    assert ended.value.code == 0
    assert capsys.readouterr().out.strip() == str(runs / "other" / "report.html")
    assert (runs / "other" / "report.html").is_file()


@pytest.mark.skipif(CHROMIUM is None, reason="no chromium is installed")
def test_nothing_sticks_out_of_the_page_on_a_phone_or_a_desk(pages: dict[str, Path], tmp_path: Path) -> None:
    # A window cannot be as narrow as a phone, but a frame in it can.
    frames = []
    for name, page in pages.items():
        text = page.read_text(encoding="utf-8").replace("</body>", f"<script>{_MEASURE}</script></body>")
        (tmp_path / f"{name}.html").write_text(text, encoding="utf-8")
        frames += [f'<iframe src="{name}.html" width="{w}" height="800"></iframe>' for w in (390, 1200)]
    (tmp_path / "frames.html").write_text(f"<script>{_COLLECT}</script>{''.join(frames)}", encoding="utf-8")
    address = (tmp_path / "frames.html").as_uri()
    dom = browse(tmp_path, "--virtual-time-budget=5000", "--dump-dom", address)
    found = re.findall(r"<b>(\d+)/(\d+)/(\d+)</b>", dom)
    assert sorted(int(inner) for _, inner, _ in found) == [390] * len(pages) + [1200] * len(pages)
    assert all(int(scrolled) <= int(inner) for scrolled, inner, _ in found)
    assert all(misplaced == "0" for _, _, misplaced in found)


@pytest.mark.skipif(CHROMIUM is None, reason="no chromium is installed")
def test_the_page_prints(pages: dict[str, Path], tmp_path: Path) -> None:
    browse(tmp_path, f"--print-to-pdf={tmp_path / 'page.pdf'}", pages["one"].as_uri())
    pdf = (tmp_path / "page.pdf").read_bytes()
    assert pdf.startswith(b"%PDF")
    assert len(pdf) < MOST_BYTES
    assert 3 <= len(re.findall(rb"/Type\s*/Page\b", pdf)) <= 12


def browse(folder: Path, *arguments: str) -> str:
    options = ("--headless=new", "--no-sandbox", "--disable-gpu", "--no-first-run", "--disable-sync",
               "--disable-background-networking", "--disable-component-update",
               f"--user-data-dir={folder / 'profile'}")  # fmt: skip
    assert CHROMIUM is not None
    done = subprocess.run([CHROMIUM, *options, *arguments], capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    return done.stdout
