"""The plan and its draws: all from the seed, every name, nothing told by names."""

import json
from collections import Counter
from itertools import pairwise

import numpy as np

from harness.proof.detection import LOSSES
from harness.proof.drawing import drawn, name_of, probes_of, sealed_answers
from harness.proof.plan import CONTROL, DETECTION, FULL, OUTSIDE, PAIR, SHORT, SINGLE, Job, Sizes, plan
from harness.proof.plant.effects import ALIENS, KINDS, compatible

SEED = 2**127 + 12345
KNOCK = Job(3, SINGLE, "plant", ("impulse",), "decay", "mixed")


def test_every_name_occurs_as_often_as_any_other_give_or_take_one() -> None:
    jobs = plan(FULL, SEED)
    assert Counter(job.group for job in jobs) == {SINGLE: 300, CONTROL: 300, PAIR: 60, OUTSIDE: 60, DETECTION: 72}
    singles = Counter(job.kinds[0] for job in jobs if job.group == SINGLE)
    assert set(singles) == set(KINDS)
    assert set(singles.values()) == {11, 12}
    assert Counter(job.kinds[0] for job in jobs if job.group == OUTSIDE) == dict.fromkeys(ALIENS, 10)
    settings = Counter(job.setting for job in jobs if job.group == CONTROL)
    assert settings == {"decay": 270, "driven": 12, "pendulum": 9, "axis": 9}
    pairs = [job.kinds for job in jobs if job.group == PAIR]
    assert len(set(pairs)) == 60
    assert all(len(pair) == 2 and compatible(*pair) for pair in pairs)


def test_the_plan_follows_from_the_seed_in_an_order_that_tells_nothing() -> None:
    assert plan(SHORT, SEED) == plan(SHORT, SEED) != plan(SHORT, SEED + 1)
    jobs = plan(FULL, SEED)
    assert [job.index for job in jobs] == list(range(792))
    # were groups together, neighbours would be alike far more often than by chance (0.30)
    alike = np.mean([a.group == b.group for a, b in pairwise(jobs)])
    assert alike < 0.45


def test_engines_make_one_in_eight_each_of_what_they_can() -> None:
    jobs = plan(FULL, SEED)
    for group, most in ((SINGLE, 300), (CONTROL, 270), (PAIR, 60), (OUTSIDE, 60)):
        sources = Counter(job.source for job in jobs if job.group == group)
        assert sources["mujoco"] in (sources["pybullet"], sources["pybullet"] + 1)
        assert 0.06 * most < sources["mujoco"] <= most / 8
    assert {job.setting for job in jobs if job.source != "plant"} == {"decay"}


def test_the_short_form_has_24_and_is_no_evidence() -> None:
    assert SHORT.total == 24
    assert {job.setting for job in plan(SHORT, SEED)} == {"decay"}
    assert not SHORT.is_evidence
    assert FULL.is_evidence
    assert not Sizes(300, 300, 60, 59).is_evidence
    assert Sizes(400, 300, 60, 60).is_evidence


def test_a_draw_is_made_again_from_seed_and_place() -> None:
    first = drawn(SEED, KNOCK)
    assert drawn(SEED, KNOCK) == first
    assert first.name == name_of(SEED, 3)
    assert first.answer["mechanisms"] == ["impulse"]
    other = drawn(SEED + 1, KNOCK)
    assert other.name != first.name
    assert other.recording != first.recording
    assert json.loads(json.dumps(first.answer)) == first.answer


def test_a_level_of_the_detection_curve_says_what_it_is() -> None:
    job = Job(7, DETECTION, "plant", ("quadratic-drag",), "decay", "white", 3, 1)
    answer = drawn(SEED, job).answer
    assert (answer["group"], answer["source"], answer["series"], answer["loss"]) == ("detection", "plant", 3, LOSSES[1])
    assert answer["mechanisms"] == ["quadratic-drag"]


def test_lines_of_a_recording_that_are_published_run_from_first_to_last() -> None:
    case = drawn(SEED, KNOCK)
    lines, kept = case.recording.decode().splitlines(), probes_of(case.recording)
    assert len(kept) == 13
    assert (kept[0], kept[1], kept[-1]) == (lines[0], lines[1], lines[-1])


def test_salts_follow_from_the_seed_and_differ() -> None:
    answers = {"a": {"index": 0}, "b": {"index": 1}}
    sealed = sealed_answers(SEED, answers)
    assert sealed == sealed_answers(SEED, answers)
    assert len({one.salt for one in sealed.values()}) == 2
    assert sealed["a"].commitment != sealed_answers(SEED + 1, answers)["a"].commitment
