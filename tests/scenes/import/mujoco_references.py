#!/usr/bin/env python3
"""Masses and short motions of models by MuJoCo:  mujoco_references.py FOLDER > references.json     (pip install mujoco)

For every .xml and .urdf under the folder: total mass [kg], centre of mass [m] and inertia about it [kg m^2] in world
axes at the start, or the first line of what the compiler says against the model.  It reads copies without what does
not matter here and may be missing: pictures of textures; in URDF also shapes (its masses are those of <inertial>),
and with links that are fixed to each other kept apart.

Of models without deformable parts and loops also where centres of mass of bodies are at the start and after TIME, by RK4 with steps of 1e-4 s, without
contacts, limits, dry friction, air, and armature of ball joints, with controls of 0; the root of a URDF is held.  Models of few
bodies set off with velocities.
"""
import json, pathlib, re, shutil, sys, tempfile

import mujoco
import numpy as np

TIME, STEP, MOST_BODIES, MOST_MOVING = 0.1, 1e-4, 8, 24
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
    result, twist = {}, np.zeros(6)
    for b in range(1, model.nbody):
        if model.body_weldid[b] != 0:
            mujoco.mj_objectVelocity(model, data, mujoco.mjtObj.mjOBJ_BODY, b, twist, 0)
            result[model.body(b).name] = data.xipos[b].tolist() + twist.tolist()
    return result


def motion(model):
    if model.nflex or model.neq or model.nplugin or not model.nv or model.nbody > 80:
        return {}
    off = mujoco.mjtDisableBit
    model.opt.disableflags |= off.mjDSBL_CONTACT | off.mjDSBL_LIMIT | off.mjDSBL_FRICTIONLOSS
    model.opt.enableflags = 0
    model.opt.integrator, model.opt.timestep = mujoco.mjtIntegrator.mjINT_RK4, STEP
    model.opt.density = model.opt.viscosity = 0
    model.tendon_armature[:] = model.body_gravcomp[:] = 0
    scalar = [model.jnt_type[j] >= 2 for j in model.dof_jntid]  # slides and hinges
    model.dof_armature[:] *= scalar
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    names = [model.body(b).name for b in range(1, model.nbody) if model.body_weldid[b] != 0]
    velocities = start_velocities(model, data) if len(names) <= MOST_MOVING and all(names) else {}
    start = data.xipos.copy()
    for _ in range(round(TIME / STEP)):
        mujoco.mj_step(model, data)
    mujoco.mj_kinematics(model, data)
    mujoco.mj_comPos(model, data)
    chosen = [name for name in names if name]
    chosen = chosen[:: max(1, -(-len(chosen) // MOST_BODIES))]
    course = lambda b: [start[b].tolist(), data.xipos[b].tolist()]
    positions = {name: course(model.body(name).id) for name in chosen}
    stable = not any(warning.number for warning in data.warning)
    return {"positions": positions, "velocities": velocities} if positions and stable else {}


def reference(path):
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        model = spec.compile()
        return masses(model) | motion(model)
    except Exception as error:
        return {"refused": str(error).replace(str(path.parent) + "/", "").split("\n")[0][:160]}


def main(folder):
    with tempfile.TemporaryDirectory() as copy:
        copy = pathlib.Path(copy) / "models"
        shutil.copytree(folder, copy)
        paths = sorted([*copy.rglob("*.xml"), *copy.rglob("*.urdf")])
        for path in paths:
            text = path.read_text(errors="replace")
            path.write_text(without_shapes(text) if path.suffix == ".urdf" else without_pictures(text))
        lines = [f'"mujoco": "{mujoco.__version__}", "time": {TIME}']
        lines += [f'"{path.relative_to(copy)}": {json.dumps(reference(path))}' for path in paths]
        print("{\n" + ",\n".join(lines) + "\n}")


main(pathlib.Path(sys.argv[1]))
