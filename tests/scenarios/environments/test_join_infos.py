import numpy as np
from gymnasium.vector import VectorEnv

from peopleboy.scenarios.environments.vector_environment import join_infos


def assert_alike(ours, theirs):
    assert list(ours) == list(theirs)
    for key, one in ours.items():
        other = theirs[key]
        if isinstance(one, dict):
            assert_alike(one, other)
        else:
            assert one.dtype == other.dtype
            assert one.tolist() == other.tolist()


def test_infos_are_joined_as_gymnasium_joins_them():
    infos = [
        {"reward": {"keep": 0.5, "lost": -10.0}, "seed": 3, "events": (("seen", "ann"),)},
        {"reward": {"keep": 0.25, "lost": 0.0}, "seed": 4, "events": ()},
        {"reward": {"keep": 0.0, "lost": 0.0}, "seed": 5, "events": (), "metrics": {"comfort": {"a": 1.5}}},
    ]
    theirs = VectorEnv()
    theirs.num_envs = len(infos)
    expected = {}
    for number, info in enumerate(infos):
        expected = theirs._add_info(expected, info, number)
    assert_alike(join_infos(infos), expected)
    assert np.array_equal(expected["_metrics"], [False, False, True])
