"""Models of robots, read and written: what Python gets is what the program says of the same files."""

import json
import os
import pathlib
import subprocess
import warnings

import numpy as np
import pytest
from conftest import ROOT, rotation

import taut

MODELS = ROOT / "tests/scenes/import/models"
KINOVA = MODELS / "urdf/matlab_kinova_description_urdf_kinovaJacoJ2S6S300.urdf"
CATENARY = MODELS / "mjcf/test_engine_testdata_catenary.xml"
EQUALITY = MODELS / "mjcf/test_engine_testdata_sleep_equality.xml"
AL5D = MODELS / "urdf/robotics-toolbox_al5d_description_urdf_al5d_robot.urdf"

FOUR_BAR = """<mujoco>
  <default><geom type="capsule" size="0.01" contype="0" conaffinity="0"/></default>
  <worldbody>
    <body name="crank">
      <joint name="crank" axis="0 1 0"/>
      <geom fromto="0 0 0 0.1 0 0.2"/>
      <body name="coupler" pos="0.1 0 0.2">
        <joint name="pin" axis="0 1 0"/>
        <geom fromto="0 0 0 0.4 0 0"/>
      </body>
    </body>
    <body name="rocker" pos="0.5 0 -0.2">
      <joint name="rocker" axis="0 1 0"/>
      <geom fromto="0 0 0 0 0 0.4"/>
    </body>
  </worldbody>
  <equality><connect name="loop" body1="coupler" body2="rocker" anchor="0.4 0 0"/></equality>
  <actuator><position name="servo" joint="crank" kp="3"/></actuator>
</mujoco>
"""


@pytest.mark.parametrize("file", [KINOVA, CATENARY, EQUALITY], ids=lambda file: file.stem)
def test_what_the_program_says(program, file, tmp_path):
    out = tmp_path / "scene.json"
    said = subprocess.run([program, "import", file, "-o", out], check=True, capture_output=True, text=True).stderr.splitlines()
    text, notices = taut.model_scene_text(file)
    assert text == out.read_text()
    assert [str(notice) for notice in notices] == said[:-1] and len(notices) > 3
    scene, same = taut.load_model(file)
    assert [str(notice) for notice in same] == said[:-1]
    world = scene.world
    assert said[-1].startswith(f"taut: {world.moving_body_count} moving bodies, {world.joint_count} joints, {world.shape_count} shapes")


def test_an_arm_from_a_urdf():
    scene, notices = taut.load_model(KINOVA)
    world = scene.world
    assert scene.name == "j2s6s300" and world.moving_body_count == 12
    bodies, joints = [world.name(body) for body in world.bodies()], [world.name(joint) for joint in world.joints()]
    assert {"j2s6s300_link_1", "j2s6s300_link_6", "j2s6s300_link_finger_3"} <= set(bodies)
    assert {"j2s6s300_joint_2", "j2s6s300_joint_finger_1"} <= set(joints)
    joint = world.joint("j2s6s300_joint_2")
    assert world.joint_type(joint) == "hinge" and world.axes(joint) == ["angle"]
    # <limit lower="0.8203…" upper="5.4629…"/>, and the start at the lower one, which is 0 in the scene
    limits = world.axis_properties(world.axis(joint, "angle")).limits
    assert (limits.lower, limits.upper) == (0, 5.46288055874 - 0.820304748437)
    assert any('"j2s6s300_joint_2" starts at 0, beyond its limits' in notice.message for notice in notices)
    meant = next(notice for notice in notices if notice.message.startswith("<transmission>"))
    assert pathlib.Path(meant.file) == KINOVA and meant.line == 132 and meant.count == 9
    assert "<transmission" in KINOVA.read_text().splitlines()[meant.line - 1]
    assert str(meant) == f"{KINOVA}:132: <transmission>: of controllers, left out (and 8 more)"
    assert str(meant) in repr(meant)


def test_a_closed_loop(tmp_path):
    file = tmp_path / "four_bar.xml"
    file.write_text(FOUR_BAR)
    scene, notices = taut.load_model(file)
    world = scene.world
    joints = {world.name(joint): world.joint_type(joint) for joint in world.joints()}
    assert joints == {"crank": "hinge", "pin": "hinge", "rocker": "hinge", "loop": "ball"}
    # An actuator is a motor, here a servo to a control of 0, and a notice with its name.
    assert world.axis_properties(world.axis(world.joint("crank"), "angle")).motor.stiffness == 3
    assert [notice.line for notice in notices if '<position> "servo"' in notice.message] == [18]
    simulator = taut.Simulator(world, scene.settings)
    if scene.assemble:
        assert simulator.assemble().exact()
    coupler, rocker = world.body("coupler"), world.body("rocker")

    def point(body, local):
        pose = world.poses[body]
        return pose[4:] + rotation(pose[:4]) @ local

    turned = 0
    for _ in range(200):
        assert simulator.step(scene.dt).exact()
        # Each is a capsule about its centre: the loop is at its end.
        assert point(coupler, [0.2, 0, 0]) == pytest.approx(point(rocker, [0, 0, 0.2]), abs=1e-9)
        assert point(rocker, [0, 0, -0.2]) == pytest.approx([0.5, 0, -0.2], abs=1e-9)
        turned = max(turned, abs(world.axis_value(world.axis(world.joint("crank"), "angle"))))
    assert turned > 0.05


def test_a_loop_through_the_ground_by_a_rope():
    scene, _ = taut.load_model(CATENARY)
    world = scene.world
    rope = next(joint for joint in world.joints() if world.joint_type(joint) == "rope")
    simulator = taut.Simulator(world, scene.settings)
    assert simulator.run(500, scene.dt).ok()
    assert world.axis_value(world.axis(rope, "length")) <= 0.5 + 1e-9  # range="0 .5"


def test_documents(tmp_path):
    text, _ = taut.model_scene_text(EQUALITY)
    document = json.loads(text)
    assert document["format"] == "taut-scene/1" and len(document["bodies"]) == 9 - 1
    parsed = taut.parse_scene(text, str(EQUALITY), by_hand=False)
    loaded, _ = taut.load_model(EQUALITY)
    assert parsed.world.poses.tobytes() == loaded.world.poses.tobytes() and parsed.dt == loaded.dt


def test_refused(tmp_path):
    with pytest.raises(taut.ModelError, match='"base" moves') as caught:
        taut.load_model(AL5D)
    error = caught.value
    assert isinstance(error, ValueError) and pathlib.Path(error.file) == AL5D and error.line == 10
    assert str(error).startswith(f"{AL5D}:10: ")
    assert "base" in AL5D.read_text().splitlines()[9]
    with pytest.raises(taut.ModelError, match="there is no such file") as caught:
        taut.load_model(tmp_path / "nowhere.urdf")
    assert caught.value.file == str(tmp_path / "nowhere.urdf") and caught.value.line == 0
    odd = tmp_path / os.fsdecode(b"odd\xff.urdf")
    odd.write_bytes(b'<robot name="r">\n<link name="a"/><joint name="b" type="sl\xffide"/></robot>')
    for read in (taut.load_model, taut.model_scene_text):
        with pytest.raises(taut.ModelError) as caught:
            read(odd)
        assert caught.value.file == str(odd) and caught.value.line == 2
    two = tmp_path / "two.urdf"
    two.write_text('<robot name="r">\n<link name="a"/>\n<joint name="b" type="slide"/>\n<joint name="c" type="hing"/>\n</robot>')
    with pytest.raises(taut.ModelError) as caught:
        taut.load_model(two)
    problems = caught.value.problems
    assert [(file, line) for file, line, message in problems] == [(str(two), 3), (str(two), 4)]
    assert all(f"{two}:{line}: {message}" in str(caught.value) for _, line, message in problems)
    for text in ("", "<robot", "<html/>", "<mujoco><worldbody>" + 500 * "<body>"):
        odd.write_text(text)
        with pytest.raises(taut.ModelError):
            taut.load_model(odd)
    for wrong in (None, 3, ["a.urdf"]):
        with pytest.raises(TypeError):
            taut.load_model(wrong)


def test_open_scene(tmp_path):
    assert taut.open_scene("bridge-hinge", n=3).world.moving_body_count == 3
    assert taut.open_scene(ROOT / "scenes/examples/four_bar.json").world.joint_count > 3
    with pytest.warns(UserWarning, match=r"\d+ kinds of things in .*catenary.* load_model\(\) lists them"):
        assert taut.open_scene(CATENARY).world.moving_body_count == 2
    plain = tmp_path / "plain.xml"
    plain.write_text('<mujoco><worldbody><body><joint type="ball"/><geom size="0.1" pos="1 0 0"/></body></worldbody></mujoco>')
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        taut.open_scene(str(plain))
        with pytest.raises(UserWarning):
            taut.open_scene(CATENARY)
    with pytest.raises(ValueError, match="no parameters"):
        taut.open_scene(CATENARY, n=3)
    with pytest.raises(ValueError):
        taut.open_scene("nothing")
    assert taut.is_model_file("a.urdf") and taut.is_model_file("b.sdf") and not taut.is_model_file("c.json")


def loop_of_rods():
    """Three rods in a triangle: a tree of two, and what closes it."""
    world = taut.World()
    corners = np.array([[0, 0, 0], [1, 0, 0], [0.5, 0, 0.8]])
    rods = []
    for k in range(3):
        ends = corners[k], corners[(k + 1) % 3]
        rods.append(world.add_body(f"rod {k}", taut.MassProperties.rod(0.9, 0.02, 0.5 + k), taut.Pose(p=(ends[0] + ends[1]) / 2)))
    world.add("base", taut.Hinge.at(world, taut.GROUND, rods[0], corners[0], [0, 1, 0]))
    for k in range(3):
        world.add(f"corner {k}", taut.Ball.at(world, rods[k], rods[(k + 1) % 3], corners[(k + 1) % 3]))
    return taut.Scene(world, "triangle")


@pytest.mark.parametrize("write, ending", [(taut.mjcf_of, "xml"), (taut.urdf_of, "urdf")])
def test_the_other_way(write, ending, tmp_path):
    scene = loop_of_rods()
    text, notices = write(scene)
    file = tmp_path / f"triangle.{ending}"
    file.write_text(text)
    again, _ = taut.load_model(file)
    for body in scene.world.bodies()[1:]:
        same = again.world.body(scene.world.name(body))
        assert again.world.positions[same] == pytest.approx(scene.world.positions[body], abs=1e-12)
        assert again.world.mass_properties(same).mass == pytest.approx(scene.world.mass_properties(body).mass, rel=1e-12)
    # Both close the triangle; URDF says nothing of gravity and contacts.
    assert len(notices) == (0 if ending == "xml" else 1)
    assert sorted(again.world.joint_type(joint) for joint in again.world.joints()) == ["ball", "ball", "ball", "hinge"]


def test_models_that_the_program_writes(program, tmp_path):
    for ending, write in ("xml", taut.mjcf_of), ("urdf", taut.urdf_of):
        file = tmp_path / f"model.{ending}"
        run = subprocess.run([program, "export", "car", "-o", file], check=True, capture_output=True, text=True)
        text, notices = write(taut.build_scene("car"))
        assert text == file.read_text()
        assert [f"taut: {notice}" for notice in notices] == run.stderr.splitlines()
