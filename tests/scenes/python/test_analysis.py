"""What answers questions beside a simulation, and the rest of World and Simulator."""

import numpy as np
import pytest
import scipy.sparse
from conftest import chain, pendulum

import taut


def test_friction_of_a_block_on_a_plane():
    """A mass of 2 kg pushed along the plane: it sticks inside the cone, and slides with |r_T| = μ r_N outside."""
    W = scipy.sparse.diags_array([0.5, 0.5, 0.5])
    sticks = taut.solve_friction(W, [-1.0, 0.2, 0.0], [0.5])
    assert sticks.status == taut.FrictionStatus.SOLVED and sticks.largest_error < 1e-8
    assert sticks.r == pytest.approx([2.0, -0.4, 0.0], abs=1e-7)
    slides = taut.solve_friction(W.toarray(), [-1.0, 5.0, 0.0], [0.5], guess=[1, 0, 0])
    assert slides.r == pytest.approx([2.0, -1.0, 0.0], abs=1e-6)
    none = taut.solve_friction(np.diag([0, 1, 1]), [-1.0, 0.0, 0.0], [0.5])  # it closes, whatever the impulse
    assert none.status == taut.FrictionStatus.NO_SOLUTION and none.certificate[0] > 0


@pytest.mark.parametrize("arguments", [(np.eye(3), [1, 2], [0.5]), (np.eye(2), [1, 2, 3], [0.5]), (np.eye(3), [1, 2, 3], [-1]),
                                       (np.eye(3), [1, 2, float("nan")], [1]), (np.eye(3), [1, 2, 3], [1], -3)])
def test_wrong_problems_of_friction(arguments):
    with pytest.raises(ValueError):
        taut.solve_friction(*arguments)


def test_contact_finder():
    world = taut.World()
    a, b = (world.add_body(pose=taut.Pose(p=[x, 0, 0])) for x in (0, 2.003))
    for body in (a, b):
        world.add_shape(body, taut.Sphere(1))
    contact, = taut.ContactFinder(threads=1).find(world)
    assert contact.gap == pytest.approx(0.003) and contact.normal == pytest.approx([1, 0, 0])
    assert (contact.A, contact.B) == (a, b) and contact.p_AP == pytest.approx([1, 0, 0])
    assert taut.ContactFinder(margin=0.001).find(world) == []
    with pytest.raises(ValueError):
        taut.ContactFinder(margin=-1)
    assert taut.have_contacts(taut.Sphere(1), taut.HalfSpace()) and not taut.have_contacts(taut.HalfSpace(), taut.HalfSpace())


def test_tree_accelerations():
    """Angular acceleration of a rod released from the horizontal: 3 g / 2 L."""
    world, rod, _ = pendulum()
    for lagrangian in (False, True):
        assert taut.tree_accelerations(world, lagrangian)[rod] == pytest.approx([0, 1.5 * 9.81, 0, 0, 0, -0.75 * 9.81])
    loop = taut.build_scene("n-four-bar", n=1).world  # upright, its coupler at 1 m/s on circles of 1 m
    for lagrangian in (False, True):
        accelerations = taut.tree_accelerations(loop, lagrangian)
        assert accelerations[loop.body("coupler_0")] == pytest.approx([0, 0, 0, 0, 0, -1], abs=1e-12)


def test_the_rest_of_world():
    world = chain(3)
    joints = world.joints()
    world.set_break(joints[1], taut.BreakLimits(torque=5.0))
    assert [(j, limits.torque) for j, limits in world.breakable] == [(joints[1], 5.0)]
    world.detach_all_but(joints[:1])
    assert world.detached_count == 2 and world.is_attached(joints[0])
    assert world.moves(world.body("rod 1")) and not world.moves(taut.GROUND) and world.asleep_count == 0
    spring = world.add_force(taut.SpringDamper(world.body("rod 0"), world.body("rod 1"), [0, 0, 0], [0, 0, 0], 1.0, 0.1))
    assert world.springs() == [spring]
    ice = world.add_material("ice", taut.Material(restitution=0.25))
    assert world.material(ice).restitution == 0.25 and world.material_count == 1
    swing, _, axis = pendulum()
    swing.set_axis_properties(axis, taut.AxisProperties(spring=taut.AxisSpring(stiffness=4.0, rest=1.0)))
    assert swing.spring_energy_of(swing.joint("pivot")) == pytest.approx(2.0) == swing.spring_energy()
    assert swing.has_axis_properties(swing.joint("pivot")) and swing.axis_label(axis) == "pivot angle"


def test_compliant_contacts_are_put_back_by_their_stretches():
    def incline():
        world = taut.World()
        world.gravity = [3, 0, -9]
        soft = taut.Material(static_friction=0.9, dynamic_friction=0.9, compliance=1e-5)
        world.add_shape(taut.GROUND, taut.HalfSpace(), material=soft)
        box = world.add_body(mass=taut.MassProperties.box([1, 1, 1], mass=1.0), pose=taut.Pose(p=[0, 0, 0.5]))
        world.add_shape(box, taut.Box([1, 1, 1]), material=soft)
        return world, box

    world, box = incline()
    simulator = taut.Simulator(world)
    simulator.run(300, 0.01)
    stretches = simulator.contact_stretches()
    assert len(stretches) >= 3 and sum(s.stretch[0] for s in stretches) != 0
    again, _ = incline()
    again.set_state(world.state)
    other = taut.Simulator(again)
    other.set_contact_stretches(stretches)
    other.run(50, 0.01)
    assert again.positions[box] == pytest.approx(world.positions[box], abs=1e-5)
    with pytest.raises(ValueError):
        other.set_contact_stretches([taut.ContactStretch(taut.ShapeId(7), taut.ShapeId(9), [0, 0, 0], [0, 0, 0])])


def test_erp_and_cfm():
    compliance, damping = taut.from_erp_cfm(0.2, 1e-4, 0.01)
    assert taut.to_erp_cfm(compliance, damping, 0.01) == pytest.approx((0.2, 1e-4))
    k, h = 1 / compliance, 0.01
    assert h * k / (h * k + damping) == pytest.approx(0.2)


def test_integrals_of_solids():
    ball = taut.solid_properties(taut.Sphere(2))
    assert ball.volume == pytest.approx(4 / 3 * np.pi * 8) and ball.inertia == pytest.approx(0.4 * ball.volume * 4 * np.eye(3))


def test_joints_from_their_parts():
    world = taut.World()
    a, b, c = (world.add_body(pose=taut.Pose(p=[k, 0, 0])) for k in range(3))
    x, y, z, o = np.eye(3)[0], np.eye(3)[1], np.eye(3)[2], np.zeros(3)
    one = [1, 0, 0, 0]
    made = [
        taut.Hinge(a, b, x, z, x, o, z, x), taut.Screw(a, b, x, z, x, o, z, x, 0.1), taut.Planar(a, b, x, z, x, o, z, x),
        taut.SixDof(a, b, x, one, o, one, [True] * 3, [True] * 3), taut.Slider(a, b, x, x, o, one), taut.Fixed(a, b, x, o, one),
        taut.Cylindrical(a, b, x, z, o, z), taut.Universal(a, b, x, y, o, z), taut.Hinge2(a, b, x, z, o, y),
        taut.PointOnLine(a, b, x, z, o), taut.PointOnCurve(a, b, [0, 1, 2], [o, x, 2 * x + y], o),
        taut.Distance(a, b, o, o, 1.0), taut.Ball(a, b, x, o),
        taut.Pulley([(a, o), (c, o), (c, x), (b, o)], 4.0), taut.Hinge(a, b, x, z, o, z).zeroed(world.pose(a), world.pose(b)),
    ]
    for joint in made:
        world.add("", joint)
    assert taut.gaps(world).max() < 1e-9
    with pytest.raises(ValueError):
        taut.Pulley([(a, o), (c, o), (b, o)], 4.0)
    with pytest.raises(ValueError):
        taut.Hinge(a, b, x, z, z, o, z, x)
