"""Threads, processes and signals."""

from __future__ import annotations

import multiprocessing
import os
import signal
import subprocess
import sys
import threading
import time

import lightloom
import pytest


def test_threads_have_renderers_of_their_own() -> None:
    renderers = [lightloom.Renderer(size=(16, 12), lights=16) for _ in range(3)]
    means: dict[int, float] = {}

    def work(i: int) -> None:
        means[i] = float(renderers[i].frame(2).output().mean())

    threads = [threading.Thread(target=work, args=(i,)) for i in range(3)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert len(set(means.values())) == 1 and means[0] > 0


def test_two_threads_on_one_renderer_are_refused() -> None:
    renderer = lightloom.Renderer("cornell-box", "reference", (64, 64), samples=64)
    begun, failed = threading.Event(), []

    def work() -> None:
        begun.set()
        try:
            renderer.converge()
        except lightloom.Error as error:
            failed.append(str(error))

    thread = threading.Thread(target=work)
    thread.start()
    begun.wait()
    while thread.is_alive() and not failed:
        try:
            renderer.output()
        except lightloom.Error as error:
            failed.append(str(error))
        time.sleep(0.001)
    thread.join()
    assert failed and "another thread uses this renderer" in failed[0]
    assert renderer.frame().output().shape == (64, 64, 3)


def test_other_threads_run_beside_a_frame() -> None:
    renderer = lightloom.Renderer("cornell-box", "reference", (64, 64), samples=32)
    steps, done = [0], threading.Event()

    def count() -> None:
        while not done.is_set():
            steps[0] += 1
            time.sleep(0.001)

    thread = threading.Thread(target=count)
    thread.start()
    start = time.monotonic()
    renderer.converge()
    took, counted = time.monotonic() - start, steps[0]
    done.set()
    thread.join()
    # With the lock held, it would have had no step; the machine may be busy.
    assert counted > 20 * min(took, 5)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="there is no fork")
def test_a_fork_raises_and_ends() -> None:
    renderer = lightloom.Renderer(size=(8, 8)).frame()
    child = os.fork()
    if child == 0:
        try:
            renderer.frame()
        except lightloom.Error as error:
            os._exit(7 if "spawn" in str(error) else 8)
        os._exit(9)
    deadline = time.monotonic() + 30
    while (ended := os.waitpid(child, os.WNOHANG)) == (0, 0):
        assert time.monotonic() < deadline, "it hangs"
        time.sleep(0.01)
    assert os.waitstatus_to_exitcode(ended[1]) == 7
    assert renderer.frame().output().shape == (8, 8, 3)


def test_spawned_processes_render() -> None:
    with multiprocessing.get_context("spawn").Pool(1) as pool:
        assert pool.apply(_mean) == pytest.approx(_mean(), rel=1e-6)


def _mean() -> float:
    return float(lightloom.Renderer(size=(8, 8), lights=16).frame().output().mean())


def test_control_c_interrupts_a_reference_between_its_frames() -> None:
    code = """
import lightloom, sys
renderer = lightloom.Renderer("cornell-box", "reference", (64, 64), samples=1_000_000)
print("begun", flush=True)
try:
    renderer.converge()
except KeyboardInterrupt:
    print("interrupted", renderer.progress[0] > 0, renderer.output().shape)
"""
    child = subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True)
    assert child.stdout is not None and child.stdout.readline() == "begun\n"
    time.sleep(1)
    child.send_signal(signal.SIGINT)
    said, _ = child.communicate(timeout=60)
    assert said.strip() == "interrupted True (64, 64, 3)"
