from benchmarks.tracker_ablation import STEPS, adopt, differing, step_of, variants
from peopleboy.tracker.reproductions.contour.variants import CONTOUR, THESIS


def test_all_steps_together_lead_from_the_thesis_tracker_to_the_default_one():
    steps = [config for name, config in variants() if name.startswith("+ ")]
    assert len(steps) == len(STEPS)
    assert steps[-1] == CONTOUR
    assert len(set(map(repr, steps))) == len(steps)


def test_every_setting_in_which_they_differ_belongs_to_a_step():
    settings = list(differing(THESIS, CONTOUR))
    assert {step_of(name) for name in settings} == set(STEPS)
    assert adopt(THESIS, CONTOUR, settings) == CONTOUR
