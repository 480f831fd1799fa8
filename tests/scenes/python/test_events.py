"""Events, and loads that vary in time."""

import math

import pytest
from conftest import ROOT

import taut

Z = [0, 0, 1]


def stone(velocity=(0, 0, 5)):
    world = taut.World()
    body = world.add_body("stone", taut.MassProperties(2.0, [1, 1, 1]))
    world.set_twist(body, taut.Twist(v=velocity))
    return world, body


def test_an_event_of_a_time_is_at_its_time():
    world, body = stone()
    simulator = taut.Simulator(world)
    simulator.set_events([taut.Event("weightless", taut.AtTime(0.123), [taut.SetGravity([0, 0, 0])])])
    simulator.run(5, 0.1)
    (event,) = simulator.events_happened
    assert (event.name, event.time, event.value, event.what) == ("weightless", 0.123, None, "gravity [0, 0, 0]")
    assert world.twists[body, 5] == pytest.approx(5 - 9.81 * 0.123, abs=1e-12)


def test_a_function_can_be_watched():
    """z = 5 t − g t²/2 passes 1 m, by its own height and by a function of the state."""
    for watch in (lambda world, body: taut.Watch.position(world, body, along=Z),
                  lambda world, body: taut.Watch(lambda state: state.positions[1, 2], "height")):
        world, body = stone()
        simulator = taut.Simulator(world)
        simulator.set_events([taut.Event("top", taut.WhenPasses(watch(world, body), 1.0, taut.WhenPasses.Way.FALLING),
                                         [taut.EndRun()])])
        simulator.run_until(2.0, 0.03)
        exact = (5 + math.sqrt(25 - 2 * 9.81)) / 9.81
        assert exact - 1e-12 <= world.time <= exact + 4e-8
        assert simulator.ended_by == "top"


def test_what_a_watch_raises_comes_through():
    world, body = stone()
    simulator = taut.Simulator(world)
    simulator.set_events([taut.Event("x", taut.WhenPasses(taut.Watch(lambda state: "one"), 1.0), [taut.EndRun()])])
    with pytest.raises(TypeError, match="must return a number"):
        simulator.step(0.1)


def test_joints_motors_and_loads():
    world, body = stone((0, 0, 0))
    rail = world.add("rail", taut.Slider.at(world, taut.GROUND, body, [0, 0, 0], Z))
    world.detach(rail)
    lift = world.axis(rail, "displacement")
    world.set_motor(lift, taut.AxisMotor(target=0.0))
    world.gravity = [0, 0, 0]
    simulator = taut.Simulator(world)
    simulator.set_events([
        taut.Event("gust", taut.AtTime(0.05), [
            taut.ApplyLoad(body, force=[0, 8, 0], duration=0.5, factor=taut.gust_motion(1, 0, 0.5))]),
        taut.Event("take", taut.AtTime(0.75), [taut.AttachJoint(rail, taut.AttachJoint.Where.AS_IS)]),
        taut.Event("hoist", taut.AtTime(0.85), [taut.SetMotor(lift, target=0.5)]),
    ])
    simulator.run_until(0.7, 0.01)  # of order 2 in the step
    assert world.twists[body, 4] == pytest.approx(0.5 * 8 * 0.5 / 2, abs=1e-3)
    simulator.run_until(1.0, 0.1)
    assert world.twists[body, 3:] == pytest.approx([0, 0, 0.5], abs=1e-9)
    assert [event.name for event in simulator.events_happened] == ["gust", "take", "hoist"]


def test_a_checkpoint_has_them():
    def run(steps, checkpoint=None):
        world, body = stone()
        simulator = taut.Simulator(world)
        simulator.set_events([taut.Event("a", taut.AtTime(0.15), [taut.SetGravity([0, 0, 1])]),
                              taut.Event("b", taut.AtTime(0.45), [taut.SetGravity([0, 0, 2])])])
        if checkpoint:
            simulator.restore(checkpoint)
        simulator.run(steps, 0.1)
        return world, simulator

    world, simulator = run(3)
    other, again = run(4, simulator.checkpoint())
    simulator.run(4, 0.1)
    assert (other.positions == world.positions).all()
    assert [event.time for event in again.events_happened] == [0.15, 0.45]
    with pytest.raises(ValueError, match="other events"):
        taut.Simulator(stone()[0]).restore(simulator.checkpoint())


def test_bad_events_are_refused_by_name():
    world, body = stone()
    simulator = taut.Simulator(world)
    with pytest.raises(ValueError, match="event x: time: must be finite"):
        simulator.set_events([taut.Event("x", taut.AtTime(math.nan), [taut.EndRun()])])
    with pytest.raises(TypeError):
        taut.Event("x", 3, [taut.EndRun()])


def test_a_scene_file_has_events():
    scene = taut.load_scene(ROOT / "scenes" / "examples" / "crane_hook.json")
    assert [event.name for event in scene.events] == ["take", "hoist", "gust", "let go", "down"]
    film = taut.simulate(scene)
    assert film.simulator.ended_by == "down"
    assert [event.name for event in film.simulator.events_happened] == ["take", "hoist", "gust", "let go", "down"]


def test_loads_by_functions_of_time():
    world, body = stone()
    ramp = taut.ramp_motion(0, 1, 0, 2)
    world.add_force(taut.PointForce(body, [0, 0, 0], [4, 0, 0], factor=ramp))
    world.add_force(taut.BodyTorque(body, [0, 0, 4], factor=lambda t: (t, 1.0, 0.0)))
    world.add_force(taut.AccelerationField([(body, 2.0)], [0, 3, 0], taut.table_motion(taut.Curve([(0, 0), (1, 2)]))))
    world.time = 0.5
    assert world.forces()[body] == pytest.approx([0, 0, 2, 1, 6, -2 * 9.81])
    assert taut.harmonics_motion(1, [(2, 3, 0.5)])(0.7)[0] == pytest.approx(1 + 2 * math.sin(3 * 0.7 + 0.5))
    assert taut.gust_motion(2, 1, 1)(1.5)[0] == pytest.approx(2)


def test_a_joint_is_closed_where_it_is():
    world, body = stone()
    pin = world.add("pin", taut.Ball.at(world, taut.GROUND, body, [0, 0, 0]))
    world.detach(pin)
    world.set_pose(body, taut.Pose(p=[1, 2, 3]))
    assert taut.gap_of(world, pin).metres == pytest.approx(math.sqrt(14))
    world.set_joint_frame(pin, taut.closing_frame(world, pin))
    assert taut.gap_of(world, pin).metres < 1e-12
