"""Networks in files of TensorFlow and TensorFlow.js, opened as sessions that run them."""

from collections.abc import Mapping
from typing import Any

import numpy as np
import tensorflow as tf
from google.protobuf.json_format import ParseDict


def open_frozen_graph(content: bytes) -> Any:
    """Open a frozen graph, which contains its weights."""
    graph = tf.compat.v1.GraphDef()
    graph.ParseFromString(content)
    return _open(graph)


def open_graph_model(model: Mapping[str, Any], weights: bytes) -> Any:
    """Open a graph model of TensorFlow.js.

    Args:
        model: content of its JSON file: the graph without weights, and type and shape of each weight.
        weights: content of its only file of weights, which may be stored as floats of 16 bits.
    """
    graph = ParseDict(model["modelTopology"], tf.compat.v1.GraphDef())
    constants = {node.name: node.attr for node in graph.node if node.op == "Const"}
    (group,) = model["weightsManifest"]
    start = 0
    for weight in group["weights"]:
        stored = np.dtype(weight.get("quantization", weight)["dtype"])
        count = int(np.prod(weight["shape"], dtype=np.int64))
        values = np.frombuffer(weights, stored, count, start).reshape(weight["shape"])
        start += values.nbytes
        constant = constants[weight["name"]]
        # The graph says the type: TensorFlow.js stores integers of 64 bits in 32.
        kind = tf.dtypes.as_dtype(constant["dtype"].type)
        constant["value"].tensor.CopyFrom(tf.make_tensor_proto(values, kind, weight["shape"]))
    return _open(graph)


def _open(graph: Any) -> Any:
    session = tf.compat.v1.Session(graph=tf.Graph())
    with session.graph.as_default():
        tf.import_graph_def(graph, name="")
    return session
