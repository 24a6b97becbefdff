from __future__ import annotations

import pytest

from peopleboy.studies.training.look_learning import closer_look_loss, second_look_loss
from peopleboy.tracker.proposals.looks.closer_look import CloserLook
from peopleboy.tracker.proposals.looks.network import Layer
from peopleboy.tracker.proposals.looks.second_look import SecondLook

LAYERS = (Layer(5, 4, 8), Layer(3, 1, 12), Layer(3, 2, 8))


@pytest.fixture
def small(monkeypatch: pytest.MonkeyPatch) -> None:
    """Networks that are taught in a second, as those that are shipped are in hours."""
    for look, losses, name in (
        (SecondLook, second_look_loss, "SECOND_LOOK"),
        (CloserLook, closer_look_loss, "CLOSER_LOOK"),
    ):
        form = look.FORM._replace(layers=LAYERS, units=24)
        monkeypatch.setattr(look, "FORM", form)
        monkeypatch.setattr(losses, name, getattr(losses, name)._replace(form=form))
