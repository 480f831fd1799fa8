// Exported files before readers that others wrote: the Khronos validator and VTK.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import path from 'node:path';
import {before, test} from 'node:test';
import validator from 'gltf-validator';
import {folder, taut} from './browser.mjs';
import {add, anchor, course, norm, readRecording, springEnds, sub, turned} from './recording.mjs';

const file = (name) => path.join(folder, name);
let bridge, hung;
before(() => {
  taut('run', 'bridge', '--time', '0.1', '--record', file('b.taut'), '--quiet');
  execFileSync(process.env.TAUT_SAMPLE, [file('s.taut')]);
  // A bridge on ropes that break, one after the other.
  taut('run', 'suspension-bridge', '--set', 'n=6', '--set', 'strength=1.25', '--set', 'load=3000', '--set', 'speed=6', '--record', file('h.taut'), '--quiet');
  for (const name of ['b', 's', 'h'])
    taut('replay', file(`${name}.taut`), '--gltf', file(`${name}.glb`), '--vtk', file(`${name}_vtk`), '--quiet');
  bridge = readRecording(file('b.taut'));
  hung = readRecording(file('h.taut'));
});

for (const name of ['b', 's', 'h'])
  test(`the Khronos validator finds nothing wrong with ${name}.glb`, async () => {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file(`${name}.glb`))));
    assert.deepEqual(report.issues.messages.filter(({severity}) => severity < 2), []);
    assert.equal(report.info.animationCount, 1);
  });

/** A .vtp file as VTK itself reads it (read_vtk.py). */
function read(name) {
  const script = new URL('read_vtk.py', import.meta.url).pathname;
  const json = execFileSync(process.env.TAUT_VTK_PYTHON, [script, file(name)], {maxBuffer: 1 << 28});
  return JSON.parse(json)[file(name)];
}
const withVtk = process.env.TAUT_VTK_PYTHON ? {} : {skip: 'VTK is missing (Debian: apt-get install python3-vtk9)'};
const triple = (data, i) => data.slice(3 * i, 3 * i + 3);
const close = (a, b, most) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) <= most, `${a} instead of ${b}`));

test('joints have their places, forces and gaps in the .vtp files', withVtk, () => {
  const frame = bridge.frames[3], {points, verts, point_data: fields} = read('b_vtk/joints_00003.vtp');
  assert.equal(verts, bridge.header.joints.length);
  assert.equal(points.length, 3 * bridge.header.joints.length);
  bridge.header.joints.forEach((_, j) => {
    close(triple(points, j), anchor(bridge, frame, j), 2e-5);  // floats of 20 m
    close(triple(fields.force, j), frame.force(j), 0);
    assert.equal(fields.gap[j], frame.gap(j));
    assert.equal(fields.joint[j], j);
  });
});

test('surfaces are around their bodies and carry their numbers', withVtk, () => {
  const frame = bridge.frames[6], {points, polys, cell_data: fields} = read('b_vtk/bodies_00006.vtp'), seen = new Set();
  assert.equal(polys.length, 3 * fields.body.length);
  fields.body.forEach((body, cell) => {
    seen.add(body);
    for (const corner of triple(polys, cell))  // within half the diagonal of plank and truck
      assert.ok(norm(sub(triple(points, corner), frame.position(body))) < 0.72);
    close(triple(fields.velocity, cell), frame.velocity(body), 0);
  });
  assert.equal(seen.size, bridge.header.bodies.length - 1);
  const truck = bridge.header.bodies.length - 1, weld = bridge.header.joints.findIndex(({name}) => name === 'truck_weld');
  assert.ok(Math.abs(fields.joint_force[fields.body.indexOf(truck)] / norm(frame.force(weld)) - 1) < 1e-6);
});

const ropes = ({header}) => header.joints.flatMap(({type}, j) => (type === 'rope' ? [j] : []));

test('ropes are lines in the .vtp files, with their forces, until they break', withVtk, () => {
  assert.ok(hung.frames.some((frame) => ropes(hung).some((j) => !frame.attached(j))), 'none breaks');
  for (const f of [1, hung.frames.length - 1]) {
    const frame = hung.frames[f], whole = ropes(hung).filter((j) => frame.attached(j));
    const number = String(f).padStart(5, '0'), {points, lines, cell_data: fields} = read(`h_vtk/wires_${number}.vtp`);
    assert.deepEqual(fields.joint ?? [], whole);
    whole.forEach((j, i) => {
      const [from, to] = course(hung, frame, j);
      close(triple(points, lines[2 * i]), from, 2e-6);
      close(triple(points, lines[2 * i + 1]), to, 2e-6);
      assert.ok(Math.abs(fields.force[i] - norm(frame.force(j))) <= 1e-6 * norm(frame.force(j)));
    });
    const {joint, attached} = read(`h_vtk/joints_${number}.vtp`).point_data;
    joint.forEach((j) => assert.equal(attached[j], frame.attached(j) ? 1 : 0));
  }
});

test('ropes are thin rods in the .glb file, from end to end at every instant', () => {
  const bytes = fs.readFileSync(file('h.glb')), length = bytes.readUInt32LE(12);
  const gltf = JSON.parse(bytes.toString('utf8', 20, 20 + length));
  const values = (index, width) => {
    const {bufferView, count} = gltf.accessors[index], start = 28 + length + gltf.bufferViews[bufferView].byteOffset;
    return Array.from({length: count}, (_, i) => Array.from({length: width}, (_x, k) => bytes.readFloatLE(start + 4 * (width * i + k))));
  };
  const {channels, samplers} = gltf.animations[0];
  for (const j of ropes(hung)) {
    const node = gltf.nodes.findIndex(({name}) => name === hung.header.joints[j].name);
    const track = (path, width) => values(samplers[channels.find(({target}) => target.node === node && target.path === path).sampler].output, width);
    const [places, turns, scales] = [track('translation', 3), track('rotation', 4), track('scale', 3)];
    hung.frames.forEach((frame, f) => {
      if (!frame.attached(j)) return assert.deepEqual(scales[f], [0, 0, 0]);
      const [x, y, z, w] = turns[f], half = turned([w, x, y, z], [0, 0, scales[f][2] / 2]);
      const [from, to] = course(hung, frame, j);
      close(sub(places[f], half), from, 1e-5);
      close(add(places[f], half), to, 1e-5);
    });
  }
});

test('springs are lines in the .vtp files, with their tension', withVtk, () => {
  const sample = readRecording(file('s.taut')), {length} = sample.header.springs;
  assert.equal(length, 2);
  for (const f of [0, 7]) {
    const frame = sample.frames[f], {points, lines, cell_data: fields} = read(`s_vtk/springs_0000${f}.vtp`);
    assert.deepEqual(fields.spring, [0, 1]);
    for (let s = 0; s < length; ++s) {
      springEnds(sample, frame, s).forEach((end, i) => close(triple(points, lines[2 * s + i]), end, 1e-6));
      assert.equal(fields.tension[s], frame.tension(s));
    }
  }
  assert.deepEqual(read('b_vtk/springs_00000.vtp').points, []);
});

test('contacts can be read, and no contacts too', withVtk, () => {
  const {contacts} = readRecording(file('s.taut')).frames[12], {points, point_data: fields} = read('s_vtk/contacts_00012.vtp');
  assert.equal(points.length, 3 * contacts.length);
  contacts.forEach((contact, c) => {
    close(triple(points, c), [...contact.position], 0);
    close(triple(fields.normal, c), [...contact.normal], 0);
    close(triple(fields.force, c), [...contact.force], 0);
    assert.deepEqual([fields.body_a[c], fields.body_b[c]], [contact.a, contact.b]);
  });
  assert.deepEqual(read('b_vtk/contacts_00000.vtp').points, []);
});

test('the series names every file with its time', () => {
  const pvd = fs.readFileSync(file('b_vtk/bodies.pvd'), 'utf8');
  const entries = [...pvd.matchAll(/timestep="([^"]+)"[^>]*file="([^"]+)"/g)];
  assert.deepEqual(entries.map((entry) => Number(entry[1])), bridge.frames.map((frame) => frame.time));
  for (const entry of entries) assert.ok(fs.existsSync(file(`b_vtk/${entry[2]}`)));
  const names = fs.readFileSync(file('b_vtk/names.csv'), 'utf8').split('\n');
  assert.ok(names.includes('body,201,truck'));
});
