#!/usr/bin/env python3
"""How MuJoCo moves an exported model that it starts from its key:  mujoco_motion.py MODEL.xml > MODEL.motion.json     (pip install mujoco)

Positions of the bodies of the model [m] after TIME, by RK4 with steps of STEP.  `taut export` has written the model:
    taut export tests/scenes/export/servo_arm.json -o tests/scenes/export/servo_arm.xml
"""
import json, sys

import mujoco

TIME, STEP = 0.25, 1e-4

model = mujoco.MjModel.from_xml_path(sys.argv[1])
model.opt.integrator, model.opt.timestep = mujoco.mjtIntegrator.mjINT_RK4, STEP
data = mujoco.MjData(model)
mujoco.mj_resetDataKeyframe(model, data, 0)
for _ in range(round(TIME / STEP)):
    mujoco.mj_step(model, data)
json.dump({"mujoco": mujoco.__version__, "time": TIME, "joints": data.qpos.tolist(),
           "positions": {model.body(b).name: data.xipos[b].tolist() for b in range(1, model.nbody)}}, sys.stdout, indent=1)
print()
