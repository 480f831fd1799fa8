"""J, M, S and what belongs to rows."""

import numpy as np
import pytest
from conftest import chain

import taut


@pytest.fixture(params=["chain", "net", "bridge-hinge", "car"])
def world(request):
    if request.param == "chain":
        return chain(12)
    scene = taut.build_scene(request.param) if request.param == "car" else taut.build_scene(request.param, n=6)
    taut.Simulator(scene.world, scene.settings).run(20, scene.dt)
    return scene.world


def test_s_is_j_inverse_m_j_transposed(world):
    J, S = taut.jacobian(world), taut.delassus_matrix(world)
    inverse = taut.mass_matrix(world, inverse=True)
    assert J.shape == (len(taut.rows(world)), 6 * world.body_count)
    difference = abs(S - J @ inverse @ J.T).max()
    assert difference < 1e-12 * abs(S).max()
    assert S.nnz > 0 and abs(S - S.T).max() < 1e-12 * abs(S).max()


def test_m_times_its_inverse_is_one_where_bodies_move(world):
    M, inverse = taut.mass_matrix(world), taut.mass_matrix(world, inverse=True)
    moves = np.repeat([not world.is_fixed(b) for b in world.bodies()], 6)
    assert abs((M @ inverse).toarray() - np.diag(moves.astype(float))).max() < 1e-12


def test_m_gives_the_kinetic_energy(world):
    V = world.twists.ravel()
    assert V @ (taut.mass_matrix(world) @ V) / 2 == pytest.approx(world.kinetic_energy(), rel=1e-12)


def test_j_is_the_derivative_of_the_residual(world):
    """By central differences along random twists, which turn quaternions by exp(h ω / 2)."""
    J, random = taut.jacobian(world), np.random.default_rng(1)
    moves = np.array([not world.is_fixed(b) for b in world.bodies()])
    V = random.normal(size=(world.body_count, 6)) * moves[:, None]
    start, h = world.state, 1e-6

    def residual(step):
        state = taut.State(start)
        state.positions[:] += step * V[:, 3:]
        q = state.quaternions
        turned = []
        for (w, *xyz), omega in zip(q, V[:, :3]):
            W, *XYZ = taut.exp_so3(step * omega)
            xyz, XYZ = np.array(xyz), np.array(XYZ)
            turned.append([W * w - XYZ @ xyz, *(W * xyz + w * XYZ + np.cross(XYZ, xyz))])
        state.quaternions = np.array(turned) / np.linalg.norm(turned, axis=1)[:, None]
        moved = world.copy()
        moved.set_state(state)
        return taut.residual(moved)

    difference = (residual(h) - residual(-h)) / (2 * h)
    assert J @ V.ravel() == pytest.approx(difference, abs=1e-7 * (1 + abs(J @ V.ravel()).max()))


def test_accelerations_from_the_matrices_are_those_of_a_step():
    """(ΔV)/h of a small step against M V̇ = f + Jᵀ λ, J V̇ = −γ, at rest."""
    world = chain(5)
    J, inverse = taut.jacobian(world).toarray(), taut.mass_matrix(world, inverse=True).toarray()
    S = taut.delassus_matrix(world).toarray()
    f = taut.World.forces(world).ravel()
    lam = np.linalg.solve(S, -(taut.bias(world) + J @ inverse @ f))
    acceleration = inverse @ (f + J.T @ lam)
    simulator, h = taut.Simulator(world), 1e-6
    simulator.step(h)
    assert world.twists.ravel() / h == pytest.approx(acceleration, abs=1e-4)


def test_gaps_and_rows():
    world = chain(3)
    world.set_pose(world.body("rod 2"), taut.Pose(p=[0.25, 0, 0.5]))
    assert taut.gaps(world) == pytest.approx(np.array([[0, 0], [0, 0], [0.5, 0]]), abs=1e-12)
    joint, name, equality = taut.rows(world)[-1]
    assert world.name(joint) == "ball 2" and "translation" in name and equality
    assert taut.residual(world)[-3:] == pytest.approx([0, 0, 0.5])
    assert world.validate()[0][0] == "ball ball 2"


def test_no_rows():
    world = taut.World()
    assert taut.jacobian(world).shape == (0, 6)
    assert taut.delassus_matrix(world).shape == (0, 0)
    assert taut.gaps(world).shape == (0, 2)
    with pytest.raises(ValueError, match="joints"):
        taut.natural_modes(world)
