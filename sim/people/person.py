"""Walking people: their movement, and the poses of their parts."""

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from peopleboy.sim.people.appearance.finisher import Finisher
from peopleboy.sim.people.body.anthropometry import HAND_LENGTH
from peopleboy.sim.people.body.bodies import RestBody
from peopleboy.sim.people.body.body_placement import (
    carry,
    least_stoop,
    put_on_floor,
    stoop,
    turn_arm,
)
from peopleboy.sim.people.body.body_shapes import (
    FRAME_INDEX,
)
from peopleboy.sim.people.body.clothes import ROOM_C
from peopleboy.sim.people.body.postures import DOWN, LOW, Posture
from peopleboy.sim.people.body.skeleton import BONE_INDEX, BONES
from peopleboy.sim.people.body_model import make_body_model
from peopleboy.sim.people.conducts import ConductSituation, Mind
from peopleboy.sim.people.motion.stance import POSTURES, STANCE, Builds, Gaze, Stances, hold, move_limbs
from peopleboy.sim.people.person_config import PersonConfig
from peopleboy.sim.people.walking.social_force import PlanarState
from peopleboy.sim.people.walking.walker import AS_PLANNED, Present, Surroundings, Walker, Wish

Array = NDArray[np.float64]
Shift = tuple[float, float, float]

_ARM = ("upper_arm", "forearm", "hand")
_FREE = 0.3  # share of a reach up to which the other hand may take over, while the person still turns
_AHEAD_M = 0.1  # the right hand also reaches this far to the left
# People who turn on the spot take small steps, as if the feet went round a circle.
_TURNING_RADIUS_M = 0.04


@dataclass(frozen=True, slots=True, eq=False)
class _Grasp:
    """Target of a hand: a world point (3,) [m], the progress towards it, and which hand."""

    point: Array
    share: float
    side: str


class Person:
    """A person that follows its script.

    A finisher adds detail to its appearance; a body gives it a skin.

    Attributes:
        model: what it is made of, which never changes.
        config: the settings.
        name: the configured name.
        stance: (1,) records STANCE, its current stance.
        walker: its movement over the floor.
    """

    def __init__(
        self,
        config: PersonConfig,
        rng: np.random.Generator,
        finisher: Finisher | None = None,
        body: RestBody | None = None,
        air_c: float = ROOM_C,
    ) -> None:
        self.config = config
        self.name = config.name
        self.model = make_body_model(config, rng, finisher, body, air_c)
        leave_s = math.inf if config.leave_s is None else config.leave_s
        self.walker = Walker(config.path, config.yields, self.model.radius_m, (config.enter_s, leave_s))
        self._mind = Mind([waypoint.at_m for waypoint in config.path], config.reacts, config.leads)
        self._wish = AS_PLANNED
        self._gaze = Gaze()
        self.stance = np.zeros(1, STANCE)
        self.stance["phase"], self.stance["sway_phase"] = rng.uniform(), rng.uniform()
        self.stance["blend"][0, POSTURES[self.walker.posture]] = 1.0
        self._build: Builds | None = None
        self._bones: Array | None = None
        self._bones_s = 0.0
        self._grasp: _Grasp | None = None

    @property
    def present(self) -> bool:
        """Whether it is in the world now."""
        return self.walker.present

    @property
    def position(self) -> Array:
        """(2,) [m] in the world frame."""
        return self.walker.position

    @property
    def heading(self) -> float:
        """[rad] direction of the body."""
        return self.walker.heading

    @property
    def velocity(self) -> Array:
        """(2,) [m/s] in the world frame."""
        return self.walker.velocity

    @property
    def posture(self) -> Posture:
        """The current or next posture."""
        return Posture.CALLING if self._wish.calls else self.walker.posture

    @property
    def progress(self) -> float:
        """Progress along its path: waypoints reached, plus the share of the path to the next one."""
        return self.walker.progress

    def step(
        self,
        time_s: float,
        dt_s: float,
        people: Present,
        robot: PlanarState | None,
        walls: Array,
        company: Iterable[float] = (),
    ) -> None:
        """Advance the person by a control step.

        Args:
            time_s: [s] at the start of the step.
            dt_s: [s] length of the step.
            people: all people who are present.
            robot: state of the robot, or None.
            walls: (K, 4) [m] rectangles min_x, min_y, max_x, max_y.
            company: progress of the others in its group who are present.
        """
        around = Surroundings(people=people, walker=people.rows.get(self.name, -1), robot=robot, walls=walls)
        if self.walker.come_or_go(time_s + dt_s):
            self._wish = self._make_up_mind(dt_s, around, company)
            self.walker.step(dt_s, around, self._wish)
            self._look(dt_s, robot)
        elif self.present:
            self.walker.enter(around)
        self.move_limbs(dt_s)

    def move_limbs(self, dt_s: float) -> None:
        """Advance gait and postures by a time step, after the person has moved."""
        walker, gait = self.walker, self.model.gait
        self.stance["time_s"] = walker.now_s
        if walker.has_moved:
            pace, turn_rate = pace_m_s(walker.velocity.tolist(), walker.turn_rate), walker.turn_rate
            move_limbs(
                self.stance, 0, gait.unit_stride_m, gait.root_scale, pace, turn_rate, walker.is_walking,
                POSTURES[self.posture], dt_s,
            )  # fmt: skip

    def _make_up_mind(self, dt_s: float, around: Surroundings, company: Iterable[float]) -> Wish:
        """Decide how to change the script, if at all."""
        walker, now = self.walker, None
        if around.robot is not None and (self.config.reacts or self.config.leads):
            now = ConductSituation(
                at=walker.position,
                heading=walker.heading,
                home=walker.home,
                is_walking=walker.is_walking,
                is_seated=walker.posture in DOWN,
                robot=around.robot,
                walls=around.walls,
            )
        return self._mind.wish(dt_s, now, walker.progress if self.config.group else 0.0, company)

    def _look(self, dt_s: float, robot: PlanarState | None) -> None:
        """Turn the head towards its target, or back to the front without one."""
        target = self._wish.gaze_at
        if target is None and robot is not None and self.walker.is_awaiting(robot):
            target = robot.position
        bearing = None
        if target is not None:
            x, y = target - self.position
            bearing = math.atan2(y, x) - self.heading
        self._gaze.update(dt_s, bearing)
        self.stance["gaze_rad"] = self._gaze.left_rad

    def reach_for(self, point: Array, share: float, halfway: Array) -> None:
        """Place a hand at a world point (3,) [m], or on the way there for a share below 1.

        The hand is the one on the side of the point `halfway` through the action.
        """
        held = self._grasp
        side = self._near_side(halfway) if held is None or held.share < _FREE else held.side
        self._grasp = _Grasp(point, share, side)
        self._bones = None

    def let_go(self) -> None:
        """Release both hands."""
        if self._grasp is not None:
            self._grasp = self._bones = None

    def palm(self, side: str) -> Array:
        """Return the (3,) [m] middle of a hand, world frame."""
        hand = self._world_bones()[BONE_INDEX[f"{side}_hand"]]
        palm: Array = hand[:3, 3] - 0.5 * HAND_LENGTH * self.config.height_m * hand[:3, 2]
        return palm

    def _near_side(self, point: Array) -> str:
        """Return the side of a point: right if it is ahead, but left if the person carries a bag."""
        dx, dy = point[:2] - self.position
        aside = math.cos(self.heading) * dy - math.sin(self.heading) * dx
        return "left" if self.config.bag or aside > _AHEAD_M else "right"

    @property
    def is_handling(self) -> bool:
        """Whether a hand is at a thing, or on the way there or back."""
        return self._grasp is not None

    @property
    def build(self) -> Builds:
        """Its constant properties."""
        if self._build is None:
            self._build = self.model.builds()
        return self._build

    def rebind(self, stance: Stances, builds: Builds) -> None:
        """Use other arrays for stance and build from now on; they must hold the same values already."""
        self.stance, self._build = stance, builds
        self.model.gait.rebind(builds.rotations[0], builds.sway[0])

    def poses(self) -> Array:
        """(P, 4, 4) world from part, in the order of the model's parts."""
        frame = self.model.frame
        poses = np.empty((len(self.model.parts), 4, 4))
        carry(self._world_bones(), frame.bone, frame.part_offset, poses)
        return poses

    def joints(self) -> Array:
        """(17, 3) [m] world points of the joints in COCO order, each inside the person's shapes."""
        poses = self._world_bones()[self.model.joint_bone]
        points: Array = np.einsum("pij,pj->pi", poses[:, :3, :3], self.model.joint_offset) + poses[:, :3, 3]
        return points

    def _world_bones(self) -> Array:
        """(18, 4, 4) world from bone, and from the floor frame under the person."""
        if self._bones is None or self._bones_s != self.walker.now_s:
            self._bones, self._bones_s = self._place(), self.walker.now_s
        return self._bones

    def _place(self) -> Array:
        """Place the bones above the floor, at the person's position and heading."""
        rotations, shift = self._pose()
        if self._grasp is not None:
            rotations, shift = self._reach(self._grasp, rotations, shift)
        return self._on_the_floor(rotations, shift)

    def _on_the_floor(self, rotations: Array, shift: Shift) -> Array:
        bones = np.empty((len(FRAME_INDEX), 4, 4))
        x, y = self.walker.position.tolist()
        frame = self.model.frame
        put_on_floor(rotations, frame.offsets, frame.supports, shift, (x, y, self.walker.heading), bones)
        return bones

    def _reach(self, grasp: _Grasp, rotations: Array, shift: Shift) -> tuple[Array, Shift]:
        """Stoop as far as the arm is too short, and turn the arm."""
        shoulder, chest = BONE_INDEX[f"{grasp.side}_upper_arm"], BONE_INDEX["chest"]

        def bent(share: float) -> tuple[Array, Shift]:
            turns, front = stoop(share)
            return rotations + turns, (shift[0] + front * self.config.height_m, *shift[1:])

        def gap_m(share: float) -> float:
            return float(np.linalg.norm(self._on_the_floor(*bent(share))[shoulder, :3, 3] - grasp.point))

        bend = 0.0
        blend = self.stance["blend"][0]
        if not any(blend[POSTURES[posture]] for posture in LOW):
            bend = grasp.share * least_stoop(gap_m, sum(self.model.arm_m))
        bowed, shift = bent(bend)
        bones = self._on_the_floor(bowed, shift)
        target = bones[chest, :3, :3].T @ (grasp.point - bones[shoulder, :3, 3])
        turned = turn_arm(bowed, grasp.side, target, self.model.arm_m)
        arm = [BONE_INDEX[f"{grasp.side}_{bone}"] for bone in _ARM]
        bowed[arm] += grasp.share * (turned - bowed)[arm]
        return bowed, shift

    def _pose(self) -> tuple[Array, Shift]:
        """Return (17, 3) [rad] rotation vectors and the shift of the body as returned by `hold`."""
        rotations = np.empty((len(BONES), 3))
        shift: Shift = hold(self.build, self.stance, 0, rotations)
        return rotations, shift


def pace_m_s(velocity: Sequence[float], turn_rad_s: float) -> float:
    """Return the speed of the feet over the floor at a velocity x, y [m/s] and a turn rate [rad/s]."""
    return math.hypot(*velocity, _TURNING_RADIUS_M * turn_rad_s)
