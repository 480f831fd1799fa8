// Bodies, joints and contacts as instanced meshes, placed and coloured from a recording.
import {Color, DynamicDrawUsage, Group, InstancedMesh, MeshLambertMaterial, MeshStandardMaterial} from 'three';
import {palette} from './colors.js';
import {
  anchorGeometry, arrowGeometries, bodySizes, damperGeometry, instanceGroups, jointGeometry, kSlimness, moveGeometry, sectionGeometry,
  springGeometry, turnGeometry,
} from './geometry.js';

/** Column-major matrix of rotation q (x y z w), scale (sx sy sz) and position p into out at o. */
function writeMatrix(out, o, px, py, pz, x, y, z, w, sx, sy, sz) {
  out[o] = (1 - 2 * (y * y + z * z)) * sx;
  out[o + 1] = 2 * (x * y + w * z) * sx;
  out[o + 2] = 2 * (x * z - w * y) * sx;
  out[o + 4] = 2 * (x * y - w * z) * sy;
  out[o + 5] = (1 - 2 * (x * x + z * z)) * sy;
  out[o + 6] = 2 * (y * z + w * x) * sy;
  out[o + 8] = 2 * (x * z + w * y) * sz;
  out[o + 9] = 2 * (y * z - w * x) * sz;
  out[o + 10] = (1 - 2 * (x * x + y * y)) * sz;
  out[o + 12] = px;
  out[o + 13] = py;
  out[o + 14] = pz;
  out[o + 15] = 1;
}

/** The shortest rotation (x y z w) from z to a direction of the given length. */
function turnFromZ(d, length) {
  if (!(length > 0)) return [0, 0, 0, 1];
  let x = -d[1] / length, y = d[0] / length, w = 1 + d[2] / length;
  if (w < 1e-6) x = 1, y = 0, w = 0;
  const scale = 1 / Math.hypot(x, y, w);
  return [x * scale, y * scale, 0, w * scale];
}

/** World position of the body point (x, y, z): poses holds 7 numbers per body. */
export function worldPoint(poses, body, x, y, z, out = [0, 0, 0]) {
  const o = 7 * body, qx = poses[o + 3], qy = poses[o + 4], qz = poses[o + 5], qw = poses[o + 6];
  const tx = 2 * (qy * z - qz * y), ty = 2 * (qz * x - qx * z), tz = 2 * (qx * y - qy * x);
  out[0] = poses[o] + x + qw * tx + qy * tz - qz * ty;
  out[1] = poses[o + 1] + y + qw * ty + qz * tx - qx * tz;
  out[2] = poses[o + 2] + z + qw * tz + qx * ty - qy * tx;
  return out;
}

function instanced(geometry, material, count, kind, ids) {
  const mesh = new InstancedMesh(geometry, material, count);
  mesh.instanceMatrix.setUsage(DynamicDrawUsage);
  mesh.frustumCulled = false;
  mesh.userData = {kind, ids};
  mesh.setColorAt(0, new Color(1, 1, 1));
  mesh.instanceColor.array.fill(1);
  mesh.instanceColor.setUsage(DynamicDrawUsage);
  return mesh;
}

export class Instances {
  constructor(recording) {
    this.recording = recording;
    this.root = new Group();
    const {groups, planes} = instanceGroups(recording);
    this.planes = planes;
    this.groups = groups;
    const many = recording.drawn.length > 3000;
    const material = many ? new MeshLambertMaterial({fog: false}) : new MeshStandardMaterial({roughness: 0.55, metalness: 0.05, fog: false});
    for (const group of groups) {
      group.mesh = instanced(group.geometry, material, group.items.length, 'body', group.items.map((i) => i.body));
      this.root.add(group.mesh);
    }
    this.makeJoints();
    this.makeSprings();
    this.point = [0, 0, 0];
    this.tip = [0, 0, 0];
  }

  makeJoints() {
    const {jointCount, joints} = this.recording, sizes = bodySizes(this.recording);
    this.jointRadius = new Float32Array(jointCount);
    const all = Array.from({length: jointCount}, (_, j) => j);
    for (const j of all) {
      const ends = [sizes[joints.a[j]], sizes[joints.b[j]]].filter(([size]) => size > 0);
      const least = Math.min(...ends.map(([, thin]) => thin)), most = Math.min(...ends.map(([size]) => size));
      this.jointRadius[j] = ends.length ? Math.min(Math.max(0.68 * least, 0.022 * most), 0.12 * most) : 0.05;
    }
    // A mark where a joint is; at all points of one that is a rod, rope or wire.
    const marks = all.flatMap((joint) => {
      const {a, b, anchor} = joints, grounded = a[joint] === 0 || b[joint] === 0;
      const points = this.recording.course.get(joint)?.map(([body, ...p]) => ({joint, body, p, held: body === 0}));
      return points ?? [{joint, body: b[joint], p: anchor.slice(3 * joint, 3 * joint + 3), held: grounded}];
    });
    const free = marks.filter(({held}) => !held), held = marks.filter((mark) => mark.held);
    const material = new MeshLambertMaterial({fog: false});
    this.jointMeshes = [];
    const add = (items, geometry) => {
      if (!items.length) return;
      const mesh = instanced(geometry, material, items.length, 'joint', items.map(({joint}) => joint));
      mesh.userData.items = items;
      this.jointMeshes.push(mesh);
      this.root.add(mesh);
    };
    add(free, jointGeometry(free.length));
    add(held, anchorGeometry());
    const sections = [...this.recording.course].flatMap(
      ([joint, points]) => points.slice(1).map((end, i) => ({joint, begin: points[i], end})));
    add(sections, sectionGeometry(sections.length));
    const axes = (joints.axes ?? []).map(([joint, , turns, body, ...axis]) => {
      const anchor = joints.anchor.slice(3 * joint, 3 * joint + 3);
      return {joint, turns, axisBody: body, axis, body: joints.b[joint], p: anchor};
    });
    add(axes.filter(({turns}) => turns), turnGeometry(axes.length));
    add(axes.filter(({turns}) => !turns), moveGeometry());
    const {low, high} = this.recording.box();
    this.thinnest = 0.0009 * Math.hypot(...low.map((x, i) => high[i] - x));  // else it is less than a pixel
  }

  /** Springs as coils, mere dampers as cylinders with a rod; as thick as suits their mean length. */
  makeSprings() {
    const {springs, frames} = this.recording, poses = new Float32Array(7 * this.recording.bodyCount);
    const lengths = new Float64Array(springs.length), count = Math.min(frames, 8);
    for (let k = 0; k < count; ++k) {
      this.recording.poses(this.recording.times[Math.round(k * (frames - 1) / Math.max(count - 1, 1))], poses);
      springs.forEach(({course: [from, to]}, i) => {
        const a = worldPoint(poses, ...from), b = worldPoint(poses, ...to);
        lengths[i] += Math.hypot(...a.map((x, j) => b[j] - x)) / count;
      });
    }
    const all = springs.map(({type, course: [begin, end]}, spring) => ({spring, type, begin, end, radius: Math.max(kSlimness * lengths[spring], 2 * this.thinnest)}));
    this.springMeshes = [];
    const material = new MeshLambertMaterial({fog: false});
    for (const [type, makeGeometry] of [['spring', springGeometry], ['damper', damperGeometry]]) {
      const items = all.filter((item) => item.type === type);
      if (!items.length) continue;
      const mesh = instanced(makeGeometry(items.length), material, items.length, 'spring', items.map(({spring}) => spring));
      mesh.userData.items = items;
      this.springMeshes.push(mesh);
      this.root.add(mesh);
    }
  }

  /** Places a cylinder of length and radius 1 along z between two world points. */
  placeSection(out, o, from, to, radius) {
    const d = [to[0] - from[0], to[1] - from[1], to[2] - from[2]], length = Math.hypot(...d);
    const middle = from.map((x, i) => x + d[i] / 2);
    writeMatrix(out, o, ...middle, ...turnFromZ(d, length), radius, radius, length);
  }

  /** Moves everything to the poses (7 numbers per body); joints that are detached at the frame vanish. */
  place(poses, frame) {
    for (const {mesh, items} of this.groups) {
      const out = mesh.instanceMatrix.array;
      items.forEach(({body, p, q, scale}, i) => {
        const o = 7 * body, ax = poses[o + 3], ay = poses[o + 4], az = poses[o + 5], aw = poses[o + 6];
        const [bx, by, bz, bw] = q;
        const at = worldPoint(poses, body, p[0], p[1], p[2], this.point);
        writeMatrix(out, 16 * i, at[0], at[1], at[2],
                    aw * bx + ax * bw + ay * bz - az * by, aw * by - ax * bz + ay * bw + az * bx,
                    aw * bz + ax * by - ay * bx + az * bw, aw * bw - ax * bx - ay * by - az * bz,
                    scale[0], scale[1], scale[2]);
      });
      mesh.instanceMatrix.needsUpdate = true;
      mesh.boundingSphere = null;
    }
    this.placeSprings(poses);
    const ends = [[0, 0, 0], [0, 0, 0]];
    for (const mesh of this.jointMeshes) {
      const out = mesh.instanceMatrix.array;
      mesh.userData.items.forEach(({joint, body, p, begin, end, axis, axisBody, turns}, i) => {
        const r = this.recording.isAttached(frame, joint) ? this.jointRadius[joint] : 0;
        if (begin) {
          [begin, end].forEach((point, k) => worldPoint(poses, ...point, ends[k]));
          const length = Math.hypot(...ends[0].map((x, k) => ends[1][k] - x));
          return this.placeSection(out, 16 * i, ...ends, r && Math.max(0.25 * r, Math.min(this.thinnest, 0.1 * length)));
        }
        const o = 7 * body, at = worldPoint(poses, body, p[0], p[1], p[2], this.point);
        if (axis) return this.placeAxis(out, 16 * i, poses, at, axisBody, axis, r, turns);
        writeMatrix(out, 16 * i, at[0], at[1], at[2],
                    poses[o + 3], poses[o + 4], poses[o + 5], poses[o + 6], r, r, r);
      });
      mesh.instanceMatrix.needsUpdate = true;
      mesh.boundingSphere = null;
    }
  }

  /** An axis through `at`, fixed to a body; r is the radius of the joint's mark, of which it stands out. */
  placeAxis(out, o, poses, at, body, axis, r, turns) {
    const b = 7 * body, tip = worldPoint(poses, body, ...axis, this.tip), d = [tip[0] - poses[b], tip[1] - poses[b + 1], tip[2] - poses[b + 2]];
    const radius = (turns ? 0.38 : 0.26) * r;
    writeMatrix(out, o, at[0], at[1], at[2], ...turnFromZ(d, Math.hypot(...d)), radius, radius, (turns ? 3.6 : 6) * r);
  }

  placeSprings(poses) {
    const ends = [[0, 0, 0], [0, 0, 0]];
    for (const mesh of this.springMeshes) {
      mesh.userData.items.forEach(({begin, end, radius}, i) => {
        [begin, end].forEach((point, k) => worldPoint(poses, ...point, ends[k]));
        this.placeSection(mesh.instanceMatrix.array, 16 * i, ...ends, radius);
      });
      mesh.instanceMatrix.needsUpdate = true;
      mesh.boundingSphere = null;
    }
  }

  /** Values of the joints that a mode of colouring shows at a frame; null if it shows none. */
  jointValues(mode, frame) {
    const r = this.recording;
    if (mode !== 'force' && mode !== 'gap') return null;
    this.values ??= new Float32Array(r.jointCount);
    for (let j = 0; j < r.jointCount; ++j)
      this.values[j] = mode === 'force' ? r.jointForce(frame, j) : r.jointGap(frame, j);
    return this.values;
  }

  /**
   * Colours everything: bodies by the largest value of their joints, by speed, or each by its own.
   * @param style {fixed, neutral, accent: Color, selected: {kind, id} or null}
   */
  colour(mode, frame, scales, style) {
    const r = this.recording, scale = scales[mode], values = this.jointValues(mode, frame), {selected} = style;
    const isSelected = (kind, id) => selected && selected.kind === kind && selected.id === id;
    for (const mesh of this.meshes()) {
      const out = mesh.instanceColor.array, {kind, ids} = mesh.userData;
      ids.forEach((id, i) => {
        const o = 3 * i;
        if (isSelected(kind, id)) return style.accent.toArray(out, o);
        if (kind === 'spring')
          return mode === 'force' ? scale.color(Math.abs(r.tensionOf(frame, id)), out, o) : style.joint.toArray(out, o);
        if (kind === 'joint')
          return values ? scale.color(values[id], out, o) : style.joint.toArray(out, o);
        if (mode === 'body') return (r.bodies.fixed[id] ? style.fixed : palette[id % palette.length]).toArray(out, o);
        if (r.bodies.fixed[id]) return style.fixed.toArray(out, o);
        if (mode === 'speed') return scale.color(r.bodySpeed(frame, id), out, o);
        if (values && r.jointsOfBody[id].length)
          return scale.color(r.bodyJointMaximum(values, id), out, o);
        style.neutral.toArray(out, o);
      });
      mesh.instanceColor.needsUpdate = true;
    }
  }

  meshes() { return [...this.groups.map((group) => group.mesh), ...this.jointMeshes, ...this.springMeshes]; }

  showJoints(visible) {
    for (const mesh of [...this.jointMeshes, ...this.springMeshes]) mesh.visible = visible;
  }

  /** Colour of an instance as the renderer gets it, linear [r, g, b]. */
  colorOf(kind, id) {
    for (const mesh of this.meshes()) {
      const i = mesh.userData.kind === kind ? mesh.userData.ids.indexOf(id) : -1;
      if (i >= 0) return Array.from(mesh.instanceColor.array.slice(3 * i, 3 * i + 3));
    }
    return null;
  }
}

/** Forces as arrows; what of them is inside of or behind bodies shines through. */
export class Arrows {
  constructor(color) {
    this.root = new Group();
    this.materials = [new MeshLambertMaterial({color, fog: false}),
                      new MeshLambertMaterial({color, fog: false, transparent: true, opacity: 0.3, depthTest: false, depthWrite: false})];
    this.capacity = 0;
  }

  setColor(color) {
    for (const material of this.materials) material.color = color;
  }

  /**
   * @param list [{position, force}]  @param length of the arrow of a force [m] as a function of its size
   * @param reach length of a usual arrow [m], which says how thick all are: short ones are thick for their length
   */
  show(list, length, reach) {
    if (list.length > this.capacity) this.grow(list.length);
    for (const mesh of this.root.children) {
      mesh.count = 0;
      const out = mesh.instanceMatrix.array;
      for (const {position, force} of list) {
        const size = Math.hypot(...force), l = length(size);
        if (!(l > 0)) continue;
        const thick = Math.min(reach, 2.5 * l);
        writeMatrix(out, 16 * mesh.count++, ...position, ...turnFromZ(force, size), thick, thick, l);
      }
      mesh.instanceMatrix.needsUpdate = true;
    }
  }

  grow(count) {
    this.capacity = Math.max(16, 2 * count);
    this.root.clear();
    for (const geometry of arrowGeometries())
      for (const material of this.materials) {
        const mesh = new InstancedMesh(geometry, material, this.capacity);
        mesh.frustumCulled = false;
        this.root.add(mesh);
      }
  }
}
