// Geometry of shapes.  Equal kinds share one geometry and are scaled, so that thousands of bodies are a few draw calls.
import {
  BoxGeometry, BufferGeometry, CapsuleGeometry, ConeGeometry, Curve, CylinderGeometry, Float32BufferAttribute,
  IcosahedronGeometry, LatheGeometry, OctahedronGeometry, SphereGeometry, TubeGeometry, Vector2, Vector3,
} from 'three';

/** Corners around a round shape: fewer where there are many of them. */
const detail = (count) => (count > 3000 ? 12 : count > 400 ? 20 : 36);

function meshGeometry(shape) {
  const geometry = new BufferGeometry();
  geometry.setAttribute('position', new Float32BufferAttribute(shape.positions, 3));
  geometry.setIndex(shape.indices);
  geometry.computeVertexNormals();
  return geometry;
}

// The key under which shapes share a geometry, their scale on it, and how it is made.  Axes of revolution are z.
const kinds = {
  sphere: (s) => ({key: 'sphere', scale: [s.radius, s.radius, s.radius]}),
  ellipsoid: (s) => ({key: 'sphere', scale: s.radii}),
  box: (s) => ({key: 'box', scale: s.size}),
  cylinder: (s) => ({key: 'cylinder', scale: [s.radius, s.radius, s.length]}),
  cone: (s) => ({key: 'cone', scale: [s.radius, s.radius, s.height]}),
  capsule: (s, index) => ({key: `capsule ${index}`, scale: [1, 1, 1]}),
  mesh: (s, index) => ({key: `mesh ${index}`, scale: [1, 1, 1]}),
};

function makeGeometry(shape, count) {
  const n = detail(count);
  switch (shape.type) {
    case 'sphere':
    case 'ellipsoid':
      return count > 3000 ? new IcosahedronGeometry(1, 1) : new SphereGeometry(1, n, Math.round(0.66 * n));
    case 'box': return new BoxGeometry(1, 1, 1);
    case 'cylinder': return new CylinderGeometry(1, 1, 1, count > 400 ? 8 : 24).rotateX(Math.PI / 2);
    case 'cone': return new ConeGeometry(1, 1, n).rotateX(Math.PI / 2).translate(0, 0, 0.25);
    case 'capsule':
      return new CapsuleGeometry(shape.radius, shape.length, Math.round(n / 4), n).rotateX(Math.PI / 2);
    default: return meshGeometry(shape);
  }
}

/**
 * Groups of instances with one geometry: [{key, geometry, items: [{body, p, q, scale}]}], and the half-spaces
 * apart, which have no end.
 */
export function instanceGroups(recording) {
  const groups = new Map(), planes = [];
  for (const [body, shapeIndex, ...pose] of recording.drawn) {
    const shape = recording.shapes[shapeIndex], item = {body, p: pose.slice(0, 3), q: pose.slice(3)};
    if (shape.type === 'half_space') {
      planes.push(item);
      continue;
    }
    const {key, scale} = kinds[shape.type](shape, shapeIndex);
    if (!groups.has(key)) groups.set(key, {key, shape, items: []});
    groups.get(key).items.push({...item, scale});
  }
  for (const group of groups.values()) group.geometry = makeGeometry(group.shape, group.items.length);
  return {groups: [...groups.values()], planes};
}

export const jointGeometry = (count) =>
  (count > 6000 ? new OctahedronGeometry(1, 0) : count > 2000 ? new IcosahedronGeometry(1, 0)
    : new SphereGeometry(1, 16, 12));
/** An axis that a joint turns about, of length and radius 1 along z; one that it moves along has a head at each end. */
export const turnGeometry = (count) => new CylinderGeometry(1, 1, 1, count > 2000 ? 6 : 14).rotateX(Math.PI / 2);
export function moveGeometry() {
  const outline = [[0, -0.5], [2.2, -0.3], [0.8, -0.3], [0.8, 0.3], [2.2, 0.3], [0, 0.5]];
  return new LatheGeometry(outline.map(([r, z]) => new Vector2(r, z)), 14).rotateX(Math.PI / 2);
}
/** A section of a rod, rope or wire: of length and radius 1, along z. */
export const sectionGeometry = (count) =>
  new CylinderGeometry(1, 1, 1, count > 2000 ? 5 : 10, 1, count > 2000).rotateX(Math.PI / 2);

/** The middle of the wire of a coil of radius and length 1 along z, with straight ends on the axis. */
class Coil extends Curve {
  constructor(turns) {
    super();
    this.turns = turns;
  }
  getPoint(t, point = new Vector3()) {
    const part = Math.min(Math.max((t - 0.1) / 0.8, 0), 1), ends = Math.min(t / 0.1, (1 - t) / 0.1, 1) * 0.1;
    const radius = kSlimness * Math.min(1, 2 * this.turns * part, 2 * this.turns * (1 - part)), angle = 2 * Math.PI * this.turns * part;
    const z = t < 0.1 ? ends - 0.5 : t > 0.9 ? 0.5 - ends : 0.8 * part - 0.4;
    return point.set(radius * Math.cos(angle), radius * Math.sin(angle), z);
  }
}
/** Radius of a coil at rest, part of its length: its wire is round then. */
export const kSlimness = 0.05;
/** A spring: of length and radius 1, along z. */
export function springGeometry(count) {
  const turns = 9, [along, around] = count > 300 ? [6, 3] : count > 30 ? [10, 5] : [16, 8];
  return new TubeGeometry(new Coil(turns), Math.round(1.25 * turns * along), 0.16 * kSlimness, around)
    .scale(1 / kSlimness, 1 / kSlimness, 1);
}
/** A damper: a cylinder and its thinner rod, of length 1 along z. */
export function damperGeometry() {
  const outline = [[0, -0.5], [0.2, -0.5], [0.2, -0.3], [0.8, -0.3], [0.8, 0.2], [0.2, 0.2], [0.2, 0.5], [0, 0.5]];
  return new LatheGeometry(outline.map(([r, z]) => new Vector2(r, z)), 16).rotateX(Math.PI / 2);
}
export const anchorGeometry = () => new BoxGeometry(2, 2, 2);
/** An arrow of length 1 along z: shaft and head. */
export const arrowGeometries = () => [
  new CylinderGeometry(0.018, 0.018, 0.78, 10).rotateX(Math.PI / 2).translate(0, 0, 0.39),
  new ConeGeometry(0.055, 0.22, 14).rotateX(Math.PI / 2).translate(0, 0, 0.89),
];

/** The box around a shape in its own axes: {low, high}; null for a half-space. */
export function shapeBox(s) {
  const around = (x, y, z) => ({low: [-x, -y, -z], high: [x, y, z]});
  switch (s.type) {
    case 'half_space': return null;
    case 'mesh': return meshBox(s);
    case 'box': return around(...s.size.map((edge) => edge / 2));
    case 'ellipsoid': return around(...s.radii);
    case 'sphere': return around(s.radius, s.radius, s.radius);
    case 'capsule': return around(s.radius, s.radius, s.length / 2 + s.radius);
    case 'cone': return {low: [-s.radius, -s.radius, -s.height / 4], high: [s.radius, s.radius, 0.75 * s.height]};
    default: return around(s.radius, s.radius, s.length / 2);
  }
}

function meshBox({positions}) {
  const low = [Infinity, Infinity, Infinity], high = [-Infinity, -Infinity, -Infinity];
  positions.forEach((x, i) => {
    low[i % 3] = Math.min(low[i % 3], x);
    high[i % 3] = Math.max(high[i % 3], x);
  });
  return {low, high};
}

/** Points that show where a shape reaches, in its own axes: corners of its box; of round ones, the ends of the axes. */
export function outerPoints(shape) {
  const box = shapeBox(shape);
  if (!box) return [];
  const {low, high} = box;
  if (shape.radii || shape.type === 'sphere')
    return [0, 1, 2].flatMap((i) => [low, high].map((end) => end.map((x, k) => (k === i ? x : 0))));
  return [0, 1, 2, 3, 4, 5, 6, 7].map((corner) => low.map((x, k) => (corner >> k & 1 ? high[k] : x)));
}

/** Largest and smallest edge and diagonal of the box around each body's shapes [m]; zeros where nothing is drawn. */
export function bodySizes(recording) {
  const most = new Float32Array(recording.bodyCount), least = new Float32Array(recording.bodyCount).fill(Infinity);
  const diagonal = new Float32Array(recording.bodyCount);
  const edgesOf = recording.shapes.map((shape) => {
    const box = shapeBox(shape);
    return box && box.high.map((x, i) => x - box.low[i]);
  });
  for (const [body, shapeIndex] of recording.drawn) {
    const edges = edgesOf[shapeIndex], s = recording.shapes[shapeIndex];
    if (!edges) continue;
    most[body] = Math.max(most[body], ...edges);
    least[body] = Math.min(least[body], ...edges);
    // A sphere has no corners.
    diagonal[body] = Math.max(diagonal[body], s.radii || s.type === 'sphere' ? Math.max(...edges) : Math.hypot(...edges));
  }
  return Array.from(most, (size, body) => [size, size ? least[body] : 0, diagonal[body]]);
}
