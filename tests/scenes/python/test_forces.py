"""Force laws, also in Python."""

import gc
import weakref

import numpy as np
import pytest
from conftest import chain, pendulum

import taut


def ball(position=(0, 0, 0)):
    world = taut.World()
    world.gravity = [0, 0, 0]
    return world, world.add_body("bob", taut.MassProperties(2.0, [1, 1, 1]), taut.Pose(p=position))


def test_a_callback_is_the_law_in_cpp():
    """A spring of 8 N/m to the origin: the same motion as SpringDamper, and cos(2 t) but for order 2."""
    def spring(state, wrenches):
        wrenches[1, 3:] -= 8.0 * state.positions[1]

    ends = []
    for law in (taut.ForceCallback(spring, depends_on_velocity=False,
                                   potential=lambda state: 4.0 * (state.positions[1] ** 2).sum()),
                taut.SpringDamper(taut.GROUND, taut.BodyId(1), [0, 0, 0], [0, 0, 0], 8.0, 0.0, 0.0)):
        world, bob = ball([1, 0, 0])
        world.add_force(law)
        assert world.potential_energy() == pytest.approx(4.0)
        taut.Simulator(world).run(1000, 1e-3)
        ends.append(world.positions[bob])
    assert ends[0] == pytest.approx([np.cos(2.0), 0, 0], abs=1e-6)
    assert ends[1] == pytest.approx([np.cos(2.0), 0, 0], abs=1e-6)


def test_forces_as_an_array():
    world, bob = ball()
    world.gravity = [0, 0, -10]
    world.add_force(taut.PointForce(bob, [0, 1, 0], [5, 0, 0]))
    world.add_force(taut.BodyTorque(bob, [1, 2, 3]))
    assert world.forces()[bob] == pytest.approx([1, 2, 3 - 5, 5, 0, -20])


def test_set_force_between_steps():
    world, bob = ball()
    force = world.add_force(taut.PointForce(bob, [0, 0, 0], [0, 0, 0]))
    simulator = taut.Simulator(world)
    simulator.step(0.1)
    world.set_force(force, taut.PointForce(bob, [0, 0, 0], [2, 0, 0]))
    simulator.run(10, 0.1)
    assert world.twists[bob, 3] == pytest.approx(1.0)


class Trouble(Exception):
    pass


@pytest.mark.parametrize("wrong, error", [
    (lambda state, wrenches: (_ for _ in ()).throw(Trouble("no")), Trouble),
    (lambda state: None, TypeError),
    (lambda state, wrenches: wrenches, TypeError),
    (lambda state, wrenches: wrenches[99], IndexError),
    (lambda state, wrenches: (_ for _ in ()).throw(KeyboardInterrupt()), KeyboardInterrupt),
])
def test_what_a_callback_raises_comes_through(wrong, error):
    world = chain(3)
    simulator = taut.Simulator(world)
    simulator.run(5, 1e-3)
    before, last = world.state, simulator.report.time
    id = world.add_force(taut.ForceCallback(wrong))
    with pytest.raises(error):
        simulator.step(1e-3)
    assert (world.poses == before.poses).all() and (world.twists == before.twists).all() and world.time == before.time
    assert simulator.report.time == last
    world.set_force(id, taut.ForceCallback(lambda state, wrenches: None))
    assert simulator.step(1e-3).exact()


def test_a_force_that_is_no_number_is_a_status():
    world, bob = ball()

    def nan(state, wrenches):
        wrenches[bob] = np.nan

    world.add_force(taut.ForceCallback(nan))
    simulator = taut.Simulator(world)
    report = simulator.step(1e-3)
    assert report.status == taut.Status.NOT_FINITE and not report.ok()
    assert world.positions[bob] == pytest.approx([0, 0, 0])


@pytest.mark.parametrize("change", [
    lambda world, simulator: world.add_body(),
    lambda world, simulator: world.set_pose(taut.BodyId(1), taut.Pose()),
    lambda world, simulator: world.set_state(world.state),
    lambda world, simulator: setattr(world, "time", 7.0),
    lambda world, simulator: world.detach(world.joints()[0]),
    lambda world, simulator: simulator.step(1e-3),
    lambda world, simulator: simulator.run(2, 1e-3),
    lambda world, simulator: simulator.assemble(),
    lambda world, simulator: simulator.checkpoint(),
    lambda world, simulator: simulator.reactions(),
    lambda world, simulator: world.forces(),
    lambda world, simulator: taut.jacobian(world),
    lambda world, simulator: world.append(chain(2), "x"),
    lambda world, simulator: taut.Simulator(world).step(1e-3),
])
def test_a_callback_cannot_change_what_is_stepped(change):
    world = chain(2)
    simulator = taut.Simulator(world)
    refused = []

    def force(state, wrenches):
        try:
            change(world, simulator)
        except RuntimeError as error:
            refused.append(str(error))

    world.add_force(taut.ForceCallback(force))
    assert simulator.step(1e-3).exact()
    assert refused
    world.forces()
    assert world.body_count == 3 and world.time == pytest.approx(1e-3)


def test_a_callback_may_ask_the_world():
    world = chain(2)
    asked = []

    def force(state, wrenches):
        asked.append((world.name(taut.BodyId(1)), world.positions.shape, world.pose(taut.BodyId(2)).p, state.time))

    world.add_force(taut.ForceCallback(force))
    assert taut.Simulator(world).step(1e-3).exact()
    assert asked and asked[0][:2] == ("rod 0", (3, 3))


def test_what_a_callback_keeps_stays_good():
    world = chain(2)
    kept = []
    world.add_force(taut.ForceCallback(lambda state, wrenches: kept.append((state, state.positions, wrenches))))
    taut.Simulator(world).run(20, 1e-3)
    del world
    gc.collect()
    for state, positions, wrenches in kept:
        assert np.isfinite(positions).all() and (state.positions == positions).all() and (wrenches == 0).all()


def test_a_callback_lives_as_long_as_its_world():
    class Law:
        def __call__(self, state, wrenches):
            pass

    law = Law()
    alive = weakref.ref(law)
    world = chain(1)
    world.add_force(taut.ForceCallback(law))
    del law
    gc.collect()
    assert alive() is not None
    del world
    gc.collect()
    assert alive() is None


def test_motions_in_python():
    world, rod, axis = pendulum()
    world.add("driver", taut.Driver(world, axis, lambda t: (t * t / 2, t, 1.0)))
    simulator = taut.Simulator(world)
    assert simulator.run(100, 0.01).exact()
    assert world.axis_value(axis) == pytest.approx(0.5, abs=1e-9)
    wrong, _, axis = pendulum()
    wrong.add("driver", taut.Driver(wrong, axis, lambda t: t))
    with pytest.raises(TypeError, match="value, rate, acceleration"):
        taut.Simulator(wrong).step(0.01)
    assert taut.harmonic_motion(1.0, 2.0, 3.0)(0.0) == pytest.approx((1.0, 6.0, 0.0))


def test_pose_driver():
    world = taut.World()
    body = world.add_body()
    world.add("hand", taut.PoseDriver(taut.GROUND, body, lambda t: (
        taut.Pose(p=[t, 0, 0]), taut.Twist(v=[1, 0, 0]), taut.Twist())))
    taut.Simulator(world).run(10, 0.1)
    assert world.positions[body] == pytest.approx([1, 0, 0], abs=1e-9)
    driven = taut.pose_motion([taut.linear_motion(0, 1), None, None], [([0, 0, 1], taut.linear_motion(0, 2))])
    assert driven(0.5)[0].p == pytest.approx([0.5, 0, 0])


def test_a_world_in_its_own_callback_is_no_trouble():
    world = chain(1)
    world.add_force(taut.ForceCallback(lambda state, wrenches: world.name(taut.BodyId(1)) and None))
    taut.Simulator(world).step(1e-3)
    del world
    gc.collect()
