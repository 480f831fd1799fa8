// Exported files before readers that others wrote: the Khronos validator and vtk.js.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import {before, test} from 'node:test';
import vtkXMLPolyDataReader from '@kitware/vtk.js/IO/XML/XMLPolyDataReader.js';
import validator from 'gltf-validator';
import {folder, taut} from './browser.mjs';
import {anchor, norm, readRecording} from './recording.mjs';
import {execFileSync} from 'node:child_process';

const file = (name) => path.join(folder, name);
let bridge;
before(() => {
  taut('run', 'bridge', '--time', '0.1', '--record', file('b.taut'), '--quiet');
  execFileSync(process.env.TAUT_SAMPLE, [file('s.taut')]);
  for (const name of ['b', 's'])
    taut('replay', file(`${name}.taut`), '--gltf', file(`${name}.glb`), '--vtk', file(`${name}_vtk`), '--quiet');
  bridge = readRecording(file('b.taut'));
});

for (const name of ['b', 's'])
  test(`the Khronos validator finds nothing wrong with ${name}.glb`, async () => {
    const report = await validator.validateBytes(new Uint8Array(fs.readFileSync(file(`${name}.glb`))));
    assert.deepEqual(report.issues.messages.filter(({severity}) => severity < 2), []);
    assert.equal(report.info.animationCount, 1);
  });

function read(name) {
  const bytes = fs.readFileSync(file(name)), reader = vtkXMLPolyDataReader.newInstance();
  reader.parseAsArrayBuffer(bytes.buffer.slice(bytes.byteOffset, bytes.byteOffset + bytes.byteLength));
  return reader.getOutputData(0);
}
const triple = (data, i) => Array.from(data.slice(3 * i, 3 * i + 3));
const close = (a, b, most) => a.forEach((x, i) => assert.ok(Math.abs(x - b[i]) <= most, `${a} instead of ${b}`));

test('joints have their places, forces and gaps in the .vtp files', () => {
  const frame = bridge.frames[3], data = read('b_vtk/joints_00003.vtp'), fields = data.getPointData();
  const points = data.getPoints().getData(), force = fields.getArrayByName('force').getData();
  assert.equal(points.length, 3 * bridge.header.joints.length);
  bridge.header.joints.forEach((_, j) => {
    close(triple(points, j), anchor(bridge, frame, j), 2e-5);  // floats of 20 m
    close(triple(force, j), frame.force(j), 0);
    assert.equal(fields.getArrayByName('gap').getData()[j], frame.gap(j));
    assert.equal(fields.getArrayByName('joint').getData()[j], j);
  });
});

test('surfaces are around their bodies and carry their numbers', () => {
  const frame = bridge.frames[6], data = read('b_vtk/bodies_00006.vtp'), fields = data.getCellData();
  const points = data.getPoints().getData(), cells = data.getPolys().getData();
  const body = fields.getArrayByName('body').getData(), velocity = fields.getArrayByName('velocity').getData();
  const seen = new Set();
  for (let cell = 0; cell < body.length; ++cell) {
    seen.add(body[cell]);
    assert.equal(cells[4 * cell], 3);
    for (let k = 1; k <= 3; ++k) {
      const corner = triple(points, cells[4 * cell + k]);
      assert.ok(norm(corner.map((x, i) => x - frame.position(body[cell])[i])) < 0.72);  // half the plank's and truck's diagonal
    }
    close(triple(velocity, cell), frame.velocity(body[cell]), 0);
  }
  assert.equal(seen.size, bridge.header.bodies.length - 1);
  const force = fields.getArrayByName('joint_force').getData(), truck = bridge.header.bodies.length - 1;
  const weld = bridge.header.joints.findIndex(({name}) => name === 'truck_weld');
  assert.ok(Math.abs(force[body.indexOf(truck)] / norm(frame.force(weld)) - 1) < 1e-6);
});

test('contacts can be read', () => {
  const {frames} = readRecording(file('s.taut')), data = read('s_vtk/contacts_00012.vtp');
  frames[12].contacts.forEach((contact, c) => {
    close(triple(data.getPoints().getData(), c), [...contact.position], 0);
    close(triple(data.getPointData().getArrayByName('force').getData(), c), [...contact.force], 0);
  });
  // vtk.js cannot read arrays without entries, VTK itself can.
  assert.match(fs.readFileSync(file('b_vtk/contacts_00000.vtp'), 'utf8'), /NumberOfPoints="0"/);
});

test('the series names every file with its time', () => {
  const pvd = fs.readFileSync(file('b_vtk/bodies.pvd'), 'utf8');
  const entries = [...pvd.matchAll(/timestep="([^"]+)"[^>]*file="([^"]+)"/g)];
  assert.deepEqual(entries.map((entry) => Number(entry[1])), bridge.frames.map((frame) => frame.time));
  for (const entry of entries) assert.ok(fs.existsSync(file(`b_vtk/${entry[2]}`)));
  const names = fs.readFileSync(file('b_vtk/names.csv'), 'utf8').split('\n');
  assert.ok(names.includes('body,201,truck'));
});
