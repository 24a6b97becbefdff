"""Describe the files of a data set by Croissant metadata (MLCommons, version 1.0).

Loaders read images and masks by this file: each parquet file has a record set with its columns, and each tar
file one with its images.
"""

import hashlib
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any, Final, NamedTuple

_CONTEXT: Final[dict[str, Any]] = {
    "@language": "en",
    "@vocab": "https://schema.org/",
    "sc": "https://schema.org/",
    "cr": "http://mlcommons.org/croissant/",
    "dct": "http://purl.org/dc/terms/",
    "citeAs": "cr:citeAs",
    "column": "cr:column",
    "conformsTo": "dct:conformsTo",
    "data": {"@id": "cr:data", "@type": "@json"},
    "dataType": {"@id": "cr:dataType", "@type": "@vocab"},
    "extract": "cr:extract",
    "field": "cr:field",
    "fileObject": "cr:fileObject",
    "fileProperty": "cr:fileProperty",
    "fileSet": "cr:fileSet",
    "includes": "cr:includes",
    "isLiveDataset": "cr:isLiveDataset",
    "jsonPath": "cr:jsonPath",
    "key": "cr:key",
    "md5": "cr:md5",
    "parentField": "cr:parentField",
    "path": "cr:path",
    "recordSet": "cr:recordSet",
    "references": "cr:references",
    "regex": "cr:regex",
    "repeated": "cr:repeated",
    "replace": "cr:replace",
    "separator": "cr:separator",
    "source": "cr:source",
    "subField": "cr:subField",
    "transform": "cr:transform",
}
_PARQUET: Final = "application/x-parquet"


class CroissantFile(NamedTuple):
    """A file of a data set: its path in the folder, its split, and its media type."""

    path: str
    split: str
    kind: str


def write_croissant(folder: Path, files: Sequence[CroissantFile]) -> None:
    """Write croissant.json, which describes these files of a folder."""
    content = {
        "@context": _CONTEXT,
        "@type": "sc:Dataset",
        "name": "peopleboy",
        "description": "Images of people seen by a simulated robot, with exact ground truth.",
        "conformsTo": "http://mlcommons.org/croissant/1.0",
        "license": "https://opensource.org/license/mit",
        "version": "1.0.0",
        "distribution": [entry for file in files for entry in _distribution(folder, file)],
        "recordSet": [_records(file) for file in files],
    }
    (folder / "croissant.json").write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")


def _distribution(folder: Path, file: CroissantFile) -> list[dict[str, Any]]:
    digest = hashlib.sha256((folder / file.path).read_bytes()).hexdigest()
    entry = {
        "@type": "cr:FileObject",
        "@id": file.path,
        "name": file.path,
        "contentUrl": file.path,
        "encodingFormat": file.kind,
        "sha256": digest,
    }
    if file.kind == _PARQUET:
        return [entry]
    images = {
        "@type": "cr:FileSet",
        "@id": f"{file.path}-images",
        "name": f"{file.path}-images",
        "containedIn": {"@id": file.path},
        "encodingFormat": "image/png",
        "includes": "*.png",
    }
    return [entry, images]


def _records(file: CroissantFile) -> dict[str, Any]:
    name = Path(file.path).stem
    return {
        "@type": "cr:RecordSet",
        "@id": name,
        "name": name,
        "description": f"Images of the split {file.split}.",
        "field": _columns(name, file) if file.kind == _PARQUET else _members(name, file),
    }


def _columns(name: str, file: CroissantFile) -> list[dict[str, Any]]:
    texts = [_field(name, column, "sc:Text", _column(file, column)) for column in ("key", "run")]
    numbers = [
        _field(name, column, kind, _column(file, column))
        for column, kind in (("seed", "sc:Integer"), ("frame", "sc:Integer"), ("time_s", "sc:Float"))
    ]
    images = [
        _field(
            name,
            column,
            "sc:ImageObject",
            _column(file, column) | {"transform": {"jsonPath": "bytes"}},
        )
        for column in ("image", "mask")
    ]
    return [*images, *texts, *numbers]


def _column(file: CroissantFile, column: str) -> dict[str, Any]:
    return {"fileObject": {"@id": file.path}, "extract": {"column": column}}


def _members(name: str, file: CroissantFile) -> list[dict[str, Any]]:
    images = {"fileSet": {"@id": f"{file.path}-images"}}
    return [
        _field(name, "file", "sc:Text", images | {"extract": {"fileProperty": "filename"}}),
        _field(name, "image", "sc:ImageObject", images | {"extract": {"fileProperty": "content"}}),
    ]


def _field(records: str, name: str, kind: str, source: dict[str, Any]) -> dict[str, Any]:
    return {
        "@type": "cr:Field",
        "@id": f"{records}/{name}",
        "name": name,
        "dataType": kind,
        "source": source,
    }
