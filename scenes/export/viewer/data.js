// The recording inside the page (scenes/export/PAGE, "Data"): 16-bit columns, unpacked once.

const halves = (() => {
  const table = new Float32Array(65536);
  for (let i = 0; i < 65536; ++i) {
    const exponent = i >> 10 & 31, mantissa = i & 1023;
    const magnitude = exponent === 0 ? mantissa * 2 ** -24
      : exponent === 31 ? (mantissa ? NaN : Infinity) : (1 + mantissa / 1024) * 2 ** (exponent - 15);
    table[i] = i & 0x8000 ? -magnitude : magnitude;
  }
  return table;
})();

/** Undoes the prediction: words, low bytes before high bytes, as sums over the frames. */
function unpackWords(bytes, {offset, count, per_frame: perFrame, order}) {
  const words = new Uint16Array(count);
  for (let i = 0; i < count; ++i) words[i] = bytes[offset + i] | bytes[offset + count + i] << 8;
  for (let pass = 0; pass < order; ++pass)
    for (let i = perFrame; i < count; ++i) words[i] += words[i - perFrame];
  return words;
}

/** Numbers per frame that are halves of a scale; all zero if the page has none. */
class HalfColumn {
  constructor(bytes, column) {
    this.words = column ? unpackWords(bytes, column) : null;
    this.scale = column ? column.scale : 0;
  }
  at(index) { return this.words ? halves[this.words[index]] * this.scale : 0; }
  norm3(index) {
    if (!this.words) return 0;
    return Math.hypot(this.at(index), this.at(index + 1), this.at(index + 2));
  }
}

/** Length of the description, the description (JSON), columns. */
function opened(buffer) {
  const length = new DataView(buffer).getUint32(0, true);
  const d = JSON.parse(new TextDecoder().decode(new Uint8Array(buffer, 8, length)));
  return {d, bytes: new Uint8Array(buffer, 8 + Math.ceil(length / 8) * 8)};
}

/** What is the same in all frames. */
const kHeader = ['scene', 'file', 'parameters', 'parameterUnits', 'dt', 'gravity', 'bodies', 'joints', 'shapes', 'drawn', 'scalars', 'springs', 'bodyCount', 'jointCount', 'springCount',
                 'course', 'jointsOfBody'];

export class Recording {
  /** @param {ArrayBuffer} buffer length of the description, the description (JSON), columns */
  constructor(buffer) {
    const {d, bytes} = opened(buffer);
    Object.assign(this, {
      scene: d.scene, file: d.file, parameters: d.parameters, parameterUnits: d.parameter_units ?? {}, dt: d.dt, gravity: d.gravity,
      bodies: d.bodies, joints: d.joints, shapes: d.shapes, drawn: d.drawn, scalars: d.scalars,
      springs: d.springs,
    });
    this.bodyCount = d.bodies.name.length;
    this.jointCount = d.joints.name.length;
    this.springCount = d.springs.length;
    // Points [body, x, y, z] of the joints that are rods, ropes or wires.
    this.course = new Map(d.joints.course);
    this.jointsOfBody = Array.from({length: this.bodyCount}, () => []);
    for (let j = 0; j < this.jointCount; ++j)
      for (const body of [d.joints.a[j], d.joints.b[j]]) this.jointsOfBody[body].push(j);
    this.take(d, bytes);
  }

  /** Other frames of the same things, whose description leaves out what is the same. */
  another(buffer) {
    const found = Object.create(Recording.prototype), {d, bytes} = opened(buffer);
    for (const name of kHeader) found[name] = this[name];
    found.take(d, bytes);
    return found;
  }

  take(d, bytes) {
    const plain = (Type, name) => {
      const {offset, count} = d.columns[name];
      return new Type(bytes.buffer, bytes.byteOffset + offset, count);
    };
    this.frames = d.frames;
    this.live = d.live;
    this.times = plain(Float64Array, 'time');
    this.scalarValues = plain(Float64Array, 'scalars');
    this.low = plain(Float32Array, 'position_low');
    this.step = plain(Float32Array, 'position_step');
    this.position = unpackWords(bytes, d.columns.position);
    this.rotation = new Int16Array(unpackWords(bytes, d.columns.rotation).buffer);
    for (const name of ['speed', 'force', 'torque', 'gap', 'gap_angle', 'tension'])
      this[name] = new HalfColumn(bytes, d.columns[name]);
    this.contactCount = plain(Uint32Array, 'contact_count');
    this.contactStart = new Uint32Array(this.frames + 1);
    for (let f = 0; f < this.frames; ++f) this.contactStart[f + 1] = this.contactStart[f] + this.contactCount[f];
    this.contactTotal = this.contactStart[this.frames];
    this.contactLow = plain(Float64Array, 'contact_low');
    this.contactStep = plain(Float64Array, 'contact_step');
    this.unpackContacts(bytes, d.columns);
    this.detached = new Map();
    for (const [joint, ...span] of d.detached) this.detached.set(joint, [...(this.detached.get(joint) ?? []), span]);
  }

  /** Each contact is the difference to the one of the frame before that is as many-th of the same two bodies. */
  unpackContacts(bytes, columns) {
    const words = unpackWords(bytes, columns.contact_bodies);
    this.contactBodies = Uint32Array.from({length: 2 * this.contactTotal}, (_, i) => words[2 * i] | words[2 * i + 1] << 16);
    this.contactPlace = unpackWords(bytes, columns.contact_place);
    this.contactForces = new HalfColumn(bytes, columns.contact_force);
    let before = new Map();
    for (let f = 0; f < this.frames; ++f) {
      const now = new Map();
      for (let c = this.contactStart[f]; c < this.contactStart[f + 1]; ++c) {
        const pair = this.contactBodies[2 * c] * this.bodyCount + this.contactBodies[2 * c + 1];
        if (!now.has(pair)) now.set(pair, []);
        const predecessor = before.get(pair)?.[now.get(pair).length];
        now.get(pair).push(c);
        if (predecessor === undefined) continue;
        for (let i = 0; i < 3; ++i) {
          this.contactPlace[3 * c + i] += this.contactPlace[3 * predecessor + i];
          this.contactForces.words[3 * c + i] += this.contactForces.words[3 * predecessor + i];
        }
      }
      before = now;
    }
  }

  get start() { return this.times[0]; }
  get end() { return this.times[this.frames - 1]; }

  /** The last frame that is not after t, and the part of the way to the next one. */
  locate(t) {
    let low = 0, high = this.frames - 1;
    while (low < high) {
      const middle = (low + high + 1) >> 1;
      if (this.times[middle] <= t) low = middle; else high = middle - 1;
    }
    const next = Math.min(low + 1, this.frames - 1), span = this.times[next] - this.times[low];
    return {frame: low, next, part: span > 0 ? Math.min(Math.max((t - this.times[low]) / span, 0), 1) : 0};
  }

  /** The frame nearest to t: numbers are shown of it, never between frames. */
  nearest(t) {
    const {frame, next, part} = this.locate(t);
    return part < 0.5 ? frame : next;
  }

  /** Writes poses of all bodies at t: x y z and a unit quaternion x y z w, from 7 * body on. */
  poses(t, out) {
    const {frame, next, part} = this.locate(t), n = this.bodyCount - 1;
    out.fill(0, 0, 7);
    out[6] = 1;
    const p0 = 3 * n * frame, p1 = 3 * n * next, q0 = 4 * n * frame, q1 = 4 * n * next;
    for (let b = 0; b < n; ++b) {
      const o = 7 * (b + 1);
      for (let i = 0, k = 3 * b; i < 3; ++i, ++k) {
        const a = this.position[p0 + k];
        out[o + i] = this.low[k] + this.step[k] * (a + part * (this.position[p1 + k] - a));
      }
      let square = 0;
      for (let i = 0, k = 4 * b; i < 4; ++i, ++k) {
        const a = this.rotation[q0 + k], q = a + part * (this.rotation[q1 + k] - a);
        out[o + 3 + i] = q;
        square += q * q;
      }
      const scale = 1 / Math.sqrt(square || 1);
      for (let i = 3; i < 7; ++i) out[o + i] *= scale;
    }
    return out;
  }

  /** Where the point [body, x, y, z] is at a frame, in the world. */
  pointAt(frame, [body, x, y, z]) {
    if (body === 0) return [x, y, z];
    const n = this.bodyCount - 1, k = 3 * (body - 1), p = 3 * n * frame + k, o = 4 * (n * frame + body - 1);
    const [qx, qy, qz, qw] = this.rotation.subarray(o, o + 4), s = 2 / (qx * qx + qy * qy + qz * qz + qw * qw || 1);
    const tx = qy * z - qz * y, ty = qz * x - qx * z, tz = qx * y - qy * x;
    const turned = [x + s * (qw * tx + qy * tz - qz * ty), y + s * (qw * ty + qz * tx - qx * tz), z + s * (qw * tz + qx * ty - qy * tx)];
    return turned.map((value, i) => this.low[k + i] + this.step[k + i] * this.position[p + i] + value);
  }

  scalar(frame, index) { return this.scalarValues[frame * this.scalars.length + index]; }
  jointForce(frame, joint) { return this.force.norm3(3 * (frame * this.jointCount + joint)); }
  jointVector(column, frame, joint) {
    const i = 3 * (frame * this.jointCount + joint);
    return [column.at(i), column.at(i + 1), column.at(i + 2)];
  }
  jointGap(frame, joint) { return this.gap.at(frame * this.jointCount + joint); }
  jointGapAngle(frame, joint) { return this.gap_angle.at(frame * this.jointCount + joint); }
  bodySpeed(frame, body) { return body === 0 ? 0 : this.speed.at(frame * (this.bodyCount - 1) + body - 1); }

  /** What a spring or damper pulls with [N]; negative: it pushes. */
  tensionOf(frame, spring) { return this.tension.at(frame * this.springCount + spring); }

  /** Largest value of a joint quantity over the joints of a body. */
  bodyJointMaximum(values, body) {
    let most = 0;
    for (const joint of this.jointsOfBody[body]) most = Math.max(most, values[joint]);
    return most;
  }

  /** [{a, b, position, force}] of a frame. */
  contacts(frame) {
    const found = [], forces = this.contactForces;
    for (let c = this.contactStart[frame]; c < this.contactStart[frame + 1]; ++c)
      found.push({a: this.contactBodies[2 * c], b: this.contactBodies[2 * c + 1],
                  position: [0, 1, 2].map((k) => this.contactLow[k] + this.contactStep[k] * this.contactPlace[3 * c + k]),
                  force: [forces.at(3 * c), forces.at(3 * c + 1), forces.at(3 * c + 2)]});
    return found;
  }

  /** The largest force of the contacts of a frame [N]; 0 if it has none. */
  contactPeak(frame) {
    let peak = 0;
    for (let c = this.contactStart[frame]; c < this.contactStart[frame + 1]; ++c) peak = Math.max(peak, this.contactForces.norm3(3 * c));
    return peak;
  }

  /** Whether a joint holds at a frame: broken ones do not. */
  isAttached(frame, joint) {
    return !this.detached.get(joint)?.some(([from, end]) => frame >= from && frame < end);
  }

  /** Box around the centres of all bodies over the whole time and what wires and springs hang from: {low, high}. */
  box() {
    const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
    for (let k = 0; k < this.low.length; ++k) {
      low[k % 3] = Math.min(low[k % 3], this.low[k]);
      high[k % 3] = Math.max(high[k % 3], this.low[k] + 65535 * this.step[k]);
    }
    for (const points of [...this.course.values(), ...this.springs.map(({course}) => course)])
      for (const [body, ...place] of points)
        if (body === 0) place.forEach((x, k) => {
          low[k] = Math.min(low[k], x);
          high[k] = Math.max(high[k], x);
        });
    return low[0] <= high[0] ? {low, high} : {low: [-1, -1, -1], high: [1, 1, 1]};
  }
}
