"""Reading in processes: whatever a file does, it costs itself alone."""

import contextlib
import json
import os
import re
import signal
import subprocess
import sys
import time
from pathlib import Path
from unittest.mock import MagicMock

import numpy as np
import pytest

from encoders.errors import MotionSeekError, UnreadableMotion
from encoders.motion import Motion
from indexer.ingest import worker_limits
from indexer.ingest.pool import Read, Request, read_all
from indexer.ingest.worker import MAX_FRAMES, MAX_HEADER, TOO_MUCH_MEMORY
from indexer.read_motion import NOT_KNOWN, Reading, ReadMotion
from tests.conftest import ROOT
from tests.indexer.folders import moving, write


def misbehave(path, fps, joint_map, up):
    """Stands in for reading; runs in the worker."""
    name = Path(path).name
    if name == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    if name == "exit":
        os._exit(3)
    if name == "over memory":
        os._exit(worker_limits.OVER_MEMORY)
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
    if name == "glutton":
        np.ones(3 << 28)  # 6 GB
    if name == "busy":
        re.fullmatch("(a|a)*b", "a" * 99)
    if name == "forge":
        for descriptor in range(3, 99):  # what a file may do that has taken over the process
            with contextlib.suppress(OSError):
                os.write(descriptor, Path(path).read_bytes())
        time.sleep(60)
    if name == "note":
        (Path(path).parent / f"{os.getpid()}.pid").touch()
        re.fullmatch("(a|a)*b", "a" * 99)  # holds on to the interpreter
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
    ("name", "reason", "doubted"),
    [
        ("unreadable", "it holds no motion", False),
        ("bug", "reading failed unexpectedly (KeyError: 'oops')", False),
        ("memory", TOO_MUCH_MEMORY, not worker_limits.LIMITS_MEMORY),
        ("over memory", TOO_MUCH_MEMORY, False),
        ("exit", "reading it crashed (exit code 3)", True),
        pytest.param(
            "crash", "reading it crashed (SIGSEGV)", True, marks=pytest.mark.skipif(os.name == "nt", reason="")
        ),
    ],
)
def test_a_file_that_cannot_be_read_is_reported_and_the_rest_is_read(name, reason, doubted):
    found = read(["1", name, "2"])
    assert found[name] == Read(reason=reason, doubted=doubted)
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


needs_limits = pytest.mark.skipif(sys.platform != "linux", reason="there is no limit of memory")


@needs_limits
def test_a_file_that_needs_too_much_memory_is_refused_and_the_process_goes_on():
    found = read(["glutton", "1"])
    assert found["glutton"] == Read(reason=TOO_MUCH_MEMORY)
    assert found["1"].clips


@pytest.mark.skipif(os.name != "posix", reason="the peak of memory is not known")
@pytest.mark.parametrize(("megabytes", "code"), [(50, 0), (400, worker_limits.OVER_MEMORY)])
def test_where_the_system_sets_no_limit_of_memory_a_thread_does(megabytes, code):
    script = (
        "import time; from indexer.ingest import worker_limits as w; w.LIMITS_MEMORY = False\n"
        f"w.limit(200 << 20, 60.0); held = b'x' * ({megabytes} << 20); time.sleep(0.2 if {megabytes} < 100 else 20)"
    )
    ran = subprocess.run([sys.executable, "-c", script], env={**os.environ, "PYTHONPATH": str(ROOT)}, timeout=60)
    assert ran.returncode == code


@pytest.mark.skipif(os.name != "posix", reason="there is no limit of processor time")
def test_a_file_may_not_use_the_processor_for_longer_than_its_time(monkeypatch):
    monkeypatch.setattr(
        "indexer.ingest.pool.threading.Timer", lambda *_: MagicMock()
    )  # only the system's limit is left
    found = read(["busy", "1"], patience=0.5)
    assert found["busy"].reason == "reading it took too long and was ended; cut it into shorter takes"
    assert not found["busy"].passes
    assert found["1"].clips


def test_more_frames_than_fit_are_refused():
    assert read([str(MAX_FRAMES + 1)])[str(MAX_FRAMES + 1)].reason.endswith("cut it into shorter takes")


RECORD = {"frames": 1, "fps": 20.0, "part": "", "rig": "", "reading": NOT_KNOWN.record()}


@pytest.mark.parametrize(
    "answer",
    [
        b"\xff\xfe\n",
        b"[" * 100_000 + b"\n",
        b'"' + b"x" * (MAX_HEADER + 10) + b'"\n',
        b'{"clips": []}\n',
        b'{"clips": 3}\n',
        b'["reason"]\n',
        b'{"reason": "\\ud800"}\n',
        b'{"reason": 7}\n',
        *(
            json.dumps({"clips": [RECORD | change]}).encode() + b"\n" + bytes(264)
            for change in (
                {"frames": 10**12},
                {"frames": -1},
                {"frames": True},
                {"frames": 1.0},
                {"fps": float("nan")},
                {"fps": "20"},
                {"part": "\ud800"},
                {"rig": ["a"]},
                {"reading": {}},
                {"reading": NOT_KNOWN.record() | {"warnings": [1]}},
                {"reading": NOT_KNOWN.record() | {"start": 1e300}},
                {"reading": NOT_KNOWN.record() | {"more": 1}},
            )
        ),
        json.dumps({"clips": [RECORD]}).encode() + b"\n" + np.full(66, np.nan, "<f4").tobytes(),
    ],
    ids=range(21),
)
def test_an_answer_that_makes_no_sense_costs_its_file(tmp_path, answer):
    (tmp_path / "forge").write_bytes(answer)
    requests = [Request(0, tmp_path / "forge"), Request(1, Path("/nowhere/2"))]
    found = dict(read_all(requests, 1, target="tests.indexer.ingest.test_pool:misbehave"))
    assert "reading it gave no motion" in found[0].reason
    assert len(found[1].clips[0].motion) == 2


@pytest.mark.skipif(os.name != "posix", reason="processes end otherwise there")
def test_processes_die_with_their_parent(tmp_path):
    """Killed while one of its readers hangs, it leaves none behind."""
    script = (
        "from pathlib import Path\nfrom indexer.ingest.pool import Request, read_all\n"
        f"requests = [Request(i, Path({str(tmp_path)!r}) / 'note') for i in range(2)]\n"
        "list(read_all(requests, 2, target='tests.indexer.ingest.test_pool:misbehave'))"
    )
    parent = subprocess.Popen([sys.executable, "-c", script], env={**os.environ, "PYTHONPATH": str(ROOT)})
    until = time.monotonic() + 60
    while len(children := list(tmp_path.glob("*.pid"))) < 2 and time.monotonic() < until:
        time.sleep(0.05)
    parent.kill()
    parent.wait()
    pids = [int(child.stem) for child in children]
    while any(map(runs, pids)) and time.monotonic() < until:
        time.sleep(0.05)
    assert len(pids) == 2
    assert not any(map(runs, pids))


def runs(pid):
    """Whether the process is there; one that has ended and that nobody waits for is not."""
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    state = Path(f"/proc/{pid}/stat")
    return not (state.exists() and state.read_text().rsplit(")", 1)[1].split()[0] == "Z")
