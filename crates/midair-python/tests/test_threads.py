"""Other threads and processes go on."""

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import numpy as np
import pytest
from conftest import BALL

import midair


def test_python_s_lock_is_released(ball):
    """While the work goes on, another thread counts; with the lock held it could not."""
    counts = []

    def count():
        while not done.is_set():
            counts.append(time.monotonic())
            time.sleep(0.001)

    done = threading.Event()
    uv = np.random.default_rng(0).random((400_000, 2))
    counting = threading.Thread(target=count)
    counting.start()
    start = time.monotonic()
    ball.forward(uv)
    end = time.monotonic()
    done.set()
    counting.join()
    during = sum(start < t < end for t in counts)
    # Every millisecond; a busy machine lets it through now and then at least.
    assert end - start > 0.02 and during > (end - start) / 0.02, (end - start, during)


def _forward(queue, toml):
    queue.put(midair.Scene(toml).forward([[0.4, 0.5]]).tolist())


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork here")
@pytest.mark.filterwarnings("ignore:.*fork.*:DeprecationWarning")
def test_a_forked_process_has_threads_of_its_own(ball):
    expected = ball.forward([[0.4, 0.5]]).tolist()
    context = multiprocessing.get_context("fork")
    queue = context.Queue()
    child = context.Process(target=_forward, args=(queue, BALL))
    child.start()
    assert queue.get(timeout=60) == expected
    child.join(60)


def test_threads_are_as_many_as_asked_for(ball):
    usual = midair.thread_count()
    expected = ball.map().uv
    try:
        midair.use_threads(1)
        assert midair.thread_count() == 1
        assert np.array_equal(ball.map().uv, expected, equal_nan=True)
    finally:
        midair.use_threads(None)
    assert midair.thread_count() == usual


def test_scenes_serve_several_threads(ball):
    uv = np.random.default_rng(0).random((1000, 2))
    expected = {x: ball.changed({"viewpoint.position.x": x}).forward(uv) for x in (0.0, 5.0)}
    wrong = []

    def look(x):
        for _ in range(20):
            found = ball.changed({"viewpoint.position.x": x}).forward(uv)
            if not np.array_equal(found, expected[x], equal_nan=True):
                wrong.append(x)

    threads = [threading.Thread(target=look, args=(x,)) for x in (0.0, 5.0, 0.0)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert not wrong


SLOW = f"""
import numpy as np, midair, sys
scene = midair.Scene({BALL!r})
print("ready", flush=True)
try:
    scene.view(np.zeros((64, 64, 3), np.float32), size=(256, 256), spp=1 << 20)
except KeyboardInterrupt:
    print("interrupted", flush=True)
"""


def test_ctrl_c_stops_a_render():
    child = subprocess.Popen([sys.executable, "-c", SLOW], stdout=subprocess.PIPE, text=True)
    assert child.stdout.readline() == "ready\n"
    time.sleep(0.3)
    child.send_signal(signal.SIGINT)
    assert child.communicate(timeout=60)[0] == "interrupted\n"
