from __future__ import annotations

import os
from typing import Any

import pytest
from hypothesis import settings

# What is taught in a moment is not worth the seconds that make the steps of teaching fast.
os.environ.setdefault(
    "XLA_FLAGS", "--xla_backend_optimization_level=0 --xla_llvm_disable_expensive_passes=true"
)

# A busy machine is no failure, and a change is judged by the same examples as the one before it;
# HYPOTHESIS_PROFILE=explore looks for new ones, and more.
settings.register_profile("repeat", deadline=None, derandomize=True, max_examples=50)
settings.register_profile("explore", deadline=None)
settings.load_profile(os.environ.get("HYPOTHESIS_PROFILE", "repeat"))


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Put files into the order in which workers take them."""
    if config.pluginmanager.has_plugin("xdist"):
        from tests.helpers.from_both_ends import from_both_ends

        items.sort(key=lambda item: from_both_ends(item.path))


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Let workers that get whole files begin at both ends; any other --dist is xdist's own."""
    if config.getoption("dist") != "loadfile":
        return None
    from tests.helpers.from_both_ends import FromBothEnds  # xdist may not be there

    return FromBothEnds(config, log)
