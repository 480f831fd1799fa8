#!/usr/bin/env python3
"""Masses and short motions of models by MuJoCo:  mujoco_references.py FOLDER > references.json     (pip install mujoco)

For every .xml and .urdf under the folder: total mass [kg], centre of mass [m] and inertia about it [kg m^2] in world
axes at the start, or the first line of what the compiler says against the model.  It reads copies without what does
not matter here and may be missing: pictures of textures; in URDF also shapes (its masses are those of <inertial>),
and with links that are fixed to each other kept apart.

Of models without deformable parts also where centres of mass of bodies are at the start and after TIME, by RK4 with
steps of 1e-4 s, without contacts, limits, dry friction, air, and armature of ball joints, with controls of 0; the root
of a URDF is held.  Models of few bodies set off with velocities.

Equalities of MuJoCo are soft: they close at a time constant, and give way to forces as its square.  Models that have
them, closed at the start, move with each of TIME_CONSTANTS, which all of their equalities have: "soft" is where their
bodies are then.  Positions after TIME are what these tend to, extrapolated: those with rigid joints.
"""
import json, pathlib, re, shutil, sys, tempfile

import mujoco
import numpy as np

TIME, STEP, MOST_BODIES, MOST_MOVING = 0.1, 1e-4, 8, 24
TIME_CONSTANTS = [2e-3, 1e-3, 5e-4]  # [s], of equalities; each half of the one before
OPEN = 1e-9  # [m or rad], of an equality at the start
KEEP_LINKS = '<mujoco><compiler fusestatic="false"/></mujoco>'


def without_pictures(text):
    def plain(match):
        name = re.search(r'\bname="([^"]*)"', match[0])
        name = name[1] if name else pathlib.Path(re.search(r'\bfile\w*="([^"]*)"', match[0])[1]).stem
        return f'<texture name="{name}" type="2d" builtin="flat" width="8" height="8"/>'
    return re.sub(r"<texture\b(?=[^>]*\bfile)[^>]*?/>", plain, text, flags=re.S)


def without_shapes(text):
    text = re.sub(r"<(visual|collision)\b.*?</\1>", "", text, flags=re.S)
    return re.sub(r"(<robot\b[^>]*>)", r"\1" + KEEP_LINKS, text, count=1)


def masses(model):
    data = mujoco.MjData(model)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    mass = model.body_mass.sum()
    centre = (model.body_mass[:, None] * data.xipos).sum(0) / mass if mass > 0 else np.zeros(3)
    inertia = np.zeros((3, 3))
    for b in range(model.nbody):
        R, r = data.ximat[b].reshape(3, 3), data.xipos[b] - centre
        inertia += R @ np.diag(model.body_inertia[b]) @ R.T + model.body_mass[b] * (r @ r * np.eye(3) - np.outer(r, r))
    return {"mass": mass, "centre": centre.tolist(), "inertia": inertia.tolist(), "deformable": bool(model.nflex)}


def start_velocities(model, data):
    """Joints turn and slide at some speed, but those that share a body; by body: centre of mass, w and v."""
    for j in range(model.njnt):
        first = model.jnt_dofadr[j]
        if model.body_jntnum[model.jnt_bodyid[j]] == 1:
            count = {0: 6, 1: 3}.get(model.jnt_type[j], 1)
            data.qvel[first:first + count] = np.sin(1 + first + np.arange(count))
    mujoco.mj_forward(model, data)
    keep_closed(model, data)
    result, twist = {}, np.zeros(6)
    for b in range(1, model.nbody):
        if model.body_weldid[b] != 0:
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, b, twist, 0)
            result[model.body(b).name] = data.xipos[b].tolist() + twist.tolist()
    return result


def equality_rows(model, data):
    rows = np.zeros((data.nefc, model.nv))
    if mujoco.mj_isSparse(model):
        mujoco.mju_sparse2dense(rows, data.efc_J, data.efc_J_rownnz, data.efc_J_rowadr, data.efc_J_colind)
    else:
        rows = data.efc_J.reshape(-1, model.nv)[:data.nefc].copy()
    return rows[:data.ne]


def keep_closed(model, data):
    """Takes out of the velocities what opens equalities, with the least energy."""
    if not data.ne:
        return
    J, M = equality_rows(model, data), np.zeros((model.nv, model.nv))
    mujoco.mj_fullM(model, data, M)
    by_M = np.linalg.solve(M, J.T)
    data.qvel[:] -= by_M @ np.linalg.lstsq(J @ by_M, J @ data.qvel, rcond=1e-12)[0]
    mujoco.mj_forward(model, data)


def smooth(model):
    """Without what the comparison leaves out; whatever equalities there are, exactly solved."""
    off = mujoco.mjtDisableBit
    model.opt.disableflags |= off.mjDSBL_CONTACT | off.mjDSBL_LIMIT | off.mjDSBL_FRICTIONLOSS
    model.opt.enableflags = 0
    model.opt.integrator, model.opt.timestep = mujoco.mjtIntegrator.mjINT_RK4, STEP
    model.opt.density = model.opt.viscosity = 0
    if model.neq:
        model.opt.solver, model.opt.iterations, model.opt.tolerance = mujoco.mjtSolver.mjSOL_NEWTON, 100, 0
    model.tendon_armature[:] = model.body_gravcomp[:] = 0
    scalar = [model.jnt_type[j] >= 2 for j in model.dof_jntid]  # slides and hinges
    model.dof_armature[:] *= scalar


def run(model, time_constant):
    """Names of bodies that move; centres of mass of all at the start and the end; velocities at the start."""
    model.eq_solref[:] = [time_constant, 1]
    model.eq_solimp[:] = [0.9, 0.9, 0.001, 0.5, 2]
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    if data.ne and np.abs(data.efc_pos[:data.ne]).max() > OPEN:
        return None
    names = [model.body(b).name for b in range(1, model.nbody) if model.body_weldid[b] != 0]
    velocities = start_velocities(model, data) if len(names) <= MOST_MOVING and all(names) else {}
    start = data.xipos.copy()
    for _ in range(round(TIME / STEP)):
        mujoco.mj_step(model, data)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    if any(warning.number for warning in data.warning):
        return None
    return names, start, data.xipos.copy(), velocities


def limit(ends):
    """Of what has an error of order 2 in the time constant."""
    if len(ends) == 1:
        return ends[0]
    return [fine + (fine - coarse) / 3 for coarse, fine in zip(*ends[-2:])]


def motion(model):
    if model.nflex or model.nplugin or not model.nv or model.nbody > 80:
        return {}
    smooth(model)
    runs = [run(model, time_constant) for time_constant in (TIME_CONSTANTS if model.neq else [1])]
    if None in runs:
        return {}
    names, start, end, velocities = runs[-1]
    chosen = [name for name in names if name]
    chosen = chosen[:: max(1, -(-len(chosen) // MOST_BODIES))]
    ends = {name: [done[2][model.body(name).id].tolist() for done in runs] for name in chosen}
    positions = {name: [start[model.body(name).id].tolist(), limit(ends[name])] for name in chosen}
    if not positions:
        return {}
    return {"positions": positions, "velocities": velocities} | ({"soft": ends} if model.neq else {})


def reference(path):
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        model = spec.compile()
        return masses(model) | motion(model)
    except ValueError as error:  # of the compiler
        return {"refused": str(error).replace(str(path.parent) + "/", "").split("\n")[0][:160]}


def main(folder):
    with tempfile.TemporaryDirectory() as copy:
        copy = pathlib.Path(copy) / "models"
        shutil.copytree(folder, copy)
        paths = sorted([*copy.rglob("*.xml"), *copy.rglob("*.urdf")])
        for path in paths:
            text = path.read_text(errors="replace")
            path.write_text(without_shapes(text) if path.suffix == ".urdf" else without_pictures(text))
        lines = [f'"mujoco": "{mujoco.__version__}", "time": {TIME}, "time_constants": {TIME_CONSTANTS}']
        lines += [f'"{path.relative_to(copy)}": {json.dumps(reference(path))}' for path in paths]
        print("{\n" + ",\n".join(lines) + "\n}")


main(pathlib.Path(sys.argv[1]))
