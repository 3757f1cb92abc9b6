"""Reading in processes: whatever a file does, it costs itself alone."""

import os
import signal
import time
from pathlib import Path

import numpy as np
import pytest

from encoders.errors import MotionSeekError, UnreadableMotion
from encoders.motion import Motion
from indexer.ingest.pool import Request, read_all
from indexer.read_motion import Reading, ReadMotion
from tests.indexer.folders import moving, write


def misbehave(path, fps, joint_map, up):
    """Stands in for reading; runs in the worker."""
    name = Path(path).name
    if name == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    if name == "exit":
        os._exit(3)
    if name == "hang":
        time.sleep(60)
    if name == "unreadable":
        raise UnreadableMotion(path, "it holds no motion")
    if name == "bug":
        raise KeyError("oops")
    if name == "memory":
        raise MemoryError
    if name == "chatty":
        print("{}", flush=True)
        os.write(1, b'{"frames": 1}\n')
    frames = int(name) if name.isdigit() else 3
    motion = Motion(np.full((frames, 22, 3), fps or 0, np.float32))
    reading = Reading(start=0.5, source_fps=120.0, source_frames=9, warnings=("a", "b"))
    return [ReadMotion(motion, "", f"rig of {name} {joint_map}", reading), ReadMotion(motion, "2")]


def read(names, *, jobs=1, patience=20.0, **options):
    requests = [Request(name, Path("/nowhere") / name, **options) for name in names]
    return dict(read_all(requests, jobs, patience=patience, target="tests.indexer.ingest.test_pool:misbehave"))


def test_a_motion_comes_back_as_it_was_read():
    found, second = read(["7"], fps=2.5, joint_map={"head": "Kopf"})["7"].clips
    assert found.rig == "rig of 7 {'head': 'Kopf'}"
    assert found.motion.joints.shape == (7, 22, 3)
    assert (found.motion.joints == 2.5).all()
    assert found.reading == Reading(start=0.5, source_fps=120.0, source_frames=9, warnings=("a", "b"))
    assert (second.part, len(second.motion)) == ("2", 7)


@pytest.mark.parametrize(
    ("name", "reason"),
    [
        ("unreadable", "it holds no motion"),
        ("bug", r"reading failed unexpectedly \(KeyError: 'oops'\)"),
        ("memory", "needs more memory than there is"),
        ("exit", r"reading it crashed \(exit code 3\)"),
        pytest.param("crash", r"reading it crashed \(SIGSEGV\)", marks=pytest.mark.skipif(os.name == "nt", reason="")),
    ],
)
def test_a_file_that_cannot_be_read_is_reported_and_the_rest_is_read(name, reason):
    found = read(["1", name, "2"])
    assert not found[name].clips
    import re

    assert re.search(reason, found[name].reason)
    assert len(found["1"].clips[0].motion) == 1
    assert len(found["2"].clips[0].motion) == 2


def test_a_file_that_hangs_is_given_up():
    began = time.monotonic()
    found = read(["hang", "1"], patience=1.0)
    assert found["hang"].reason == "reading took more than 1 s and was ended"
    assert found["1"].clips
    assert time.monotonic() - began < 50  # it would hang for 60


def test_what_a_reader_prints_does_no_harm():
    assert read(["chatty"])["chatty"].clips


def test_results_come_in_order_and_few_are_read_ahead():
    taken = []

    def requests():
        for number in range(1, 60):
            taken.append(number)
            yield Request(number, Path("/nowhere") / str(number))

    reading = read_all(requests(), 2, target="tests.indexer.ingest.test_pool:misbehave")
    assert [next(reading)[0] for _ in range(3)] == [1, 2, 3]
    assert len(taken) < 20
    assert [key for key, _ in reading] == list(range(4, 60))


def test_leaving_early_ends_the_processes():
    began = time.monotonic()
    requests = [Request(name, Path("/nowhere") / name) for name in ("1", "hang", "hang", "hang")]
    reading = read_all(requests, 2, target="tests.indexer.ingest.test_pool:misbehave")
    next(reading)
    reading.close()
    assert time.monotonic() - began < 50  # it would hang for 60


def test_nothing_in_the_working_directory_is_imported(tmp_path, monkeypatch):
    (tmp_path / "numpy.py").write_text("raise SystemExit('hijacked')")
    monkeypatch.chdir(tmp_path)
    path = write(tmp_path / "a.npy", 1)
    found = dict(read_all([Request("a", path)], 1))["a"]
    assert found.reason == ""
    assert len(found.clips[0].motion) == len(moving(1))
    assert found.clips[0].rig.startswith("pelvis-22-")


def test_processes_that_cannot_start_are_an_error_and_no_files_fault(monkeypatch):
    with pytest.raises(MotionSeekError, match="ends as it starts"):
        list(read_all([Request(1, Path("/nowhere/1"))], 1, target="tests.no_such_module:read"))
    monkeypatch.setattr("sys.executable", "/nowhere/python")
    with pytest.raises(MotionSeekError, match="cannot be started"):
        list(read_all([Request(1, Path("/nowhere/1"))], 1))


def test_a_joint_map_for_other_rigs_is_left_aside(tmp_path):
    path = write(tmp_path / "a.npy", 1)
    found = dict(read_all([Request("a", path, joint_map={"head": "Kopf"})], 1))["a"]
    assert found.clips
