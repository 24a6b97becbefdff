"""From what random worlds are drawn, from the distribution itself."""

from __future__ import annotations

from docs.generate.markdown import table
from peopleboy.scenarios.random_worlds.distribution import ODDS, RANGES, SHARES
from peopleboy.sim.people.body.manner import HOLDS, SPREADS
from peopleboy.sim.people.body.outfit import CARRIED


def distribution() -> str:
    """List ranges, shares and odds."""
    ranges = [(each.what, f"{each.low:g} to {each.high:g} {each.unit}".rstrip()) for each in RANGES.values()]
    shares = [
        (
            name.replace("_", " "),
            ", ".join(f"{word.replace('_', ' ')} {share:.0%}" for word, share in of.items()),
        )
        for name, of in SHARES.items()
    ]
    odds = [(what, f"{share:.0%}") for share, what in ODDS.values()]
    return "\n\n".join(
        (
            table(("drawn evenly", "from where to where"), ranges),
            table(("drawn from a few", "how often each"), shares),
            table(("what may be so", "how often"), odds),
        )
    )


def bearings() -> str:
    """List how people walk and hold themselves, what their hands do, and what they carry."""
    spreads = [
        (each.what, f"{each.mean:g} {each.unit}".rstrip(), f"{each.deviation:g} {each.unit}".rstrip())
        for each in SPREADS.values()
    ]
    shares = [
        (name, ", ".join(f"{word.replace('_', ' ')} {share:.0%}" for word, share in of))
        for name, of in (("a hand", HOLDS.items()), ("carried, of those without a `bag`", CARRIED.items()))
    ]
    return "\n\n".join(
        (
            table(("normal, no further than two deviations", "mean", "deviation"), spreads),
            table(("drawn from a few", "how often each"), shares),
        )
    )
