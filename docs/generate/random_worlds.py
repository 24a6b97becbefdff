"""From what random worlds are drawn, from the distribution itself."""

from __future__ import annotations

from docs.generate.markdown import table
from peopleboy.scenarios.random_worlds.distribution import ODDS, RANGES, SHARES


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
