"""Steps, reports, checkpoints, interruptions and threads."""

import gc
import os
import pickle
import signal
import threading
import time

import numpy as np
import pytest
from conftest import chain, pendulum

import taut


def bits(world):
    return world.poses.tobytes() + world.twists.tobytes()


def test_reports():
    world, _, _ = pendulum()
    simulator = taut.Simulator(world, taut.Settings(report_rank=True))
    report = simulator.step(1e-3)
    assert report.exact() and report.ok() and report.status == taut.Status.SUCCESS and report.message == ""
    assert report.time == pytest.approx(1e-3) and report.dt == 1e-3 and world.time == report.time
    assert max(report.gap.metres, report.gap.radians) < 1e-9
    assert report.substeps >= 1 and report.counts.factorizations >= 1 and report.times.total > 0
    assert report.rank.freedoms == 1 and report.rank.rows == 5
    simulator.step(1e-3)
    assert report.time == pytest.approx(1e-3)  # a copy
    assert simulator.report.time == pytest.approx(2e-3)
    assert "success" in repr(report)
    assert "multifrontal" in simulator.solver_description.lower()


def test_numerical_outcomes_are_statuses():
    world = taut.World()
    a = world.add_body(pose=taut.Pose(p=[1, 0, 0]))
    for length in (1.0, 2.0):
        world.add("", taut.Distance(taut.GROUND, a, [0, 0, 0], [0, 0, 0], length))
    simulator = taut.Simulator(world)
    before = bits(world)
    report = simulator.step(1e-3)
    assert not report.ok() and report.status in (taut.Status.CONTRADICTION, taut.Status.NOT_CONVERGED)
    assert report.message and bits(world) == before
    if report.status == taut.Status.CONTRADICTION:
        assert report.contradiction and report.contradiction.names(world)


def test_settings_are_checked_and_copied():
    world = chain(2)
    for wrong in ({"threads": -1}, {"threads": 10**6}, {"position_tolerance": float("nan")}, {"theta": 7.0}):
        with pytest.raises(ValueError):
            taut.Simulator(world, taut.Settings(**wrong))
    with pytest.raises(TypeError, match="no setting"):
        taut.Settings(tolerance=1)
    with pytest.raises(TypeError):
        taut.Settings(integrator="rattle")
    settings = taut.Settings(threads=1, integrator=taut.Integrator.MOREAU_JEAN)
    simulator = taut.Simulator(world, settings)
    settings.threads = -5
    simulator.settings.erp = 77
    assert simulator.settings.threads == 1 and simulator.settings.erp == 0.8
    assert simulator.step(1e-3).exact()


@pytest.mark.parametrize("dt", [0, -1, float("nan"), float("inf")])
def test_bad_steps(dt):
    simulator = taut.Simulator(chain(2))
    with pytest.raises(ValueError):
        simulator.step(dt)
    with pytest.raises(ValueError):
        simulator.run(3, dt)
    with pytest.raises(ValueError):
        simulator.run(0, 1e-3)
    assert simulator.step(1e-3).exact()


@pytest.mark.parametrize("name, parameters", [("net", {"n": 6}), ("pile", {"n": 6}), ("car", {}), ("suspension-bridge", {"n": 8})])
def test_checkpoints_resume_bit_for_bit(name, parameters):
    scene = taut.build_scene(name, **parameters)
    simulator = taut.Simulator(scene.world, scene.settings)
    simulator.run(40, scene.dt)
    checkpoint = simulator.checkpoint()
    simulator.run(60, scene.dt)
    end = bits(scene.world)

    simulator.restore(checkpoint)
    simulator.run(60, scene.dt)
    assert bits(scene.world) == end

    other = taut.build_scene(name, **parameters)
    again = taut.Simulator(other.world, other.settings)
    again.restore(pickle.loads(pickle.dumps(checkpoint)))
    again.run(60, other.dt)
    assert bits(other.world) == end
    assert taut.Checkpoint.from_bytes(checkpoint.to_bytes()) == checkpoint


def test_bad_checkpoints():
    simulator = taut.Simulator(chain(3))
    simulator.step(1e-3)
    data = simulator.checkpoint().to_bytes()
    for wrong in (b"", b"nonsense", data[:-1], data[:100] + bytes([data[100] ^ 1]) + data[101:]):
        with pytest.raises(ValueError):
            taut.Checkpoint.from_bytes(wrong)
    other = taut.Simulator(chain(4))
    other.step(1e-3)
    with pytest.raises(ValueError):
        other.restore(simulator.checkpoint())
    assert other.step(1e-3).exact()


def test_steps_and_runs_have_the_same_bits():
    one, two = chain(10), chain(10)
    taut.Simulator(one).run(50, 1e-3)
    simulator = taut.Simulator(two)
    for _ in range(50):
        simulator.step(1e-3)
    assert bits(one) == bits(two)


def test_run_until_ends_at_the_time():
    one, two = chain(10), chain(10)
    run = taut.Simulator(one).run_until(0.35, 0.1)
    assert one.time == 0.35 and run.last.time == 0.35 and run.steps == 4 and run.inexact_steps == 0
    assert run.ok() and run.exact() and run.last.ok() and run.last.dt == pytest.approx(0.05)
    assert run.last.gap.metres <= run.gap.metres < 1e-9 and "4 steps" in repr(run)
    simulator = taut.Simulator(two)
    for dt in (0.1, 0.1, 0.1, 0.35 - (0.1 + 0.1 + 0.1)):
        simulator.step(dt)
    assert bits(one) == bits(two)
    for t, h in ((0.1, 0.1), (float("nan"), 0.1), (1, 0), (1, -0.1), (1, float("inf"))):
        with pytest.raises(ValueError, match="run_until"):
            simulator.run_until(t, h)


def test_run_until_ends_with_a_step_that_fails():
    world = chain(2)

    def trouble(state, wrenches):
        if state.time > 0.035:
            wrenches[1, 3] = float("nan")

    world.add_force(taut.ForceCallback(trouble))
    run = taut.Simulator(world).run_until(0.1, 0.01)
    assert not run.ok() and run.steps == 3 and run.last.status == taut.Status.NOT_FINITE
    assert world.time == pytest.approx(0.03) and "not finite" in repr(run)


def test_a_force_for_one_step():
    world = taut.World()
    world.gravity = [0, 0, 0]
    bob = world.add_body("bob", taut.MassProperties(2.0, [1, 1, 1]))
    simulator = taut.Simulator(world)
    simulator.apply_force(bob, taut.Wrench(torque=[0, 0, 3], force=[4, 0, 0]))
    simulator.apply_force(bob, p_BP=[0, 1, 0], force=[0, 0, 8])  # they add up; torque (8, 0, 0)
    other = taut.World()
    other.gravity = [0, 0, 0]
    other.add_body("bob", taut.MassProperties(2.0, [1, 1, 1]))
    again = taut.Simulator(other)
    again.restore(pickle.loads(pickle.dumps(simulator.checkpoint())))
    for _ in range(2):
        assert simulator.step(0.01).exact() and again.step(0.01).exact()
        assert world.twists[bob] == pytest.approx([0.08, 0, 0.03, 0.02, 0, 0.04], abs=1e-4)  # the body turns a little
        assert world.twists[bob, 3:] == pytest.approx([0.02, 0, 0.04])
    assert bits(other) == bits(world)
    for wrong in ({"wrench": taut.Wrench(force=[float("nan"), 0, 0])}, {"p_BP": [0, 0, 0], "force": [float("inf"), 0, 0]}):
        with pytest.raises(ValueError, match="bob"):
            simulator.apply_force(bob, **wrong)


def test_a_force_of_the_world_for_one_step():
    def free():
        world = taut.World()
        world.gravity = [0, 0, 0]
        return world, world.add_body("bob", taut.MassProperties(2.0, [1, 1, 1]))

    (one, bob), (two, _) = free(), free()
    one.apply_force(bob, taut.Wrench(torque=[0, 0, 3], force=[4, 0, 0]))  # before there is a simulator
    one.apply_force(bob, p_BP=[0, 1, 0], force=[0, 0, 8])
    a, b = taut.Simulator(one), taut.Simulator(two)
    b.apply_force(bob, taut.Wrench(torque=[0, 0, 3], force=[4, 0, 0]))
    b.apply_force(bob, p_BP=[0, 1, 0], force=[0, 0, 8])
    again, _ = free()
    c = taut.Simulator(again)
    c.restore(a.checkpoint())
    for _ in range(2):
        for simulator in (a, b, c):
            assert simulator.step(0.01).exact()
        assert one.twists[bob, 3:] == pytest.approx([0.02, 0, 0.04])
    assert bits(one) == bits(two) == bits(again)
    with pytest.raises(ValueError, match="bob"):
        one.apply_force(bob, taut.Wrench(force=[float("nan"), 0, 0]))


def test_assemble():
    world, rod, _ = pendulum()
    world.set_pose(rod, taut.Pose(p=[0.6, 0.1, 0]))
    assert taut.gaps(world).max() > 0.1
    simulator = taut.Simulator(world)
    assert simulator.assemble().exact()
    assert taut.gaps(world).max() < 1e-9


@pytest.mark.parametrize("run", [
    lambda simulator, steps, dt: simulator.run(steps, dt),
    lambda simulator, steps, dt: simulator.run_until(steps * dt, dt),
])
def test_another_thread_runs_during_a_step(run):
    scene = taut.build_scene("net", n=40)
    simulator = taut.Simulator(scene.world, scene.settings)
    inside, counted = threading.Event(), []

    def count():
        inside.wait()
        while inside.is_set():
            counted.append(time.perf_counter())
            time.sleep(1e-3)

    thread = threading.Thread(target=count)
    thread.start()
    start = time.perf_counter()
    inside.set()
    run(simulator, 5, scene.dt)  # one call
    inside.clear()
    end = time.perf_counter()
    thread.join()
    assert sum(start < t < end for t in counted) > 5
    gaps = np.diff([start, *(t for t in counted if start < t < end), end])
    assert gaps.max() < 0.5 * (end - start)


def test_other_threads_are_refused_while_a_step_runs():
    scene = taut.build_scene("net", n=40)
    world, simulator = scene.world, taut.Simulator(scene.world, scene.settings)
    second = taut.Simulator(world, scene.settings)
    errors, stepping = [], threading.Event()

    def step():
        stepping.set()
        simulator.run(10, scene.dt)

    thread = threading.Thread(target=step)
    thread.start()
    stepping.wait()
    attempts = [
        lambda: world.positions, lambda: world.pose(taut.GROUND), lambda: world.add_body(), lambda: world.copy(),
        lambda: world.kinetic_energy(), lambda: world.wake_all(), lambda: taut.jacobian(world), lambda: simulator.step(1e-3),
        lambda: second.step(1e-3), lambda: simulator.report, lambda: simulator.checkpoint(),
    ]
    time.sleep(0.02)
    for attempt in attempts:
        if not thread.is_alive():
            break
        try:
            attempt()
        except RuntimeError as error:
            errors.append(str(error))
    thread.join()
    assert len(errors) >= 3 and all("another thread" in error for error in errors)
    assert simulator.step(scene.dt).ok()


def test_two_worlds_in_two_threads():
    def work(end):
        world = chain(40)
        taut.Simulator(world, taut.Settings(threads=1)).run(200, 1e-3)
        end.append(bits(world))

    end = []
    threads = [threading.Thread(target=work, args=(end,)) for _ in range(2)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert end[0] == end[1]


@pytest.fixture
def ctrl_c_raises():
    """What runs in the background may be told to ignore Ctrl-C."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.mark.parametrize("run", [
    lambda simulator, steps, dt: simulator.run(steps, dt),
    lambda simulator, steps, dt: simulator.run_until(steps * dt, dt),
])
def test_ctrl_c_ends_a_long_run(ctrl_c_raises, run):
    scene = taut.build_scene("net", n=30)
    simulator = taut.Simulator(scene.world, scene.settings)
    timer = threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT))
    timer.start()
    start = time.perf_counter()
    with pytest.raises(KeyboardInterrupt):
        run(simulator, 10**5, scene.dt)
    assert time.perf_counter() - start < 10
    timer.join()
    state = bits(scene.world)
    assert np.isfinite(scene.world.positions).all() and scene.world.time > 0
    assert simulator.step(scene.dt).ok() and bits(scene.world) != state


def test_threads_do_not_change_bits():
    def end(threads):
        scene = taut.build_scene("pile", n=10)
        settings = scene.settings
        settings.threads = threads
        taut.Simulator(scene.world, settings).run(100, scene.dt)
        return bits(scene.world)

    assert end(1) == end(2)


def test_a_forked_process_goes_on_with_a_simulator_and_ends_it():
    scene = taut.build_scene("net-corners", n=40)
    scene.settings.threads = 2
    simulator = taut.Simulator(scene.world, scene.settings)
    simulator.step(scene.dt)
    child = os.fork()
    if child == 0:  # threads of the parent are not there
        signal.alarm(60)
        ok = simulator.step(scene.dt).ok()
        del simulator
        gc.collect()
        os._exit(0 if ok else 1)
    assert os.waitpid(child, 0)[1] == 0
    assert simulator.step(scene.dt).ok()
