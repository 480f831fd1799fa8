"""Against closed forms and formulas of our own."""

import numpy as np
import pytest
from conftest import chain, pendulum, rotation
from scipy.special import ellipj, ellipk

import taut


def elliptic_angle(t, length=1.0, g=9.81):
    """Angle from the vertical of a thin rod released from the horizontal: sin(θ/2) = k sn(K + ω t, k), k = sin(45°)."""
    omega = np.sqrt(1.5 * g / length)  # m g (L/2) / (m L²/3)
    m = 0.5  # k²
    sn = ellipj(ellipk(m) + omega * t, m)[0]
    return 2 * np.arcsin(np.sqrt(m) * sn)


def pendulum_error(dt, integrator=taut.Integrator.RATTLE, duration=2.0):
    world, _, axis = pendulum()
    simulator = taut.Simulator(world, taut.Settings(integrator=integrator))
    steps = round(duration / dt)
    assert simulator.run(steps, dt).exact()
    from_vertical = np.pi / 2 - world.axis_value(axis)
    return abs(from_vertical - elliptic_angle(steps * dt))


def test_pendulum_follows_elliptic_functions_with_order_two():
    coarse, fine, finest = (pendulum_error(dt) for dt in (4e-3, 2e-3, 1e-3))
    assert finest < 2e-5
    assert coarse / fine == pytest.approx(4, rel=0.05)
    assert fine / finest == pytest.approx(4, rel=0.05)


def test_pendulum_with_order_four():
    assert pendulum_error(2e-2, taut.Integrator.RATTLE4) / pendulum_error(1e-2, taut.Integrator.RATTLE4) == pytest.approx(16, rel=0.2)


def test_joints_stay_closed_by_a_formula_of_our_own():
    world = chain(30)
    simulator = taut.Simulator(world)
    for _ in range(100):
        assert simulator.step(1 / 240).exact()
        poses = world.poses
        last = np.zeros(3)  # the end of the rod before
        for q_p in poses[1:]:
            arm = rotation(q_p[:4]) @ [0.05, 0, 0]
            assert np.linalg.norm(q_p[4:] - arm - last) < 1e-9
            last = q_p[4:] + arm


def test_energy_and_ledger():
    world, _, _ = pendulum()
    simulator = taut.Simulator(world)
    start = world.kinetic_energy() + world.potential_energy()
    report = simulator.run(1000, 1e-3)
    assert report.energy() == pytest.approx(world.kinetic_energy() + world.potential_energy(), abs=1e-12)
    assert report.energy() == pytest.approx(start, abs=1e-4)
    assert report.ledger.total() == pytest.approx(report.ledger.change(), abs=1e-12)


def test_reaction_of_a_hanging_chain_is_its_weight():
    world = taut.World()
    ids = []
    for k in range(5):
        ids.append(world.add_body(mass=taut.MassProperties.sphere(0.1, mass=2.0), pose=taut.Pose(p=[0, 0, -k - 1.0])))
        above = taut.GROUND if k == 0 else ids[-2]
        world.add("", taut.Distance.between(world, above, ids[-1], [0, 0, -k], [0, 0, -k - 1.0]))
    simulator = taut.Simulator(world)
    simulator.step(1e-3)
    below = np.arange(5, 0, -1)
    for reactions in (simulator.mean_reactions(), simulator.reactions()):
        assert reactions.shape == (5, 6)
        assert reactions[:, 5] == pytest.approx(2.0 * 9.81 * below, rel=1e-9)
        assert np.abs(reactions[:, :5]).max() < 1e-9
    assert simulator.reaction(world.joints()[0]).force == pytest.approx([0, 0, 98.1])


def test_box_rests_on_the_ground_with_its_weight():
    world = taut.World()
    world.add_shape(taut.GROUND, taut.HalfSpace())
    box = world.add_body(mass=taut.MassProperties.box([1, 1, 1], mass=3.0), pose=taut.Pose(p=[0, 0, 0.5]))
    world.add_shape(box, taut.Box([1, 1, 1]))
    simulator = taut.Simulator(world)
    assert simulator.run(50, 0.01).exact()
    columns = simulator.contact_arrays()
    assert columns["forces"].sum(axis=0) == pytest.approx([0, 0, 3 * 9.81], abs=1e-6)
    assert set(columns["bodies"].ravel()) == {0, box.index}
    assert len(simulator.contacts()) == len(columns["gaps"]) >= 3
    assert world.positions[box, 2] == pytest.approx(0.5, abs=1e-6)


def test_modes_of_a_pendulum():
    world = taut.World()
    rod = world.add_body(mass=taut.MassProperties(1.0, [0.1, 0.1, 0.1]), pose=taut.Pose(p=[0, 0, -1.0]))
    world.add("", taut.Hinge.at(world, taut.GROUND, rod, [0, 0, 0], [0, 1, 0]))
    (omega, shape), = taut.natural_modes(world)
    assert omega == pytest.approx(np.sqrt(9.81 / 1.1), rel=1e-8)
    twist = shape[1]
    assert twist @ np.diag([0.1, 0.1, 0.1, 1, 1, 1]) @ twist == pytest.approx(1)
