from dataclasses import replace

import numpy as np
import pytest

from peopleboy.tracker.frame import THERMAL, Frame
from peopleboy.tracker.reproductions.contour.box_interaction import regions_of
from peopleboy.tracker.reproductions.contour.measurement.likelihood import ContourModel, covered_by
from peopleboy.tracker.reproductions.contour.occlusion.coasting import LOST_FRAMES
from peopleboy.tracker.reproductions.contour.occlusion.depth_order import OrderContext
from peopleboy.tracker.reproductions.contour.occlusion.occlusion_policy import make_policy
from peopleboy.tracker.reproductions.contour.particle_filter import Belief, view_frame
from peopleboy.tracker.reproductions.contour.particles import equally_weighted
from peopleboy.tracker.reproductions.contour.tracked_person import SIZE, TrackedPerson
from peopleboy.tracker.reproductions.contour.variants import CONTOUR, THESIS_OCCLUSION
from peopleboy.tracker.track import Status
from tests.helpers.images.drawn_people import blank


def person(number, x, h):
    state = np.array([x, 120 + 0.36 * h, 0.38 * h, h, 0, 0, 0, 0, 0])
    cloud = equally_weighted(np.repeat(state[None], 50, axis=0).astype(np.float32))
    belief = Belief(cloud, cloud, state, 0.9, 1.0)
    return TrackedPerson(
        number, 0.0, belief, state, np.array([30.0, 0.0]), 190.0, state[SIZE], seen_frames=30
    )


VIEW = view_frame(
    Frame(images={THERMAL: blank()}, time_s=1.0),
    1 / 15,
    ContourModel.build((240, 320), CONTOUR.contour),
    CONTOUR,
)


def judged(config, behind, *front):
    view = view_frame(
        Frame(images={THERMAL: blank()}, time_s=1.0),
        1 / 15,
        ContourModel.build((240, 320), config.contour),
        config,
    )
    states = [one.belief.estimate for one in front]
    surroundings = OrderContext(
        front=front,
        others=regions_of(states, config),
        strength=np.zeros(len(front)),
        image=covered_by(view.image, states) if front else view.image,
    )
    return make_policy(config).judge(behind, behind.belief, surroundings, view, np.random.default_rng(0))


@pytest.mark.parametrize("config", [CONTOUR, THESIS_OCCLUSION])
def test_who_is_alone_is_tracked_and_who_overlaps_is_partly_hidden(config):
    assert judged(config, person(1, 160, 30)).status is Status.TRACKED
    beside = judged(config, person(1, 160, 30), person(2, 183, 40))
    assert beside.status is Status.PARTLY_OCCLUDED
    assert beside.occluder == 2


@pytest.mark.parametrize("config", [CONTOUR, THESIS_OCCLUSION])
def test_whose_head_is_covered_is_hidden_by_the_one_in_front(config):
    hidden = judged(config, person(1, 160, 20), person(2, 160, 70))
    assert hidden.status is Status.TOTALLY_OCCLUDED
    assert hidden.occluder == 2
    assert hidden.hidden_frames == 1
    assert hidden.hidden_s == pytest.approx(1 / 15)


def test_in_the_thesis_a_hidden_person_is_where_its_occluder_is():
    front = person(2, 165, 70)
    assert judged(THESIS_OCCLUSION, person(1, 160, 20), front).shown is front.shown


def test_in_ours_a_hidden_person_walks_on_with_the_velocity_that_it_had():
    hidden = judged(CONTOUR, person(1, 160, 20), person(2, 165, 70))
    assert hidden.shown[5] == 30.0
    assert hidden.belief.particles.state[:, 5].mean() == pytest.approx(30.0, abs=10)
    later = judged(CONTOUR, hidden, person(2, 165, 70))
    assert later.is_hidden
    assert later.hidden_frames == 2


def test_in_ours_a_hidden_person_keeps_its_height_and_its_feet_where_they_were():
    hidden = judged(CONTOUR, person(1, 160, 20), person(2, 165, 70))
    shrunk = replace(hidden, belief=person(1, 160, 14).belief)
    later = judged(CONTOUR, shrunk, person(2, 165, 70))
    assert later.shown[3] == 20
    assert later.shown[1] + 2.05 * 20 == pytest.approx(190.0)


def test_a_hidden_person_is_behind_those_who_cover_it_and_behind_nobody_where_it_would_be_seen():
    covered = judged(CONTOUR, judged(CONTOUR, person(1, 160, 20), person(2, 160, 70)), person(2, 160, 70))
    assert covered.is_behind
    in_the_open = judged(CONTOUR, replace(covered, shown=person(1, 60, 20).shown))
    assert in_the_open.is_hidden
    assert not in_the_open.is_behind


def test_looks_are_not_learnt_while_somebody_is_in_front():
    alone = judged(CONTOUR, person(1, 160, 30))
    beside = judged(CONTOUR, person(1, 160, 30), person(2, 183, 40))
    assert alone.appearance is not None
    assert beside.appearance is None


def test_who_is_lost_in_mid_image_is_hidden_by_something_unknown():
    lost = replace(person(1, 160, 30), missing=LOST_FRAMES - 1)
    gone = judged(CONTOUR, replace(lost, belief=replace(lost.belief, confidence=0.0)))
    assert gone.status is Status.TOTALLY_OCCLUDED
    assert gone.occluder is None


def test_with_the_thesis_nobody_is_hidden_by_what_is_unknown_or_remembered_who_was_not_hidden():
    lost = replace(person(1, 160, 30), missing=LOST_FRAMES - 1)
    gone = judged(THESIS_OCCLUSION, replace(lost, belief=replace(lost.belief, confidence=0.0)))
    assert not gone.is_hidden
    assert not make_policy(THESIS_OCCLUSION).remembers_lost(gone)
    assert make_policy(CONTOUR).remembers_lost(gone)


def test_in_the_thesis_the_remembered_stay_with_their_occluder_and_in_ours_they_walk_on():
    leader = person(1, 100.0, 30)
    walker = replace(person(2, 50.0, 30), occluder=1)
    walker.shown[5] = 30.0
    behind = make_policy(THESIS_OCCLUSION).whereabouts(walker, (leader,), VIEW)
    assert behind[0] == 100.0
    ahead = make_policy(CONTOUR).whereabouts(walker, (leader,), VIEW)
    assert ahead[0] == pytest.approx(50.0 + 30.0 / 15)


def test_the_samples_of_the_hidden_are_held_to_the_floor_by_ours_and_left_alone_by_the_thesis():
    hidden = replace(person(1, 160, 30), status=Status.TOTALLY_OCCLUDED)
    ours, theirs = make_policy(CONTOUR), make_policy(THESIS_OCCLUSION)
    motion = ours.motion_of(hidden)
    assert motion.noise_x / CONTOUR.motion.noise_x > motion.noise_y / CONTOUR.motion.noise_y
    assert theirs.motion_of(hidden) == THESIS_OCCLUSION.motion
    assert ours.keeps_off(hidden)
    assert not theirs.keeps_off(hidden)


@pytest.mark.parametrize(
    ("hidden_s", "spread_px", "is_behind", "is_shown"),
    [
        (0.2, 90.0, False, True),
        (0.4, 90.0, False, False),
        (0.7, 90.0, True, True),
        (0.9, 90.0, True, False),
        (9.0, 1.0, True, True),
    ],
)
def test_ours_shows_the_hidden_for_as_long_as_it_is_sure_where_they_are(
    hidden_s, spread_px, is_behind, is_shown
):
    lost = replace(person(1, 160, 30), hidden_s=hidden_s, is_behind=is_behind)
    lost = replace(lost, belief=replace(lost.belief, uncertainty_px2=spread_px**2))
    region = regions_of([lost.shown], CONTOUR)[0]
    assert make_policy(CONTOUR).is_shown(lost, region, VIEW) is is_shown
    assert make_policy(THESIS_OCCLUSION).is_shown(lost, region, VIEW)
    showing = replace(CONTOUR, occlusion=replace(CONTOUR.occlusion, shows_only_sure=False))
    assert make_policy(showing).is_shown(lost, region, VIEW)
