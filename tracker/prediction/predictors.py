"""The predictors by name."""

from typing import TYPE_CHECKING, Final

from peopleboy.bad_input import BadInput
from peopleboy.registry import Entry, Registry
from peopleboy.wording import hint

if TYPE_CHECKING:
    from peopleboy.tracker.prediction.tracked_people import Predictor

PREDICTORS: Final = Registry(
    "predictor",
    "peopleboy.predictors",
    {
        "constant-velocity": Entry(
            "peopleboy.tracker.prediction.constant_velocity:ConstantVelocity",
            "People walk on with the velocity of the motion filter.",
        ),
        "social-force": Entry(
            "peopleboy.tracker.prediction.social_force:SocialForce",
            "People give way to each other and to the robot.",
        ),
        "learned": Entry(
            "peopleboy.tracker.prediction.motion_network:shipped_network",
            "A small network that was trained on simulated walks.",
        ),
    },
)
"""All predictors by name."""


def make_predictor(name: str) -> "Predictor":
    """Make a predictor by name.

    Raises:
        BadInput: the name is unknown.
    """
    if name not in PREDICTORS:
        raise BadInput(f"unknown predictor {name!r}; {hint(name, PREDICTORS)}")
    made: Predictor = PREDICTORS[name]()
    return made
