"""Data sets for hubs: WebDataset shards, and parquet files for the library `datasets` of Hugging Face.

    train-000000.tar, val-..., test-...                    WebDataset: KEY.png, KEY.mask.png, KEY.json
    data/train-00000-of-00001.parquet, val-..., test-...   parquet: image, mask, and labels of its people
    croissant.json                                         Croissant metadata of the files, for both

Both contain the images of one camera, by split; runs that are in no rendered set are in train. KEY is
RUN-000001. Masks have the id of the person at each pixel. The JSON files have the entries of COCO, with
pixels counted from the image's corner.
"""

import io
import json
import tarfile
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, Final

import pyarrow as pa
import pyarrow.parquet as pq

from peopleboy.scenarios.export.coco import annotation, image_entry
from peopleboy.scenarios.export.formats import need
from peopleboy.scenarios.export.hubs.croissant import CroissantFile, write_croissant
from peopleboy.scenarios.export.labelled_frames import LabelledFrame, attributes_of, labelled_frames
from peopleboy.scenarios.export.replay import Play, with_people
from peopleboy.scenarios.export.splits import by_split
from peopleboy.scenarios.run_folder.finished_run import FinishedRun
from peopleboy.scenarios.run_folder.image_files import png_bytes
from peopleboy.scenarios.run_folder.run_tables import LOCAL

_TRAIN: Final = "train"  # where runs without splits are, as loaders expect that split
_IMAGES_PER_SHARD: Final = 1000
_IMAGES_PER_GROUP: Final = 100
_LABELS: Final = ("area", "track_id", "distance_m", "visible_fraction", "occluded_fraction")
_TEXTS: Final = ("name", "posture", "sex", "age", "gait", "equipment")


def write_webdataset(runs: Sequence[FinishedRun], folder: Path, play: Play, camera: str = "thermal") -> None:
    """Write the images of a camera with masks and labels as tar files, with up to 1000 images each.

    Raises:
        BadInput: some runs have splits and others do not, or one has no such camera.
    """
    files = []
    for split, own in by_split(runs).items():
        samples = _samples(own, play, camera)
        for shard, chunk in enumerate(_chunks(samples, _IMAGES_PER_SHARD)):
            path = folder / f"{split or _TRAIN}-{shard:06d}.tar"
            with tarfile.open(path, "w") as tar:
                for sample in chunk:
                    _add_sample(tar, sample)
            files.append(CroissantFile(path.name, split or _TRAIN, "application/x-tar"))
    write_croissant(folder, files)


def write_huggingface(runs: Sequence[FinishedRun], folder: Path, play: Play, camera: str = "thermal") -> None:
    """Write the images of a camera with masks and labels as one parquet file per split.

    Raises:
        BadInput: the library `datasets` is not installed, some runs have splits and others do not, or one has
            no such camera.
    """
    schema, files = _features().arrow_schema, []
    (folder / "data").mkdir()
    for split, own in by_split(runs).items():
        name = f"data/{split or _TRAIN}-00000-of-00001.parquet"
        with pq.ParquetWriter(str((folder / name).absolute()), schema, filesystem=LOCAL) as writer:
            for chunk in _chunks(_samples(own, play, camera), _IMAGES_PER_GROUP):
                writer.write_table(pa.Table.from_pylist([_row(sample) for sample in chunk], schema=schema))
        files.append(CroissantFile(name, split or _TRAIN, "application/x-parquet"))
    write_croissant(folder, files)


def _samples(runs: Sequence[FinishedRun], play: Play, camera: str) -> Iterator[dict[str, Any]]:
    """Yield key, image, mask and labels of each image."""
    for run in runs:
        with_people(run, camera)
        attributes = attributes_of(run)
        for shot in labelled_frames(run, play):
            if camera in shot.people:
                yield _sample(run, camera, shot, attributes)


def _sample(
    run: FinishedRun, camera: str, shot: LabelledFrame, attributes: Mapping[str, Any]
) -> dict[str, Any]:
    people = [person for person in shot.people[camera] if person["visible_px"] > 0]
    return {
        "key": f"{run.name}-{shot.frame:06d}",
        "png": shot.images[camera],
        "mask.png": png_bytes(shot.masks[camera]),
        "image": {"run": run.name, "scenario": run.scenario.name, "seed": run.about.seed}
        | image_entry(run, camera, shot, attributes),
        "annotations": [annotation(person, shot.masks[camera], attributes) for person in people],
    }


def _chunks(samples: Iterator[dict[str, Any]], size: int) -> Iterator[list[dict[str, Any]]]:
    """Group samples; the last group is smaller."""
    chunk: list[dict[str, Any]] = []
    for sample in samples:
        chunk.append(sample)
        if len(chunk) == size:
            yield chunk
            chunk = []
    if chunk:
        yield chunk


def _add_sample(tar: tarfile.TarFile, sample: Mapping[str, Any]) -> None:
    labels = {"image": sample["image"], "annotations": sample["annotations"]}
    contents = {
        "png": sample["png"],
        "mask.png": sample["mask.png"],
        "json": json.dumps(labels, allow_nan=False).encode(),
    }
    for ending, content in contents.items():
        entry = tarfile.TarInfo(f"{sample['key']}.{ending}")
        entry.size = len(content)
        tar.addfile(entry, io.BytesIO(content))


def _features() -> Any:
    """Return the columns of the parquet files."""
    datasets = need("datasets", "--format huggingface")
    value, lists = datasets.Value, datasets.List
    numbers = {name: lists(value("float64")) for name in _LABELS}
    texts = {name: lists(value("string")) for name in _TEXTS}
    return datasets.Features(
        {
            "image": datasets.Image(),
            "mask": datasets.Image(),
            "key": value("string"),
            "run": value("string"),
            "seed": value("int64"),
            "frame": value("int64"),
            "time_s": value("float64"),
            "objects": {
                "bbox": lists(lists(value("float64"))),
                "whole_bbox": lists(lists(value("float64"))),
                "category": lists(datasets.ClassLabel(names=["person"])),
                "keypoints": lists(lists(value("float64"))),
                **numbers,
                **texts,
            },
        }
    )


def _row(sample: Mapping[str, Any]) -> dict[str, Any]:
    image, labels = sample["image"], sample["annotations"]
    flat = [label | label["attributes"] for label in labels]
    same = ("bbox", "whole_bbox", "keypoints", *_LABELS, *_TEXTS)
    return {
        "image": {"bytes": sample["png"], "path": f"{sample['key']}.png"},
        "mask": {"bytes": sample["mask.png"], "path": f"{sample['key']}.mask.png"},
        "key": sample["key"],
        **{name: image[name] for name in ("run", "seed", "time_s")},
        "frame": image["frame_id"],
        "objects": {name: [label[name] for label in flat] for name in same} | {"category": [0] * len(flat)},
    }
