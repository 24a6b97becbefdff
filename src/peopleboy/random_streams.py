"""One named stream of random numbers per noise source, all from one seed."""

import hashlib

import numpy as np


def stream(seed: int, name: str) -> np.random.Generator:
    """Open the random stream of one noise source.

    The same seed and name give the same numbers on every machine; a new source never changes the numbers
    of another, because each stream is keyed by its own name.

    Args:
        seed: the run's seed, 0 or more; 0 is a seed like any other.
        name: the source, such as "thermal.noise".
    """
    digest = hashlib.sha256(name.encode()).digest()
    return np.random.default_rng([seed, *np.frombuffer(digest, np.uint32).tolist()])
