// A reader of recordings written from scenes/recording/FORMAT.md alone, to check that page and file against it.
import fs from 'node:fs';
import zlib from 'node:zlib';

export function readRecording(file) {
  const bytes = fs.readFileSync(file);
  if (bytes.toString('latin1', 0, 16) !== 'taut-recording/2') throw new Error('no recording');
  const recording = {frames: []};
  for (let at = 16; at < bytes.length;) {
    const type = bytes.toString('latin1', at + 4, at + 8);
    const stored = Number(bytes.readBigUInt64LE(at + 8)), size = Number(bytes.readBigUInt64LE(at + 16));
    const raw = zlib.inflateSync(bytes.subarray(at + 32, at + 32 + stored));
    if (bytes.toString('latin1', at, at + 4) !== 'tCHK' || raw.length !== size) throw new Error('bad chunk');
    if (type === 'HEAD') recording.header = JSON.parse(raw);
    if (type === 'DONE') recording.end = JSON.parse(raw);
    if (type === 'FRMS') recording.frames.push(...frames(raw, recording.header.springs.length));
    at += 32 + stored;
  }
  return recording;
}

function frames(raw, springs) {
  const [count, bodies, joints, scalars] = [0, 4, 8, 12].map((at) => raw.readUInt32LE(at));
  let at = 16;
  const doubles = (n) => Array.from({length: n}, (_, i) => raw.readDoubleLE(at + 8 * i));
  const times = doubles(count);
  at += 8 * count;
  const values = doubles(count * scalars);
  at += 8 * count * scalars;
  const column = (n, perFrame) => {
    const words = new Uint32Array(n * perFrame), total = words.length;
    for (let i = 0; i < total; ++i) {
      for (let plane = 0; plane < 4; ++plane) words[i] |= raw[at + plane * total + i] << 8 * plane;
      if (i >= perFrame) words[i] += words[i - perFrame];
    }
    at += 4 * total;
    return words;
  };
  const floats = (n, perFrame) => new Float32Array(column(n, perFrame).buffer);
  const poses = floats(count, 7 * bodies), twists = floats(count, 6 * bodies), wrenches = floats(count, 8 * joints);
  const contactCounts = Array.from({length: count}, (_, i) => raw.readUInt32LE(at + 4 * i));
  at += 4 * count;
  const contacts = column(contactCounts.reduce((a, b) => a + b, 0), 11);
  const tensions = floats(count, springs);
  let contact = 0;
  const of = (data, frame, perFrame, width) => (index) =>
    Array.from(data.subarray(frame * perFrame + width * index, frame * perFrame + width * (index + 1)));
  return times.map((time, f) => {
    const pose = of(poses, f, 7 * bodies, 7), twist = of(twists, f, 6 * bodies, 6), joint = of(wrenches, f, 8 * joints, 8);
    return {
      time,
      scalars: values.slice(f * scalars, (f + 1) * scalars),
      // Body 0 is the ground.
      position: (body) => (body ? pose(body - 1).slice(0, 3) : [0, 0, 0]),
      rotation: (body) => (body ? pose(body - 1).slice(3) : [1, 0, 0, 0]),  // w x y z
      velocity: (body) => (body ? twist(body - 1).slice(3) : [0, 0, 0]),
      force: (j) => joint(j).slice(0, 3),
      torque: (j) => joint(j).slice(3, 6),
      gap: (j) => joint(j)[6],
      tension: (s) => tensions[f * springs + s],
      attached: (j) => joint(j)[6] !== -1,
      contacts: Array.from({length: contactCounts[f]}, () => {
        const words = contacts.slice(11 * contact, 11 * ++contact), numbers = new Float32Array(words.buffer);
        return {a: words[0], b: words[1], position: numbers.slice(2, 5), normal: numbers.slice(5, 8), force: numbers.slice(8)};
      }),
    };
  });
}

export const norm = (v) => Math.hypot(...v);
export const add = (a, b) => a.map((x, i) => x + b[i]);
export const sub = (a, b) => a.map((x, i) => x - b[i]);
export const dot = (a, b) => a.reduce((sum, x, i) => sum + x * b[i], 0);
export const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
export const unit = (v) => v.map((x) => x / norm(v));

/** v turned by q = [w, x, y, z]. */
export function turned([w, ...u], v) {
  const t = cross(u, v).map((x) => 2 * x);
  return add(add(v, t.map((x) => w * x)), cross(u, t));
}

/** Where joint j is at a frame. */
export function anchor({header}, frame, j) {
  const {b, anchor: at} = header.joints[j];
  return add(frame.position(b), turned(frame.rotation(b), at));
}

/** Where the points of the course of a rod, rope, wire or spring are at a frame. */
const points = (frame, course) => course.map(([body, ...at]) => add(frame.position(body), turned(frame.rotation(body), at)));
export const course = ({header}, frame, j) => points(frame, header.joints[j].course);
export const springEnds = ({header}, frame, s) => points(frame, header.springs[s].course);
