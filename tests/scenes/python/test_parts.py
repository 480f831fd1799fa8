"""Ids, joints, shapes, masses and axes; and what is refused."""

import copy

import numpy as np
import pytest
from conftest import chain, pendulum

import taut

HALF = np.sqrt(0.5)


def two_bodies():
    world = taut.World()
    a = world.add_body("a", pose=taut.Pose(p=[0, 0, 0]))
    b = world.add_body("b", pose=taut.Pose(p=[1, 0, 0]))
    return world, a, b


JOINTS = {
    "ball": lambda w, a, b: taut.Ball.at(w, a, b, [0.5, 0, 0]),
    "fixed": lambda w, a, b: taut.Fixed.at(w, a, b, [0.5, 0, 0]),
    "hinge": lambda w, a, b: taut.Hinge.at(w, a, b, [0.5, 0, 0], [0, 0, 1]),
    "slider": lambda w, a, b: taut.Slider.at(w, a, b, [0.5, 0, 0], [1, 0, 0]),
    "cylindrical": lambda w, a, b: taut.Cylindrical.at(w, a, b, [0.5, 0, 0], [1, 0, 0]),
    "screw": lambda w, a, b: taut.Screw.at(w, a, b, [0.5, 0, 0], [1, 0, 0], 0.1),
    "planar": lambda w, a, b: taut.Planar.at(w, a, b, [0.5, 0, 0], [0, 0, 1], [1, 0, 0]),
    "universal": lambda w, a, b: taut.Universal.at(w, a, b, [0.5, 0, 0], [0, 1, 0], [0, 0, 1]),
    "hinge2": lambda w, a, b: taut.Hinge2.at(w, a, b, [1, 0, 0], [0, 0, 1], [0, 1, 0]),
    "distance": lambda w, a, b: taut.Distance.between(w, a, b, [0, 0, 0], [1, 0, 0]),
    "point_on_line": lambda w, a, b: taut.PointOnLine.at(w, a, b, [1, 0, 0], [1, 0, 0]),
    "point_on_curve": lambda w, a, b: taut.PointOnCurve.through(w, a, b, [[0, 0, 0], [1, 0, 0], [2, 1, 0]], [1, 0, 0]),
    "six_dof": lambda w, a, b: taut.SixDof.at(w, a, b, [0.5, 0, 0], [1, 0, 0, 0], [True, True, False], [True, False, False]),
    "rope": lambda w, a, b: taut.Rope.between(w, a, b, [0, 0, 0], [1, 0, 0]),
    "pulley": lambda w, a, b: taut.Pulley.at(w, a, [0, 0, 0], taut.GROUND, [0, 0, 1], [1, 0, 1], b, [1, 0, 0]),
    "pose_driver": lambda w, a, b: taut.PoseDriver(a, b, lambda t: (taut.Pose(p=[1, 0, 0]), taut.Twist(), taut.Twist())),
}
ROWS = dict(ball=3, fixed=6, hinge=5, slider=5, cylindrical=4, screw=5, planar=3, universal=4, hinge2=3, distance=1,
            point_on_line=2, point_on_curve=2, six_dof=3, rope=1, pulley=1, pose_driver=6)


@pytest.mark.parametrize("kind", JOINTS)
def test_joints(kind):
    world, a, b = two_bodies()
    id = world.add("it", JOINTS[kind](world, a, b))
    assert world.joint_type(id) == kind and world.joint("it") == id and world.name(id) == "it"
    assert set(world.joint_bodies(id)) >= {a, b}
    assert taut.jacobian(world).shape[0] == ROWS[kind]
    assert taut.gaps(world).max() < 1e-12
    assert taut.Simulator(world).step(1e-3).exact()
    assert np.isfinite(world.anchor(id)).all()


def test_couplings():
    world = taut.World()
    wheels = [world.add_body(pose=taut.Pose(p=[k, 0, 0])) for k in range(4)]
    axes = [world.axis(world.add(f"axle {k}", taut.Hinge.at(world, taut.GROUND, wheel, [k, 0, 0], [0, 0, 1])), "angle")
            for k, wheel in enumerate(wheels[:3])]
    rack = world.axis(world.add("rail", taut.Slider.at(world, taut.GROUND, wheels[3], [3, 0, 0], [0, 1, 0])), "displacement")
    world.add("gear", taut.Gear(world, axes[0], axes[1], -2.0))
    world.add("rack", taut.RackAndPinion(world, axes[1], rack, 0.5))
    world.set_motor(axes[0], taut.AxisMotor(target=1.0))
    simulator = taut.Simulator(world)
    assert simulator.run(100, 0.01).exact()
    angle = world.axis_value(axes[0])
    assert angle == pytest.approx(1.0, abs=0.02)
    assert world.axis_value(axes[1]) == pytest.approx(-2 * angle, abs=1e-9)
    assert world.axis_value(rack) == pytest.approx(-angle, abs=1e-9)
    assert world.axis_rate(axes[0]) == pytest.approx(1.0)
    with pytest.raises(ValueError):
        taut.Gear(world, axes[0], axes[0], 1.0)
    with pytest.raises(ValueError):
        taut.Differential(world, axes[0], axes[1], rack)
    taut.Differential(world, *axes)


def test_axis_properties():
    world, rod, axis = pendulum()
    world.set_limits(axis, taut.AxisLimits(-1.0, 0.5))
    world.set_spring(axis, taut.AxisSpring(stiffness=0.1, rest=0.2))
    world.set_friction(axis, taut.AxisFriction(viscous=0.1))
    world.set_motor(axis, taut.AxisMotor(taut.AxisMotor.Mode.POSITION, target=0.1, max_force=0.01))
    properties = world.axis_properties(axis)
    assert properties.limits.upper == 0.5 and properties.spring.rest == 0.2 and properties.motor.target == 0.1
    simulator = taut.Simulator(world)
    assert simulator.run(2000, 1e-3).exact()
    assert world.axis_value(axis) == pytest.approx(0.5, abs=1e-9)
    report = simulator.axis_report(axis)
    assert report.at_limit and report.force.limit < 0 and report.saturated
    # Static balance about the pivot: gravity's moment, the limit, the spring and the motor, which pulls back.
    moment = 9.81 * 0.5 * np.cos(0.5)
    assert moment + report.force.total() == pytest.approx(0, abs=1e-6)
    world.set_limits(axis, None)
    world.set_motor_target(axis, 0.3)
    assert world.axis_properties(axis).limits is None and world.axis_properties(axis).motor.target == 0.3
    for wrong in (taut.AxisLimits(1, -1), taut.AxisLimits(0, 1, restitution=2)):
        with pytest.raises(ValueError):
            world.set_limits(axis, wrong)
    table = taut.AxisSpring(table=taut.Curve([(-1, -1), (0, 0), (1, 3)]))
    world.set_spring(axis, table)
    assert world.axis_properties(axis).spring.table.points == [(-1, -1), (0, 0), (1, 3)]


def test_each_axis_property_has_a_class_and_a_setter():
    keys = [key for key in dir(taut.AxisProperties) if not key.startswith("_")]
    assert {"limits", "motor", "friction", "spring"} <= set(keys)
    for key in keys:
        world, rod, axis = pendulum()
        kind = getattr(taut, "Axis" + key.title().replace("_", ""))
        set_it = getattr(world, "set_" + key)
        set_it(axis, kind())
        properties = world.axis_properties(axis)
        assert isinstance(getattr(properties, key), kind)
        assert all(getattr(properties, other) is None for other in keys if other != key)
        world.set_axis_properties(axis, taut.AxisProperties(**{key: kind()}))
        set_it(axis, None)
        assert getattr(world.axis_properties(axis), key) is None
        numbers = [name for name in dir(kind) if not name.startswith("_") and isinstance(getattr(kind(), name), float)]
        for name in numbers:
            assert getattr(kind(**{name: 0.25}), name) == 0.25
            with pytest.raises(ValueError, match="elbow|pivot"):
                set_it(axis, kind(**{name: float("nan")}))


def test_breaking_and_compliance():
    world, rod, _ = pendulum()
    joint = world.joint("pivot")
    world.set_break(joint, taut.BreakLimits(force=10.0))
    simulator = taut.Simulator(world)
    report = simulator.step(1e-3)
    while not report.breaks and world.time < 2:
        report = simulator.step(1e-3)
    assert report.breaks[0].joint == joint and report.breaks[0].force == pytest.approx(10) and not world.is_attached(joint)
    soft, _, _ = pendulum()
    soft.set_compliance(soft.joint("pivot"), taut.JointCompliance(translation=1e-4))
    assert soft.compliance(soft.joint("pivot")).translation == 1e-4
    assert taut.Simulator(soft).run(100, 1e-3).exact()
    soft.set_compliance(soft.joint("pivot"), None)
    assert soft.compliance(soft.joint("pivot")) is None


SHAPES = [taut.Sphere(0.5), taut.Box([1, 2, 3]), taut.Capsule(0.2, 1), taut.Cylinder(0.3, 1), taut.Ellipsoid([1, 2, 3]),
          taut.Cone(0.5, 1), taut.ConvexHull([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]),
          taut.TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]), taut.HalfSpace(),
          taut.HeightField(2, 2, 1, 1, [0, 0, 0, 0])]


@pytest.mark.parametrize("shape", SHAPES, ids=lambda shape: type(shape).__name__)
def test_shapes(shape):
    world, a, _ = two_bodies()
    id = world.add_shape(a, shape, taut.Pose(p=[0, 0, 1]), taut.Material(restitution=0.5))
    record = world.shape(id)
    assert type(record.shape) is type(shape) and record.body == a and record.material.restitution == 0.5
    assert record.pose.p == pytest.approx([0, 0, 1])


def test_masses():
    box = taut.MassProperties.box([1, 2, 3], density=10)
    assert box.mass == pytest.approx(60) and box.principal_moments == pytest.approx([65, 50, 25])
    assert box.inertia_B == pytest.approx(np.diag([65, 50, 25]))
    solid = taut.solid_of([taut.PlacedShape(taut.Sphere(1), taut.Pose(p=[x, 0, 0]), 1.0) for x in (0, 4)])
    assert solid.centre == pytest.approx([2, 0, 0])
    assert solid.mass.mass == pytest.approx(8 / 3 * np.pi)
    for wrong in ({}, {"mass": 1, "density": 1}, {"mass": -1}, {"mass": float("nan")}):
        with pytest.raises(ValueError):
            taut.MassProperties.box([1, 1, 1], **wrong)
    with pytest.raises(ValueError):
        taut.MassProperties(1.0, [1, 1, 3])
    with pytest.raises(ValueError):
        taut.MassProperties(1.0, np.ones((3, 3)))


def test_ids():
    one, two = taut.BodyId(1), taut.BodyId(2)
    assert one == taut.BodyId(1) and one != two and one < two and len({one, taut.BodyId(1), two}) == 2
    assert one != taut.JointId(1) and repr(one) == "BodyId(1)" and [10, 11, 12][two] == 12
    assert repr(taut.AxisId(taut.JointId(3), 1)) == "AxisId(3, 1)"


def test_wrong_ids():
    world, rod, axis = pendulum()
    for wrong in (taut.BodyId(2), taut.BodyId(-1), taut.BodyId(2**31 - 1), taut.BodyId(-2**31)):
        for call in (world.pose, world.twist, world.mass_properties, world.name, world.wake, world.is_fixed):
            with pytest.raises(ValueError):
                call(wrong)
        with pytest.raises(ValueError):
            world.add("", taut.Ball(taut.GROUND, wrong, [0, 0, 0], [0, 0, 0]))
        with pytest.raises(ValueError):
            taut.Ball.at(world, wrong, rod, [0, 0, 0])
        with pytest.raises(ValueError):
            world.add_force(taut.PointForce(wrong, [0, 0, 0], [0, 0, 0]))
        with pytest.raises(ValueError):
            world.add_shape(wrong, taut.Sphere(1))
        with pytest.raises(ValueError):
            world.add("", taut.Rope([(taut.GROUND, [0, 0, 0]), (wrong, [0, 0, 0])], 1.0))
    simulator = taut.Simulator(world)
    simulator.step(1e-3)
    for wrong in (taut.JointId(1), taut.JointId(-1), taut.JointId(2**31 - 1)):
        for call in (simulator.reaction, simulator.mean_reaction, world.detach, world.name, world.axes, world.anchor):
            with pytest.raises(ValueError):
                call(wrong)
        for call in (simulator.axis_report, world.axis_value, world.axis_index, world.axis_properties):
            with pytest.raises(ValueError):
                call(taut.AxisId(wrong, 0))
    for wrong in (1, -1, 2**31 - 1):
        with pytest.raises(ValueError):
            world.axis_value(taut.AxisId(axis.joint, wrong))
    with pytest.raises(ValueError):
        world.set_force(taut.ForceId(0), taut.PointForce(rod, [0, 0, 0], [0, 0, 0]))
    with pytest.raises(ValueError):
        world.shape(taut.ShapeId(0))
    with pytest.raises(TypeError):
        taut.BodyId(2**40)
    with pytest.raises(TypeError):
        world.pose(1)
    with pytest.raises(ValueError):
        world.body("nobody")


@pytest.mark.parametrize("wrong", [[1, 2], [1, 2, 3, 4], "abc", 7, None, [[1], [2], [3]], [1, 2, "3"], np.ones((3, 1)),
                                   np.float64(3), {1: 2}, b"abc"])
def test_wrong_vectors(wrong):
    with pytest.raises(TypeError):
        taut.Pose(p=wrong)


@pytest.mark.parametrize("good", [[1, 2, 3], (1.0, 2, 3), np.array([1, 2, 3]), np.array([1, 2, 3], dtype=np.float32),
                                  range(1, 4), np.arange(0, 8)[1:7:2] * 0 + [1, 2, 3]])
def test_vectors_from_any_sequence(good):
    assert taut.Pose(p=good).p == pytest.approx([1, 2, 3])


def test_values_that_are_no_numbers():
    world, a, b = two_bodies()
    nan, inf = float("nan"), float("inf")
    for wrong in ([nan, 0, 0], [inf, 0, 0], [1e300, 0, 0]):
        with pytest.raises(ValueError):
            world.add_body(pose=taut.Pose(p=wrong))
        with pytest.raises(ValueError):
            world.set_twist(a, taut.Twist(w=wrong))
    for wrong in ([nan, 0, 0], [inf, 0, 0]):
        with pytest.raises(ValueError):
            taut.Ball(a, b, wrong, [0, 0, 0])
        with pytest.raises(ValueError):
            taut.Hinge.at(world, a, b, [0, 0, 0], wrong)
        with pytest.raises(ValueError):
            taut.PointForce(a, wrong, [0, 0, 0])
        with pytest.raises(ValueError):
            world.gravity = wrong
    for wrong in ([1, 1, 0, 0], [0, 0, 0, 0], [nan, 0, 0, 0]):
        with pytest.raises(ValueError):
            world.set_pose(a, taut.Pose(q=wrong))
    with pytest.raises(ValueError):
        world.add_shape(a, taut.Sphere(-1))
    with pytest.raises(ValueError):
        world.add_shape(a, taut.TriangleMesh([[0, 0, 0]], [[0, 1, 2]]))
    with pytest.raises(ValueError):
        world.add_shape(a, taut.HeightField(1000, 1000, 1, 1, [0]))
    with pytest.raises(ValueError):
        world.time = nan
    assert world.body_count == 3


def test_names():
    world, a, b = two_bodies()
    assert world.name(world.add_body()) == "body_3" and world.has_body("a") and not world.has_body("c")
    with pytest.raises(ValueError):
        world.add_body("a")
    with pytest.raises(ValueError):
        world.add("", taut.Ball.at(world, a, a, [0, 0, 0]))
    with pytest.raises(TypeError):
        world.add("", None)
    with pytest.raises(TypeError):
        world.add_force(None)


def test_copies_are_independent():
    world = chain(3)
    for other in (world.copy(), copy.copy(world), copy.deepcopy(world)):
        taut.Simulator(other).step(0.01)
        assert other.time == 0.01 and world.time == 0
    world.append(chain(2), "more ", taut.Pose(p=[0, 1, 0]))
    assert world.joint_count == 5 and world.positions[world.body("more rod 0")] == pytest.approx([0.05, 1, 0])
    with pytest.raises(ValueError, match="itself"):
        world.append(world, "again ")


def test_quaternions_are_w_x_y_z():
    quarter = taut.exp_so3([0, 0, np.pi / 2])
    assert quarter == pytest.approx([HALF, 0, 0, HALF])
    pose = taut.Pose(q=quarter, p=[1, 0, 0])
    assert pose.point([1, 0, 0]) == pytest.approx([1, 1, 0]) and pose.local([1, 1, 0]) == pytest.approx([1, 0, 0])
    assert pose.rotation() == pytest.approx(np.array([[0, -1, 0], [1, 0, 0], [0, 0, 1]]))
    assert (pose * taut.Pose(p=[1, 0, 0])).p == pytest.approx([1, 1, 0])
    assert taut.log_so3(quarter) == pytest.approx([0, 0, np.pi / 2])
    assert taut.rotation_between([1, 0, 0], [0, 1, 0]) == pytest.approx(quarter)


def test_materials():
    world, a, b = two_bodies()
    ice = world.add_material("ice", taut.Material(static_friction=0.02, dynamic_friction=0.02))
    shape = world.add_shape(a, taut.Sphere(1))
    other = world.add_shape(b, taut.Sphere(1))
    world.set_material(shape, ice)
    assert world.material("ice") == ice and world.shape(shape).material.static_friction == 0.02
    assert world.contact_material(shape, other).static_friction == pytest.approx(0.1)
    world.set_contact_material(shape, other, taut.Material(restitution=1))
    assert world.contact_material(other, shape) == taut.Material(restitution=1)
    slow = taut.Material(rolling_friction_linear=0.01, spinning_friction_linear=0.02)
    assert taut.combined(slow, taut.Material()).spinning_friction_linear == slow.spinning_friction_linear == 0.02
    with pytest.raises(ValueError, match="linear rolling friction.*-1"):
        world.add_material("bad", taut.Material(rolling_friction_linear=-1))
    assert world.may_collide(a, b)
    world.set_collision(a, b, False)
    assert not world.may_collide(a, b)


def test_parts_of_values_outlive_what_takes_their_place():
    placed = taut.PlacedShape(taut.ConvexHull([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]]))
    hull = placed.shape
    placed.shape = taut.Sphere(1)
    assert len(hull.points) == 4 and type(placed.shape) is taut.Sphere
    spring = taut.AxisSpring(table=taut.Curve([(0, 0), (1, 1)]))
    table = spring.table
    spring.table = None
    assert table.points == [(0, 0), (1, 1)] and spring.table is None
    motor = taut.AxisMotor(force_of_speed=table)
    motor.force_of_speed = None
    assert motor.force_of_speed is None and table.held(7.0) == 1
