"""Generate the tables of the distribution of random worlds."""

from __future__ import annotations

from docs.generate.markdown import table
from peopleboy.scenarios.random_worlds.distribution import ODDS, RANGES, SHARES
from peopleboy.sim.people.body.outfit import CARRIED
from peopleboy.sim.people.motion.manner import HOLDS, SPREADS


def distribution() -> str:
    """List uniform ranges, categorical shares and event probabilities."""
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
            table(("uniform distribution", "range"), ranges),
            table(("categorical distribution", "probabilities"), shares),
            table(("event", "probability"), odds),
        )
    )


def bearings() -> str:
    """List the distributions of gait, posture, hands and carried items."""
    spreads = [
        (each.what, f"{each.mean:g} {each.unit}".rstrip(), f"{each.deviation:g} {each.unit}".rstrip())
        for each in SPREADS.values()
    ]
    shares = [
        (name, ", ".join(f"{word.replace('_', ' ')} {share:.0%}" for word, share in of))
        for name, of in (
            ("position of a hand", HOLDS.items()),
            ("item carried by people without a `bag`", CARRIED.items()),
        )
    ]
    return "\n\n".join(
        (
            table(
                ("normal distribution, clipped at two standard deviations", "mean", "standard deviation"),
                spreads,
            ),
            table(("categorical distribution", "probabilities"), shares),
        )
    )
