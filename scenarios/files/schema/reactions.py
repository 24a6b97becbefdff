"""How people take to the robot: what they do when it comes near, and leading it."""

from __future__ import annotations

from typing import Literal

from pydantic import ConfigDict, Field, model_validator

from peopleboy.scenarios.files.schema.values import Strict
from peopleboy.sim.people.reaction import FROM_M, KEEP_M, LASTS_S, USUAL, WORDS, Lead, Way


class ReactionSpec(Strict):
    """What a person does when the robot comes near, while nothing hides it; again at each encounter."""

    model_config = ConfigDict(serialize_by_alias=True)

    to: Literal["robot"] = Field(default="robot", description="to whom")
    way: Way = Field(
        alias="as",
        description="`ignores`: neither looks nor makes way, and stops only where it would walk into the "
        "robot; `makes_way`: walks round it, steps aside for one that comes, and looks at it; `curious`: "
        "walks up to it, looks at it for a while, and goes on; `wary`: keeps clear of it, walks away from "
        "one that comes nearer, and looks back at it; `blocks`: steps into its way, stands before it for a "
        "while, and goes on; `surprised`: stops and looks at it for a while, and goes on",
    )
    from_m: float | None = Field(
        default=None,
        ge=FROM_M[0],
        le=FROM_M[1],
        description="distance at which an encounter begins; it ends 1 m farther off; left out, 3 of who is "
        "surprised, 4 of who makes way or blocks, 5 of who is curious or wary; who ignores takes none",
    )
    keep_m: float | None = Field(
        default=None,
        ge=KEEP_M[0],
        le=KEEP_M[1],
        description="distance kept from the robot's middle, at least by who makes way (left out, 1.2) or is "
        "wary (2.5), about by who is curious (1.2) or blocks (1.0); others take none",
    )
    lasts_s: float | None = Field(
        default=None,
        ge=LASTS_S[0],
        le=LASTS_S[1],
        description="how long it looks (curious; left out, 5), is in the way (blocks; 5) or stands "
        "(surprised; 2.5); others take none",
    )

    @model_validator(mode="after")
    def _takes_these(self) -> ReactionSpec:
        for key, value in self.distances().items():
            if value is not None and key not in USUAL[self.way]:
                raise ValueError(f"{key} {value:g}: a person who {WORDS[self.way]} takes none; leave it out")
        whole = dict(USUAL[self.way]) | {k: v for k, v in self.distances().items() if v is not None}
        if whole.get("keep_m", 0.0) > whole.get("from_m", 0.0):
            raise ValueError(f"keep_m {whole['keep_m']:g} must be at most from_m, {whole['from_m']:g}")
        return self

    def distances(self) -> dict[str, float | None]:
        """What is said beyond the word; None where that is left out."""
        return {"from_m": self.from_m, "keep_m": self.keep_m, "lasts_s": self.lasts_s}


class LeadSpec(Strict):
    """How a person leads the robot along its path: it looks back now and then, and waits, calling."""

    whom: Literal["robot"] = Field(default="robot", description="who is led")
    waits_beyond_m: float = Field(
        default=Lead().waits_beyond_m,
        ge=FROM_M[0],
        le=FROM_M[1],
        description="a robot farther away has fallen behind: the person stops, turns to it and calls it",
    )
    goes_on_within_m: float = Field(
        default=Lead().goes_on_within_m,
        ge=FROM_M[0],
        le=FROM_M[1],
        description="the person goes on when it is so near again",
    )
    at_most_s: float = Field(
        default=Lead().at_most_s,
        ge=LASTS_S[0],
        le=LASTS_S[1],
        description="after which the person goes on without it, until it has been near again",
    )

    @model_validator(mode="after")
    def _waits_farther_off(self) -> LeadSpec:
        if self.goes_on_within_m >= self.waits_beyond_m:
            raise ValueError(
                f"goes_on_within_m {self.goes_on_within_m:g} must be less than waits_beyond_m, "
                f"{self.waits_beyond_m:g}"
            )
        return self
