"""SIGKILL at random instants; `python -m benchmarks.robustness kills` does it 500 times."""

import sys

import pytest

from tests.robustness.kills import WORKS, Trials

pytestmark = [pytest.mark.slow, pytest.mark.skipif(sys.platform != "linux", reason="/proc and forkserver")]


@pytest.fixture(scope="module")
def trials(tmp_path_factory):
    return Trials(tmp_path_factory.mktemp("kills"))


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("name", WORKS)
def test_what_is_killed_leaves_a_sound_library_and_the_next_run_ends_where_an_undisturbed_one_does(trials, name, seed):
    assert trials.run(name, seed) == ""
