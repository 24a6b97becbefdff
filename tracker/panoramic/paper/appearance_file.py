"""What was learned of people's appearance, as a readable file."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Annotated

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, ValidationError, model_validator

from peopleboy.bad_input import BadInput
from peopleboy.tracker.panoramic.panorama_view import PanoramaView
from peopleboy.tracker.panoramic.paper.distance_network import CUES, DistanceNetwork
from peopleboy.tracker.panoramic.paper.position_filter import MotionNoise

NETWORKS = Path(__file__).parent / "networks"
"""Where the networks are that come with the tracker, one a mirror, each named after its scenario."""

FILE_NAME = "panoramic-paper.json"
"""What a network is called elsewhere."""

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Row = Annotated[tuple[Finite, ...], Field(min_length=CUES + 1, max_length=CUES + 1)]
Pair = tuple[Finite, Finite]


class _Plain(BaseModel):
    model_config = ConfigDict(extra="forbid", strict=True)


class _View(_Plain):
    width_px: Annotated[int, Field(gt=0)]
    height_px: Annotated[int, Field(gt=0)]
    centre_m: Positive
    depression_deg: tuple[Finite, Finite, Finite]


class _Noise(_Plain):
    step_m2: tuple[Pair, Pair]
    measurement_m2: tuple[Pair, Pair]


class _Appearance(_Plain):
    about: dict[str, str]
    camera: _View
    cue_ranges: tuple[Pair, Pair, Pair]
    distance_range_m: Pair
    hidden: Annotated[tuple[Row, ...], Field(min_length=1)]
    output: tuple[Finite, ...]
    noise: _Noise

    @model_validator(mode="after")
    def _check_network(self) -> _Appearance:
        """Refuse layers that do not fit, and ranges that are none."""
        if len(self.output) != len(self.hidden) + 1:
            raise ValueError(
                f"output must have {len(self.hidden) + 1} weights, one more than hidden has rows"
            )
        if any(low >= high for low, high in (*self.cue_ranges, self.distance_range_m)):
            raise ValueError("ranges must go from less to more")
        return self


@dataclass(frozen=True, slots=True, kw_only=True, eq=False)
class AppearanceModel:
    """The paper's appearance model, and what the training told about the filter.

    Attributes:
        network: from cues to distance.
        view: of the camera whose images it was trained on.
        noise: Q and R as they were among the examples, without a velocity.
        about: what it was trained on, for the reader of the file.
    """

    network: DistanceNetwork
    view: PanoramaView
    noise: MotionNoise
    about: dict[str, str] = field(default_factory=dict)

    def save(self, path: Path) -> None:
        """Write the model as JSON, every number in full."""
        network, noise = self.network, self.noise
        data = {
            "about": self.about,
            "camera": asdict(self.view),
            "cue_ranges": network.cue_ranges.tolist(),
            "distance_range_m": network.distance_range_m,
            "hidden": network.hidden.tolist(),
            "output": network.output.tolist(),
            "noise": {
                "step_m2": noise.step_m2.tolist(),
                "measurement_m2": noise.measurement_m2.tolist(),
            },
        }
        path.write_text(json.dumps(data, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")

    @classmethod
    def load(cls, path: Path) -> AppearanceModel:
        """Read and check a model.

        Raises:
            BadInput: a file that is missing or is no such model.
        """
        try:
            plain = _Appearance.model_validate_json(path.read_bytes())
        except OSError as error:
            raise BadInput(
                f"cannot be read: {error.strerror}; `peopleboy train-distance` makes one", file=str(path)
            ) from None
        except ValidationError as error:
            first = error.errors()[0]
            key = tuple(first["loc"])
            raise BadInput(" ".join(first["msg"].split()), file=str(path), key=key) from None
        return cls(
            network=DistanceNetwork(
                hidden=np.array(plain.hidden),
                output=np.array(plain.output),
                cue_ranges=np.array(plain.cue_ranges),
                distance_range_m=plain.distance_range_m,
            ),
            view=PanoramaView(**plain.camera.model_dump()),
            noise=MotionNoise(
                step_m2=np.array(plain.noise.step_m2), measurement_m2=np.array(plain.noise.measurement_m2)
            ),
            about=plain.about,
        )


def shipped_models() -> tuple[AppearanceModel, ...]:
    """Give the models that come with the tracker, one a mirror.

    Raises:
        BadInput: none has been trained yet.
    """
    found = tuple(AppearanceModel.load(path) for path in sorted(NETWORKS.glob("*.json")))
    if not found:
        raise BadInput(
            f"tracker panoramic-paper: there is no network in {NETWORKS.name} yet; "
            "`peopleboy train-distance --ship` makes one"
        )
    return found


def ship(model: AppearanceModel, scenario: str) -> Path:
    """Put a model among those that come with the tracker, in place of the one for the same mirror."""
    NETWORKS.mkdir(exist_ok=True)
    for path in NETWORKS.glob("*.json"):
        if not AppearanceModel.load(path).view.refusal(model.view):
            path.unlink()
    path = NETWORKS / f"{scenario}.json"
    model.save(path)
    return path
