"""Export the networks of the trackers to ONNX, with a model card for their inputs and outputs."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from importlib.metadata import version
from pathlib import Path
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray

from peopleboy.bad_input import BadInput
from peopleboy.scenarios.run_folder.atomic_output import writing_to
from peopleboy.tracker.networks.inference import CHANNELS, CropNetwork, DenseNetwork
from peopleboy.tracker.networks.mask_network import BLOCK, DILATIONS, INPUTS, MaskNetwork
from peopleboy.tracker.networks.weights_archive import SHIPPED
from peopleboy.tracker.reproductions.panoramic.distance_network import (
    CUES,
    HIGH,
    LOW,
    DistanceModel,
    file_name,
)
from peopleboy.tracker.sensors.panorama.people_foreground import ForegroundModel, shipped_foreground
from peopleboy.tracker.sensors.panorama.place_model import PlaceModel
from peopleboy.tracker.sensors.thermal.detector.rescoring import BoxRefinementNetwork, RescoringNetwork

_OPSET: Final = 17
_BATCH: Final = "N"


@dataclass(slots=True)
class _Graph:
    """Builder of a graph; each method adds operations and returns the name of their result."""

    helper: Any
    tensor: Callable[[NDArray[Any], str], Any]
    nodes: list[Any] = field(default_factory=list)
    weights: list[Any] = field(default_factory=list)

    def constant(self, array: NDArray[Any]) -> str:
        """Add an array."""
        name = f"c{len(self.weights)}"
        self.weights.append(self.tensor(np.ascontiguousarray(array), name))
        return name

    def __call__(self, operation: str, *inputs: str, to: str = "", **attributes: Any) -> str:
        """Add an operation."""
        name = to or f"v{len(self.nodes)}"
        self.nodes.append(self.helper.make_node(operation, list(inputs), [name], **attributes))
        return name

    def dense(self, inputs: str, network: DenseNetwork, to: str) -> str:
        """Add dense layers with rectified linear units between them."""
        *hidden, (weights, bias) = network.layers
        for inner, inner_bias in hidden:
            inputs = self("Gemm", inputs, self.constant(inner), self.constant(inner_bias))
            inputs = self("Relu", inputs)
        return self("Gemm", inputs, self.constant(weights), self.constant(bias), to=to)


@dataclass(frozen=True, slots=True)
class OnnxExport:
    """Specification of the export of a network.

    Attributes:
        summary: purpose of the network.
        inputs, outputs: shape and meaning by name; a word in a shape is a variable size.
        about: description of its training.
        build: function that adds the operations to a graph.
    """

    summary: str
    inputs: Mapping[str, tuple[tuple[str | int, ...], str]]
    outputs: Mapping[str, tuple[tuple[str | int, ...], str]]
    about: Mapping[str, str]
    build: Callable[[_Graph], object]


def _crop_network(network: CropNetwork, summary: str, meaning: str) -> OnnxExport:
    shape, weights = network.ARCHITECTURE, network.weights

    def build(graph: _Graph) -> None:
        planes, depth = graph("Transpose", "crops", perm=[0, 3, 1, 2]), CHANNELS
        rows, columns = shape.crop.rows, shape.crop.columns
        for number, (side, stride, count) in enumerate(shape.layers):
            kernel = weights[f"kernel{number}"].reshape(side, side, depth, count).transpose(3, 2, 0, 1)
            padding = [side // 2] * 4
            bias = graph.constant(weights[f"bias{number}"])
            options: dict[str, Any] = {
                "kernel_shape": [side, side],
                "strides": [stride, stride],
                "pads": padding,
            }
            planes = graph("Relu", graph("Conv", planes, graph.constant(kernel), bias, **options))
            depth, rows, columns = count, -(-rows // stride), -(-columns // stride)
        last = graph("Transpose", planes, perm=[0, 2, 3, 1])
        flat = graph("Reshape", last, graph.constant(np.array([-1, rows * columns * depth], np.int64)))
        layers = [(weights["all"], weights["all_bias"]), (weights["last"], weights["last_bias"])]
        graph.dense(graph("Concat", flat, "features", axis=1), DenseNetwork(layers), "outputs")

    crop = (_BATCH, shape.crop.rows, shape.crop.columns, CHANNELS)
    return OnnxExport(
        summary,
        {
            "crops": (crop, "grey, change of grey, and mask of the image area, normalised"),
            "features": ((_BATCH, shape.features), "scalar features of each crop, such as the box's height"),
        },
        {"outputs": ((_BATCH, shape.outputs), meaning)},
        network.about,
        build,
    )


def _place_model(model: PlaceModel) -> OnnxExport:
    heads = {"presence": model.presence, "place": model.place, "doubt": model.doubt}
    meanings = {
        "presence": "log odds of a person",
        "place": "offset of the person [m]",
        "doubt": "logarithms of the offset's standard deviations [m]",
    }

    def build(graph: _Graph) -> None:
        for name, network in heads.items():
            graph.dense("inputs", network, name)

    size = len(model.presence.layers[0][0])
    outputs = {
        name: ((_BATCH, len(network.layers[-1][1])), meanings[name]) for name, network in heads.items()
    }
    inputs = {"inputs": ((_BATCH, size), "patch of the panorama's foreground, and the distance in two forms")}
    return OnnxExport("Position of a person in a patch of a panorama.", inputs, outputs, model.about, build)


def _foreground(model: ForegroundModel) -> OnnxExport:
    network: MaskNetwork = model.network
    rows, units = network.rows.shape
    columns = model.view.width_px // BLOCK

    def wrapped(graph: _Graph, planes: str, by: int) -> str:
        """Pad the image across its seam on both sides."""
        axis, step = graph.constant(np.array([3], np.int64)), graph.constant(np.array([1], np.int64))

        def part(first: int, last: int) -> str:
            ends = (graph.constant(np.array([at], np.int64)) for at in (first, last))
            return graph("Slice", planes, *ends, axis, step)

        return graph("Concat", part(columns - by, columns), planes, part(0, by), axis=3)

    def build(graph: _Graph) -> None:
        first = graph.constant(network.first.T[:, :, None, None])
        planes = graph("Conv", "squares", first, kernel_shape=[1, 1])
        planes = graph("Relu", graph("Add", planes, graph.constant(network.rows.T[None, :, :, None])))
        for weights, bias, by in zip(network.between, network.biases, DILATIONS, strict=True):
            kernel = graph.constant(weights.reshape(3, 3, units, units).transpose(3, 2, 0, 1))
            options: dict[str, Any] = {"kernel_shape": [3, 3], "dilations": [by, by], "pads": [by, 0, by, 0]}
            grown = graph("Conv", wrapped(graph, planes, by), kernel, graph.constant(bias), **options)
            planes = graph("Add", planes, graph("Relu", grown))
        last = graph.constant(network.last.T[:, :, None, None])
        both = graph("Concat", planes, "squares", axis=1)
        evidence = graph("Conv", both, last, graph.constant(network.bias), kernel_shape=[1, 1])
        whole = graph("DepthToSpace", evidence, blocksize=BLOCK, mode="DCR")
        graph("Sigmoid", whole, to="probability")

    return OnnxExport(
        "Segmentation of people in a panorama.",
        {"squares": ((_BATCH, INPUTS, rows, columns), "features of each square of 4 x 4 pixels")},
        {"probability": ((_BATCH, 1, BLOCK * rows, BLOCK * columns), "probability that a pixel is a person")},
        model.about,
        build,
    )


def _distance(model: DistanceModel) -> OnnxExport:
    network = model.network
    least, span = network.cue_ranges[:, 0], np.diff(network.cue_ranges)[:, 0]
    nearest, farthest = network.distance_range_m
    gain_m = (farthest - nearest) / (HIGH - LOW)
    # The scaling of the cues is a part of the first layer.
    weights = network.hidden[:, :CUES] / span
    bias = network.hidden[:, CUES] - weights @ least

    def build(graph: _Graph) -> None:
        def constant(array: NDArray[Any]) -> str:
            return graph.constant(np.asarray(array, np.float32))

        units = graph("Sigmoid", graph("Gemm", "cues", constant(weights.T), constant(bias)))
        last = graph("Gemm", units, constant(network.output[:-1, None]), constant(network.output[-1:]))
        scaled = graph("Mul", graph("Sigmoid", last), constant(np.array([gain_m])))
        graph("Add", scaled, constant(np.array([nearest - LOW * gain_m])), to="distance")

    return OnnxExport(
        "Distance of a person from the shape in a panorama, for one mirror.",
        {"cues": ((_BATCH, CUES), "width of the person, gap below the feet and area [px]")},
        {"distance": ((_BATCH, 1), "distance of the person [m]")},
        model.about,
        build,
    )


NETWORKS: Final[Mapping[str, Callable[[], OnnxExport]]] = {
    "rescoring": lambda: _crop_network(
        RescoringNetwork.shipped(),
        "Second stage of the people detector: corrects scores and boxes of the cascade.",
        "log odds and offsets of the box, before `RescoringNetwork.predict` scales them",
    ),
    "box-refinement": lambda: _crop_network(
        BoxRefinementNetwork.shipped(),
        "Last stage of the people detector: corrects boxes.",
        "offsets of the box, before `BoxRefinementNetwork.predict` scales them",
    ),
    "places": lambda: _place_model(PlaceModel.load()),
    "foreground": lambda: _foreground(shipped_foreground()),
    "distance-room_long": lambda: _distance(DistanceModel.load(SHIPPED / file_name("room_long"))),
    "distance-room_narrow": lambda: _distance(DistanceModel.load(SHIPPED / file_name("room_narrow"))),
}
"""The networks that can be exported, by the name of their training command."""


def export_onnx(names: tuple[str, ...], out: Path) -> list[Path]:
    """Write NAME.onnx for each network, and one model card, README.md.

    Args:
        names: names of networks; empty for all.
        out: output folder.

    Returns:
        The paths of the files.

    Raises:
        BadInput: an unknown name, or the package onnx is missing.
    """
    try:
        import onnx
        from onnx import helper, numpy_helper
    except ImportError as error:
        raise BadInput("export-onnx: needs onnx: pip install 'peopleboy[onnx]'") from error
    for name in names:
        if name not in NETWORKS:
            raise BadInput(f"export-onnx: unknown network {name!r}; choose from {', '.join(NETWORKS)}")
    exports = {name: NETWORKS[name]() for name in names or NETWORKS}
    paths = []
    with writing_to(out):
        out.mkdir(parents=True, exist_ok=True)
        for name, export in exports.items():
            graph = _Graph(helper, numpy_helper.from_array)
            export.build(graph)
            ends = [
                [
                    helper.make_tensor_value_info(key, onnx.TensorProto.FLOAT, shape)
                    for key, (shape, _) in each
                ]
                for each in (export.inputs.items(), export.outputs.items())
            ]
            made = helper.make_model(
                helper.make_graph(graph.nodes, name, ends[0], ends[1], initializer=graph.weights),
                producer_name="PeopleBoy",
                producer_version=version("peopleboy"),
                opset_imports=[helper.make_opsetid("", _OPSET)],
                ir_version=8,
            )
            helper.set_model_props(made, {"summary": export.summary, **export.about})
            onnx.checker.check_model(made, full_check=True)
            paths.append(out / f"{name}.onnx")
            onnx.save(made, paths[-1])
        paths.append(out / "README.md")
        paths[-1].write_text("\n".join(_card(exports)), encoding="utf-8")
    return paths


def _card(exports: Mapping[str, OnnxExport]) -> Iterator[str]:
    yield from ("---", "license: mit", "library_name: onnx", "tags: [people-tracking, thermal]", "---")
    yield f"# Networks of PeopleBoy {version('peopleboy')}\n"
    yield "Parts of PeopleBoy's trackers, trained on rendered images only. Prepare inputs like the trackers."
    yield "Outputs agree with those of PeopleBoy to about 1e-4.\n"
    for name, export in exports.items():
        yield f"## {name}.onnx\n\n{export.summary}\n"
        yield "| tensor | shape | meaning |\n|---|---|---|"
        for kind, ends in (("input", export.inputs), ("output", export.outputs)):
            for key, (shape, meaning) in ends.items():
                yield f"| {kind} `{key}` | {' x '.join(map(str, shape))} | {meaning} |"
        yield "\nTraining:\n"
        yield from (f"- {key}: {value}" for key, value in export.about.items())
        yield ""
