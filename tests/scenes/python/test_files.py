"""Scenes, state files, recordings and pages; the program's bits."""

import json
import os
import re
import subprocess
import xml.etree.ElementTree

import numpy as np
import pytest
from conftest import ROOT, chain

import taut


@pytest.mark.parametrize("scene, parameters, settings", [
    ("bridge-hinge", {"n": 20}, {}), ("net", {"n": 8}, {}), ("pile", {"n": 8}, {}), ("car", {}, {}),
    ("chain", {"n": 20}, {"integrator": "rattle4"})])
def test_same_bits_as_the_program(program, tmp_path, scene, parameters, settings):
    there, here = tmp_path / "there.json", tmp_path / "here.json"
    options = [f"--set={key}={value}" for key, value in parameters.items()] + [f"--{k}={v}" for k, v in settings.items()]
    subprocess.run([program, "run", scene, *options, "--steps", "100", "--quiet", "--save", there], check=True, capture_output=True)
    built = taut.build_scene(scene, **parameters)
    if settings:
        built.settings.integrator = taut.Integrator[settings["integrator"].upper()]
    simulator = taut.Simulator(built.world, built.settings)
    for _ in range(100):
        simulator.step(built.dt)
    taut.save_state(simulator, here)
    theirs, ours = json.loads(there.read_text()), json.loads(here.read_text())
    assert len(ours["bodies"]) == built.world.moving_body_count
    assert ours == theirs  # numbers are written so that they are read back bit for bit


def test_state_files_go_on(tmp_path):
    def simulator():
        scene = taut.build_scene("pile", n=6)
        return taut.Simulator(scene.world, scene.settings), scene.dt

    one, dt = simulator()
    one.run(50, dt)
    taut.save_state(one, tmp_path / "state.json")
    one.run(50, dt)
    two, dt = simulator()
    assert taut.load_state(two, tmp_path / "state.json") == ""
    two.run(50, dt)
    assert one.world.poses.tobytes() == two.world.poses.tobytes()
    with pytest.raises(ValueError):
        taut.load_state(taut.Simulator(chain(2)), tmp_path / "state.json")
    with pytest.raises(RuntimeError):
        taut.save_state(one, tmp_path / "no folder" / "state.json")


def test_catalogue():
    catalogue = {info.name: info for info in taut.catalogue()}
    assert {"bridge", "net", "pile"} <= set(catalogue)
    assert {p.name for p in catalogue["bridge-hinge"].parameters} == {"n", "truck"}
    scene = taut.build_scene("bridge-hinge", n=3, truck=True)
    assert scene.parameters == {"n": 3, "truck": 1} and scene.world.moving_body_count == 4
    assert scene.parameter_units == {"truck": "bool"}
    for wrong in (lambda: taut.build_scene("nothing"), lambda: taut.build_scene("bridge", m=3), lambda: taut.build_scene("bridge", n=0.5)):
        with pytest.raises(ValueError):
            wrong()


EXAMPLES = sorted(file for file in (ROOT / "scenes/examples").glob("*.json") if not file.name.endswith(".schema.json"))


@pytest.mark.parametrize("file", EXAMPLES, ids=lambda file: file.stem)
def test_scene_files(file):
    scene = taut.load_scene(file)
    simulator = taut.Simulator(scene.world, scene.settings)
    if scene.assemble:
        assert simulator.assemble().exact()
    assert simulator.run(3, scene.dt).ok()


def test_wrong_scene_files(tmp_path):
    with pytest.raises(taut.SceneFileError) as caught:
        taut.parse_scene('{"format": "taut-scene/1", "bodies": [{"name": "a", "mass": -1}], "nonsense": 1}', "arm.json")
    assert isinstance(caught.value, ValueError) and "arm.json" in str(caught.value)
    assert any(path.startswith("/bodies/0") for path, _, _ in caught.value.problems)
    with pytest.raises(taut.SceneFileError):
        taut.load_scene(tmp_path / "nowhere.json")


def test_film_and_recording(tmp_path):
    file = tmp_path / "bridge.taut"
    scene = taut.build_scene("bridge", n=10)
    scene.add_probe(taut.Probe("middle", taut.Probe.Quantity.POSITION, body=taut.BodyId(5)))
    positions = []
    simulator = taut.Simulator(scene.world, scene.settings)
    film = taut.Film(simulator, scene, file=file, frames_per_second=0)
    for _ in range(20):
        simulator.step(scene.dt)
        assert film.sample()
        positions.append(scene.world.positions)
    film.finish()
    recording = taut.Recording(file)
    assert len(recording) == film.frame_count == 20 and recording.status == "success" and recording.damage == ""
    assert recording.times == pytest.approx(scene.dt * np.arange(1, 21))
    # A recording keeps positions to a step of a grid, see scenes/recording/FORMAT.md.
    assert recording.positions() == pytest.approx(np.array(positions), abs=1e-5)
    frame = recording.frame(19)
    assert frame["poses"].shape == (len(recording.body_names), 7) and frame["reactions"].shape == (len(recording.joint_names), 6)
    assert frame["reactions"] == pytest.approx(simulator.mean_reactions(), rel=1e-3, abs=1.0)
    probe = [recording.scalar_names.index(f"middle.{axis}") for axis in "xyz"]
    assert frame["scalars"][probe] == pytest.approx(scene.world.positions[5])
    for wrong in (-1, 20, 10**9):
        with pytest.raises(IndexError):
            recording.frame(wrong)
    with pytest.raises(ValueError, match="finished"):
        film.sample()


def test_joints_of_a_recording(tmp_path):
    world = taut.World()
    arm = world.add_body("arm", pose=taut.Pose(p=[1, 0, 0]))
    slide = world.add_body("slide", pose=taut.Pose(p=[2, 0, 0]))
    world.add("pivot", taut.Hinge.at(world, taut.GROUND, arm, [0.5, 0, 0], [0, 0.6, 0.8]))
    world.add("rail", taut.Slider.at(world, arm, slide, [2, 0, 0], [1, 0, 0]))
    world.add("tie", taut.Rope([(taut.GROUND, [0, 0, 1]), (arm, [0, 0, 1]), (slide, [0, 1, 0])], 9))
    file = tmp_path / "arm.taut"
    film = taut.Film(taut.Simulator(world), file=file)
    film.sample(now=True)
    film.finish()
    pivot, rail, tie = taut.Recording(file).joints
    assert (pivot.name, pivot.type, pivot.a, pivot.b) == ("pivot", "hinge", taut.GROUND, arm)
    assert pivot.anchor_B == pytest.approx([-0.5, 0, 0]) and pivot.course == []
    (angle,) = pivot.axes
    assert (angle.name, angle.angular) == ("angle", True)
    assert angle.axis_B == pytest.approx([0, 0.6, 0.8])  # bodies stand as the world does
    (along,) = rail.axes
    assert (along.angular, along.body) == (False, arm) and along.axis_B == pytest.approx([1, 0, 0])
    assert [body for body, _ in tie.course] == [taut.GROUND, arm, slide] and tie.axes == []
    assert tie.course[2][1] == pytest.approx([0, 1, 0])


def test_a_recording_cut_short(tmp_path):
    file = tmp_path / "run.taut"
    film = taut.simulate(chain(5), 0.2, file=file)
    data = file.read_bytes()
    assert taut.Recording(file).frame_count == film.frame_count
    file.write_bytes(data[:-40])
    assert taut.Recording(file).damage
    file.write_bytes(b"nonsense")
    with pytest.raises(ValueError):
        taut.Recording(file)
    with pytest.raises(ValueError):
        taut.Recording(tmp_path / "nowhere.taut")


def data_modules(page):
    return re.findall(r'data-module="([^"]+)"', page)


def test_a_simulation_shows_itself(tmp_path):
    film = taut.simulate(taut.build_scene("net", n=4), 0.1)
    page = film.page()
    assert page.startswith("<!doctype html>") and "main.js" in data_modules(page)
    shown = film._repr_html_()
    iframe = xml.etree.ElementTree.fromstring(shown)
    # XML makes spaces of the ends of lines in attributes.
    assert iframe.tag == "iframe" and iframe.attrib["srcdoc"].split() == page.split()
    film.export(html=str(tmp_path / "net.html"), gltf=str(tmp_path / "net.glb"), plot=str(tmp_path / "net.svg"), csv=str(tmp_path / "net.csv"))
    assert (tmp_path / "net.html").read_text() == page
    assert (tmp_path / "net.glb").read_bytes()[:4] == b"glTF"
    assert (tmp_path / "net.csv").read_text().startswith("time,")
    instant = taut.Simulator(chain(3))
    assert instant._repr_html_().startswith("<iframe")


def test_a_page_of_two(tmp_path):
    files = [tmp_path / "one.taut", tmp_path / "two.taut"]
    for file, n in zip(files, (3, 4)):
        taut.simulate(taut.build_scene("net", n=n), 0.05, file=file)
    one, two = map(taut.Recording, files)
    both = one.page(beside=two)
    assert 'id="second"' in both and 'id="second"' not in one.page()
    assert one.page(two) == both and one.page(None) == one.page()
    for wrong in ("two.taut", 3):
        with pytest.raises(TypeError):
            one.page(beside=wrong)


def test_without_three(monkeypatch, tmp_path):
    film = taut.simulate(chain(2), 0.1)
    monkeypatch.setenv("TAUT_THREE", str(tmp_path))
    with pytest.raises(ValueError, match="three.js"):
        film.page()
    assert "three.js" in film._repr_html_() and not film._repr_html_().startswith("<iframe")


def test_films_of_worlds_that_change():
    world = chain(2)
    simulator = taut.Simulator(world)
    film = taut.Film(simulator)
    film.sample()
    world.add_body()
    simulator.step(0.1)
    with pytest.raises(ValueError, match="were added"):
        film.sample()
    with pytest.raises(ValueError, match="whose world"):
        taut.Film(simulator, taut.build_scene("net", n=3))
    with pytest.raises(ValueError):
        taut.Film(simulator, file="/nowhere/at/all.taut")
    with pytest.raises(ValueError):
        taut.Film(simulator, frames_per_second=-1)
    with pytest.raises(TypeError):
        taut.Film(world)
    with pytest.raises(ValueError, match="no frames"):
        taut.Film(simulator).page()
    scene = taut.build_scene("net", n=3)
    scene.add_probe(taut.Probe("gap", taut.Probe.Quantity.GAP, joint=taut.JointId(10**6)))
    with pytest.raises(ValueError):
        taut.Film(taut.Simulator(scene.world), scene)


def test_simulate_says_why_it_ended():
    world = taut.World()
    body = world.add_body(pose=taut.Pose(p=[1, 0, 0]))
    for length in (1.0, 2.0):
        world.add("", taut.Distance(taut.GROUND, body, [0, 0, 0], [0, 0, 0], length))
    with pytest.warns(UserWarning, match="ended at"):
        film = taut.simulate(world, 0.1)
    assert not film.simulator.report.ok()
    with pytest.raises(ValueError):
        taut.simulate(world, 0.1, dt=0)


def test_read_mesh():
    mesh = taut.read_mesh(ROOT / "scenes/examples/marble_funnel.obj", 2.0)
    assert len(mesh.triangles) > 10
    with pytest.raises(ValueError):
        taut.read_mesh("nowhere.obj")


def test_the_package_is_typed():
    folder = os.path.dirname(taut.__file__)
    stub = open(os.path.join(folder, "_taut.pyi")).read()
    assert os.path.exists(os.path.join(folder, "py.typed")) and "class Simulator" in stub
    for name in taut.__all__:
        item = getattr(taut, name)
        if isinstance(item, type):
            assert item.__doc__, name
            assert re.search(rf"class {item.__name__}\b", stub), name
