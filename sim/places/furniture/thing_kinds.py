"""Every kind of thing by name, with its usual size, temperature and colour."""

from __future__ import annotations

from peopleboy.sim.places.furniture import (
    appliances,
    furniture_pieces,
    household_pieces,
    street_pieces,
    warm_pieces,
)
from peopleboy.sim.places.pieces import Kind, kinds_of

# Listings and the schema show the kinds in this order.
_MODULES = (warm_pieces, furniture_pieces, household_pieces, appliances, street_pieces)
KINDS: dict[str, Kind] = {
    name: kind for module in _MODULES for name, kind in kinds_of(module.__name__).items()
}
