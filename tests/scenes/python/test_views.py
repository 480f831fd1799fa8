"""Arrays of a state: without copies, and never stale."""

import gc

import numpy as np
import pytest
from conftest import chain, pendulum

import taut


def address(array):
    return array.__array_interface__["data"][0]


def test_views_are_no_copies():
    world = chain(10)
    assert address(world.positions) == address(world.positions)
    assert address(world.poses_xyzw) + 4 * 8 == address(world.positions)
    assert address(world.twists) == address(world.twists)
    assert not world.positions.flags.writeable
    with pytest.raises(ValueError):
        world.twists[0, 0] = 1


def test_columns():
    world = taut.World()
    q = np.array([0.1, 0.2, 0.3, 0.4]) / np.sqrt(0.3)
    body = world.add_body(pose=taut.Pose(q=q, p=[1, 2, 3]), twist=taut.Twist(w=[4, 5, 6], v=[7, 8, 9]))
    assert world.poses[body] == pytest.approx([*q, 1, 2, 3])
    assert world.poses_xyzw[body] == pytest.approx([*q[1:], q[0], 1, 2, 3])
    assert world.positions[body] == pytest.approx([1, 2, 3])
    assert world.quaternions[body] == pytest.approx(q)
    assert world.twists[body] == pytest.approx([4, 5, 6, 7, 8, 9])
    assert world.pose(body).q == pytest.approx(q)


def test_a_view_goes_on_showing_its_instant():
    world = chain(10)
    simulator = taut.Simulator(world)
    simulator.step(0.01)
    seen, copies = [], []
    for _ in range(20):
        seen.append((world.positions, world.twists, world.poses_xyzw))
        copies.append(tuple(array.copy() for array in seen[-1]))
        simulator.step(0.01)
    for arrays, values in zip(seen, copies):
        for array, value in zip(arrays, values):
            assert (array == value).all()
    assert not (seen[0][0] == world.positions).all()


def test_taking_views_changes_no_bit():
    def end(look):
        scene = taut.build_scene("pile", n=5)
        simulator = taut.Simulator(scene.world, scene.settings)
        kept = []
        for k in range(100):
            simulator.step(scene.dt)
            if look and k % 3 == 0:
                kept.append(scene.world.poses_xyzw)
        return scene.world.poses.tobytes(), scene.world.twists.tobytes()

    assert end(True) == end(False)


@pytest.mark.parametrize("change", [
    lambda world, simulator: world.add_body(),
    lambda world, simulator: [world.add_body() for _ in range(1000)],
    lambda world, simulator: world.set_pose(world.body("rod 1"), taut.Pose(p=[9, 9, 9])),
    lambda world, simulator: world.set_state(world.state),
    lambda world, simulator: world.append(chain(2), "more "),
    lambda world, simulator: simulator.assemble(),
    lambda world, simulator: simulator.restore(simulator.checkpoint()),
    lambda world, simulator: simulator.run(7, 0.01),
    lambda world, simulator: world.set_twist(world.body("rod 1"), taut.Twist(v=[1, 0, 0])),
])
def test_views_outlive_changes(change):
    world = chain(3)
    simulator = taut.Simulator(world)
    simulator.step(0.01)
    views = world.positions, world.twists, world.axis_values
    values = [view.copy() for view in views]
    change(world, simulator)
    gc.collect()
    assert all((view == value).all() for view, value in zip(views, values))


def test_views_outlive_their_world_and_simulator():
    world = chain(3)
    simulator = taut.Simulator(world)
    simulator.step(0.01)
    view, value = world.positions, world.positions.copy()
    del world, simulator
    gc.collect()
    junk = [np.ones((4, 7)) for _ in range(100)]  # takes freed memory, if it is
    assert (view == value).all() and junk
    scene_view = taut.build_scene("pendulum-ball").world.positions
    gc.collect()
    assert np.isfinite(scene_view).all()


def test_a_simulator_keeps_its_world():
    simulator = taut.Simulator(chain(3))
    gc.collect()
    assert simulator.step(0.01).exact()
    assert simulator.world.body_count == 4
    world = simulator.world
    del simulator
    gc.collect()
    assert world.positions.shape == (4, 3)


def test_a_scene_keeps_its_world():
    world = taut.build_scene("net", n=3).world
    gc.collect()
    assert taut.Simulator(world).step(1e-3).exact()


def test_state_is_a_copy_that_can_be_written_to():
    world, rod, _ = pendulum()
    state = world.state
    state.positions[rod] = [0, 0, -0.5]
    state.quaternions = [[1, 0, 0, 0], [np.sqrt(0.5), 0, np.sqrt(0.5), 0]]
    assert world.positions[rod] == pytest.approx([0.5, 0, 0])
    world.set_state(state)
    assert world.positions[rod] == pytest.approx([0, 0, -0.5])
    assert taut.gaps(world).max() < 1e-12
    view = state.positions
    del state
    gc.collect()
    assert view[rod] == pytest.approx([0, 0, -0.5])


def test_bad_states_are_refused():
    world, rod, _ = pendulum()
    other = chain(3).state
    with pytest.raises(ValueError):
        world.set_state(other)
    state = world.state
    state.positions[rod] = np.nan
    with pytest.raises(ValueError):
        world.set_state(state)
    state = world.state
    state.poses_xyzw[rod, :4] = 0
    with pytest.raises(ValueError):
        world.set_state(state)
    with pytest.raises(ValueError, match="one row per body"):
        state.quaternions = np.ones((5, 4))
    with pytest.raises(TypeError):
        state.quaternions = np.ones((2, 3))
    assert world.positions[rod] == pytest.approx([0.5, 0, 0])


def test_many_bodies_without_a_loop():
    world = chain(2000)
    assert world.positions[1:, 0].mean() == pytest.approx(100, rel=1e-3)


@pytest.mark.parametrize("ask", [lambda simulator: simulator.mean_reactions(), lambda simulator: simulator.reactions()])
def test_reactions_are_filled_once_a_step(ask):
    world = chain(10)
    simulator = taut.Simulator(world)
    simulator.step(0.01)
    first = ask(simulator)
    assert first.shape == (world.joint_count, 6) and not first.flags.writeable and not first.flags.owndata
    assert address(ask(simulator)) == address(first)
    with pytest.raises(ValueError):
        first[0, 0] = 1
    for joint in (taut.JointId(0), taut.JointId(world.joint_count - 1)):  # row j is the joint of id j
        one = simulator.mean_reaction(joint) if (ask(simulator) == simulator.mean_reactions()).all() else simulator.reaction(joint)
        assert (first[joint.index] == [*one.torque, *one.force]).all()
    before = first.copy()
    simulator.step(0.01)
    assert not (ask(simulator) == before).all()
    assert (first == before).all()  # it goes on showing its step


def test_reactions_follow_what_is_set():
    world, rod, hinge = pendulum()
    simulator = taut.Simulator(world)
    simulator.step(1e-3)
    heavy = simulator.reactions()
    world.gravity = [0, 0, 0]
    assert np.abs(simulator.reactions()).max() < np.abs(heavy).max() / 10
    world.gravity = [0, 0, -9.81]
    assert simulator.reactions() == pytest.approx(heavy)
    world.set_pose(rod, world.pose(rod))
    assert simulator.reactions() == pytest.approx(heavy)


@pytest.mark.parametrize("ask", [lambda simulator: simulator.mean_reactions(), lambda simulator: simulator.reactions()])
def test_reactions_after_a_checkpoint_and_without_their_simulator(ask):
    world = chain(5)
    simulator = taut.Simulator(world)
    simulator.run(3, 0.01)
    then, checkpoint = ask(simulator), simulator.checkpoint()
    value = then.copy()
    simulator.run(20, 0.01)
    later = ask(simulator)
    assert not (later == value).all()
    simulator.restore(checkpoint)
    again = ask(simulator)
    assert again == pytest.approx(value, rel=1e-9, abs=1e-9) or not again.any()  # means are of a step since
    assert (then == value).all() and not (later == value).all()
    simulator.step(0.01)
    del simulator, world
    gc.collect()
    junk = [np.ones((5, 6)) for _ in range(100)]  # takes freed memory, if it is
    assert (then == value).all() and junk
