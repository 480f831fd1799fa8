#!/usr/bin/env python3
"""Masses of models by MuJoCo's compiler:  mujoco_references.py FOLDER > references.json     (pip install mujoco)

For every .xml and .urdf under the folder: total mass [kg], centre of mass [m] and inertia about it [kg m^2] in world
axes at the start, or the first line of what the compiler says against the model.  It reads copies without what does
not matter here and may be missing: pictures of textures; in URDF also shapes (its masses are those of <inertial>),
and with links that are fixed to each other kept apart.
"""
import json, pathlib, re, shutil, sys, tempfile

import mujoco
import numpy as np

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


def main(folder):
    result = {"mujoco": mujoco.__version__}
    with tempfile.TemporaryDirectory() as copy:
        copy = pathlib.Path(copy) / "models"
        shutil.copytree(folder, copy)
        for path in [*copy.rglob("*.xml"), *copy.rglob("*.urdf")]:
            text = path.read_text(errors="replace")
            path.write_text(without_shapes(text) if path.suffix == ".urdf" else without_pictures(text))
        for path in sorted([*copy.rglob("*.xml"), *copy.rglob("*.urdf")]):
            name = str(path.relative_to(copy))
            try:
                result[name] = masses(mujoco.MjModel.from_xml_path(str(path)))
            except Exception as error:
                result[name] = {"refused": str(error).replace(str(copy) + "/", "").split("\n")[0][:160]}
    json.dump(result, sys.stdout, indent=1)


main(pathlib.Path(sys.argv[1]))
