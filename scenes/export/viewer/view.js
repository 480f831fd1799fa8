// The picture: camera, light, floor, picking.
import {
  AmbientLight, BufferGeometry, Color, DirectionalLight, Fog, HemisphereLight, LineBasicMaterial, LineSegments,
  Float32BufferAttribute, Mesh, MeshLambertMaterial, PerspectiveCamera, PlaneGeometry, Quaternion, Raycaster, Scene,
  Vector2, Vector3, WebGLRenderer,
} from 'three';
import {OrbitControls} from 'three/addons/controls/OrbitControls.js';
import {bodySizes, outerPoints} from './geometry.js';
import {Arrows, Instances, worldPoint} from './instances.js';
import {roundStep} from './plots.js';

const kThemes = {
  light: {background: '#eef1f4', grid: '#c3cad3', neutral: '#8fa3ba', fixed: '#767c84', joint: '#3d4b5c',
          accent: '#0b63e5', arrow: '#c2185b', ground: '#dfe4e9'},
  dark: {background: '#12161b', grid: '#2c343d', neutral: '#8ea6c4', fixed: '#6b7480', joint: '#cfd8e3',
         accent: '#5aa9ff', arrow: '#ff5c93', ground: '#1b2128'},
};

/** Longer arrows are cut [lengths of usual ones]. */
export const kLongestArrow = 3;

export class View {
  constructor(canvas, recording) {
    this.canvas = canvas;
    this.recording = recording;
    this.renderer = new WebGLRenderer({canvas, antialias: true});
    this.renderer.setPixelRatio(Math.min(window.devicePixelRatio, recording.bodyCount > 3000 ? 1.5 : 2));
    this.scene = new Scene();
    this.camera = new PerspectiveCamera(40, 1, 0.01, 1000);
    this.poses = new Float32Array(7 * recording.bodyCount);
    this.followed = null;
    const g = new Vector3(...recording.gravity);
    this.up = g.length() > 0 ? g.negate().normalize() : new Vector3(0, 0, 1);
    this.camera.up.copy(this.up);

    this.instances = new Instances(recording);
    this.arrows = new Arrows('#c2185b');
    this.wrench = new Arrows('#c2185b');
    this.scene.add(this.instances.root, this.arrows.root, this.wrench.root);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.addEventListener('change', () => this.onchange?.());
    this.controls.addEventListener('start', () => { this.isMoved = true; });  // by hand
    this.measure();
    this.addLights();
    this.addFloor();
    this.home();
    this.sizes = new ResizeObserver(() => this.resize());
    this.sizes.observe(canvas);
    this.resize();
  }

  /** Centre and size of everything that ever moves. */
  measure() {
    const {low, high} = this.recording.box(), sizes = bodySizes(this.recording).slice(1).map(([, , diagonal]) => diagonal);
    const margin = sizes.reduce((most, size) => Math.max(most, size), 0) / 2;
    this.low = new Vector3(...low).addScalar(-margin);
    this.high = new Vector3(...high).addScalar(margin);
    this.center = this.low.clone().add(this.high).multiplyScalar(0.5);
    this.extent = this.high.distanceTo(this.low) || 1;
    this.reach = 0.14 * this.extent;  // the arrow of a large force
    this.samplePoints(sizes);
  }

  /** Where everything is at some instants: what the camera must see, each with its margin around it. */
  samplePoints(sizes) {
    const {recording: r} = this, poses = new Float32Array(this.poses.length);
    // Corners of the shapes; of many bodies the centres alone.
    const corners = r.drawn.length > 600 ? null : r.drawn.flatMap(([body, shape, x, y, z, ...q]) => {
      const turn = new Quaternion(...q), place = new Vector3(x, y, z);
      return outerPoints(r.shapes[shape]).map((point) => [body, ...new Vector3(...point).applyQuaternion(turn).add(place)]);
    });
    const every = Math.ceil(r.bodyCount / 1500);
    const centres = Array.from({length: Math.ceil((r.bodyCount - 1) / every)}, (_, i) => [1 + every * i, 0, 0, 0]);
    const ends = [...r.course.values(), ...r.springs.map(({course}) => course)].flat();
    const all = [...(corners ?? centres), ...ends], count = Math.min(Math.max(12, Math.floor(6000 / all.length)), 60, r.frames);
    this.points = [];
    this.margins = [];
    const margin = corners ? () => 0.01 * this.extent : ([body]) => (body ? sizes[body - 1] / 2 : 0);
    for (let k = 0; k < count; ++k) {
      r.poses(r.times[Math.round(k * (r.frames - 1) / Math.max(count - 1, 1))], poses);
      for (const point of all) {
        this.points.push(new Vector3(...worldPoint(poses, ...point)));
        this.margins.push(margin(point));
      }
    }
    if (!this.points.length) [this.points, this.margins] = [[this.center], [this.extent / 2]];
  }

  addLights() {
    const key = new DirectionalLight('#ffffff', 2.0), side = new Vector3(0.5, -0.8, 0.35);
    key.position.copy(this.up).multiplyScalar(1.2).add(side);
    this.sky = new HemisphereLight('#ffffff', '#8891a0', 1.5);
    this.sky.position.copy(this.up);
    this.scene.add(key, this.sky, new AmbientLight('#ffffff', 0.25));
  }

  /** A grid under everything, fading out; or the half-spaces, if there are any. */
  addFloor() {
    const cell = roundStep(this.extent / 10), half = Math.ceil(2 * this.extent / cell), lines = [];
    // In pieces: long lines from behind the camera get lost in some renderers.
    for (let i = -half; i <= half; ++i)
      for (let j = -half; j < half; ++j) lines.push(i, j, 0, i, j + 1, 0, j, i, 0, j + 1, i, 0);
    const {planes} = this.instances;
    const geometry = new BufferGeometry().setAttribute(
      'position', new Float32BufferAttribute(lines.map((x) => x * cell), 3));
    this.grid = new LineSegments(geometry, new LineBasicMaterial());  // only the floor fades into the distance
    if (planes.length) {
      this.grid.position.set(...planes[0].p);
      this.grid.quaternion.set(...planes[0].q);
      this.ground = new Mesh(new PlaneGeometry(8 * this.extent, 8 * this.extent), new MeshLambertMaterial());
      this.ground.position.copy(this.grid.position).addScaledVector(
        new Vector3(0, 0, 1).applyQuaternion(this.grid.quaternion), -1e-3 * this.extent);
      this.ground.quaternion.copy(this.grid.quaternion);
      this.scene.add(this.ground);
    } else {
      this.grid.quaternion.setFromUnitVectors(new Vector3(0, 0, 1), this.up);
      const corner = (sign) => (Math.sign(sign) < 0 ? this.high : this.low);
      const lowest = ['x', 'y', 'z'].reduce((sum, axis) => sum + this.up[axis] * corner(this.up[axis])[axis], 0);
      this.grid.position.copy(this.center)
        .addScaledVector(this.up, lowest - this.up.dot(this.center) - 0.02 * this.extent);
    }
    this.scene.add(this.grid);
  }

  /** Looks at everything from a little above, mostly across the thinner side; on a narrow screen more along it. */
  home() {
    const across = new Vector3(), along = new Vector3(), size = this.high.clone().sub(this.low);
    const [thin, long] = ['x', 'y', 'z'].filter((axis) => Math.abs(this.up[axis]) < 0.9).sort((a, b) => size[a] - size[b]);
    across[thin] = thin === 'y' ? -1 : 1;
    along[long] = 1;
    const isLine = size[long] > 6 * size[thin], isNarrow = this.camera.aspect < 0.9;
    this.lookFrom(across.multiplyScalar(0.82).addScaledVector(along, isLine ? (isNarrow ? 1.8 : 0.25) : 0.45)
      .addScaledVector(this.up, isLine && isNarrow ? 0.7 : 0.34));
    this.isMoved = false;
  }

  /** Looks at everything from the front (along y, or along −z where y is up), the side, the top or a corner. */
  preset(name) {
    const front = Math.abs(this.up.y) > 0.7 ? new Vector3(0, 0, 1) : new Vector3(0, -1, 0);
    front.addScaledVector(this.up, -front.dot(this.up)).normalize();
    const side = this.up.clone().cross(front);
    if (side.dot(new Vector3(1, 1, 1)) < 0) side.negate();  // from the positive end of its axis
    const direction = {front, side, top: this.up.clone().addScaledVector(front, 1e-3),  // whose picture has its top at the back
                       isometric: front.clone().add(side).add(this.up)}[name];
    this.lookFrom(direction);
    this.isMoved = true;
  }

  lookFrom(towards) {
    const direction = towards.clone().normalize(), {target, distance} = this.fit(direction);
    this.camera.position.copy(target).addScaledVector(direction, distance);
    this.controls.target.copy(target);
    this.camera.near = this.extent / 500;
    this.camera.far = this.extent * 40;
    this.scene.fog = new Fog(0, distance + 0.6 * this.extent, distance + 2.4 * this.extent);
    this.applyTheme(this.theme ?? 'light');
    this.camera.updateProjectionMatrix();
    this.controls.update();
  }

  /**
   * The nearest place from where everything in samplePoints() is in the picture.  At right r, top t and forward f from
   * the camera, a point is seen if −w f ≤ r ≤ e f and −b f ≤ t ≤ c f.  Each of these four bounds holds for all points if it holds
   * for the point that is worst, wherever the camera is; the camera goes as far forward as they let it.
   */
  fit(direction) {
    if (this.partner && !this.isFitting) return this.fitBoth(direction);
    const forward = direction.clone().negate(), right = forward.clone().cross(this.up).normalize();
    const top = right.clone().cross(forward), t = Math.tan(this.camera.fov * Math.PI / 360);
    // The head line and the legend, on a phone above each other, take a part of the height, and so may others [px].
    const {clientWidth, clientHeight} = this.canvas, covered = this.covered?.() ?? {top: 62, right: 0, bottom: 0};
    const rest = (taken, size) => t * Math.max(1 - 2 * taken / Math.max(size, 1), 0.05);
    const b = rest(Math.max(covered.bottom, 36), clientHeight), c = rest(covered.top, clientHeight);
    const widest = 0.92 * t * this.camera.aspect, beside = (taken) => Math.min(widest, this.camera.aspect * rest(taken, clientWidth));
    const w = beside(covered.left ?? 0), e = beside(covered.right);
    const points = this.points.map((point, i) => [point.dot(right), point.dot(top), point.dot(forward), this.margins[i]]);
    const most = (of) => points.reduce((sum, point) => Math.max(sum, of(point)), -Infinity);
    const east = most(([r, , f, m]) => r - e * f + m), west = most(([r, , f, m]) => -r - w * f + m);
    const north = most(([, u, f, m]) => u - c * f + m), south = most(([, u, f, m]) => -u - b * f + m);
    const far = most(([, , f]) => f), near = -most(([, , f, m]) => 2 * m - f);
    // Not so near that the front is more than about three times as large as the back.
    const f = Math.min(-(east + west) / (e + w), -(north + south) / (b + c), near - 0.4 * (far - near));
    // Where there is room to spare, the same on both sides of the picture.
    const balanced = (k, low, high, lowSlope, highSlope) => {
      for (let i = 0; i < 40; ++i) {
        const x = (low + high) / 2;
        const excess = most((point) => (point[k] - x + point[3]) / (point[2] - f)) / highSlope
          - most((point) => (x - point[k] + point[3]) / (point[2] - f)) / lowSlope;
        if (excess > 0) low = x; else high = x;
      }
      return (low + high) / 2;
    };
    const r = balanced(0, east + e * f, -west - w * f, w, e), u = balanced(1, north + c * f, -south - b * f, b, c);
    const distance = Math.max((near + far) / 2 - f, 1e-3 * this.extent);
    const target = new Vector3().addScaledVector(right, r).addScaledVector(top, u).addScaledVector(forward, f + distance);
    return {target, distance};
  }

  /** From where both pictures see all they have. */
  fitBoth(direction) {
    const {points, margins, partner} = this;
    Object.assign(this, {points: [...points, ...partner.points], margins: [...margins, ...partner.margins], isFitting: true});
    const found = this.fit(direction);
    Object.assign(this, {points, margins, isFitting: false});
    return found;
  }

  dispose() {
    this.sizes.disconnect();
    this.controls.dispose();
    this.renderer.dispose();
    this.renderer.forceContextLoss();
  }

  applyTheme(name) {
    this.theme = name;
    const theme = kThemes[name], color = (hex) => new Color(hex);
    this.scene.background = color(theme.background);
    if (this.scene.fog) this.scene.fog.color = color(theme.background);
    this.grid.material.color = color(theme.grid);
    if (this.ground) this.ground.material.color = color(theme.ground);
    this.arrows.setColor(color(theme.arrow));
    this.wrench.setColor(color(theme.accent));
    this.sky.intensity = name === 'dark' ? 1.3 : 1.7;
    this.style = {neutral: color(theme.neutral), fixed: color(theme.fixed), joint: color(theme.joint),
                  accent: color(theme.accent)};
  }

  resize() {
    const {clientWidth: width, clientHeight: height} = this.canvas;
    if (!width || !height || (width === this.width && height === this.height)) return;
    const isTurned = width !== this.width;  // or opened; curves that come and go change the height alone
    Object.assign(this, {width, height});
    this.renderer.setSize(width, height, false);
    this.camera.aspect = width / height;
    this.camera.updateProjectionMatrix();
    if (isTurned && !this.isMoved && this.followed === null) this.home();
    if (this.isShown) this.render();  // at once: the canvas is blank now
    this.onchange?.();
  }

  /** Shows the instant t. @param colouring {mode, scales, selected, contacts: whether to show forces} */
  show(t, {mode, scales, selected, contacts}) {
    const frame = this.recording.nearest(t), before = this.followed === null ? null : this.bodyPosition(this.followed);
    this.recording.poses(t, this.poses);
    if (before) this.moveWith(before);
    this.isShown = true;
    this.instances.place(this.poses, frame);
    this.instances.colour(mode, frame, scales, {...this.style, selected});
    const length = (scale) => (force) => this.reach * Math.min(force / scale.high, kLongestArrow);
    this.arrows.show(contacts ? this.recording.contacts(frame) : [], length(scales.contact), this.reach);
    this.wrench.show(selected?.kind === 'joint' ? [{
      position: this.jointPosition(selected.id),
      force: this.recording.jointVector(this.recording.force, frame, selected.id),
    }] : [], length(scales.force), this.reach);
  }

  render() {
    this.renderer.render(this.scene, this.camera);
  }

  bodyPosition(body) { return new Vector3().fromArray(this.poses, 7 * body); }
  jointPosition(joint) {
    const {b, anchor} = this.recording.joints;
    return worldPoint(this.poses, b[joint], ...anchor.slice(3 * joint, 3 * joint + 3));
  }
  positionOf({kind, id}) {
    if (kind === 'body') return this.bodyPosition(id);
    const course = kind === 'spring' ? this.recording.springs[id].course : this.recording.course.get(id);
    if (!course) return new Vector3(...this.jointPosition(id));
    // The middle of the longest section of a wire, or of a spring.
    const points = course.map((point) => new Vector3(...worldPoint(this.poses, ...point)));
    const middles = points.slice(1).map((end, i) => ({length: end.distanceTo(points[i]), at: end.clone().lerp(points[i], 0.5)}));
    return middles.reduce((a, b) => (b.length > a.length ? b : a)).at;
  }

  /** The point of a body [body, x, y, z], in its axes, that a pick has met; of a joint its place, of a wire or spring an end. */
  pointOf({kind, id, point}) {
    const r = this.recording;
    if (kind === 'joint' && !r.course.has(id)) return [r.joints.b[id], ...r.joints.anchor.slice(3 * id, 3 * id + 3)];
    if (kind !== 'body') {
      const ends = kind === 'spring' ? r.springs[id].course : r.course.get(id);
      const far = (end) => point.distanceTo(new Vector3(...worldPoint(this.poses, ...end)));
      return ends.reduce((best, end) => (far(end) < far(best) ? end : best));
    }
    const turn = new Quaternion().fromArray(this.poses, 7 * id + 3).invert();
    return [id, ...point.clone().sub(this.bodyPosition(id)).applyQuaternion(turn)];
  }

  /** How many pixels a metre has where the camera turns about. */
  get pixelsPerMetre() {
    const distance = this.camera.position.distanceTo(this.controls.target);
    return this.canvas.clientHeight / (2 * distance * Math.tan(this.camera.fov * Math.PI / 360));
  }

  /** Keeps a body where it is in the picture. */
  follow(body) {
    this.followed = body;
    if (body === null) return;
    const shift = this.bodyPosition(body).sub(this.controls.target);
    this.controls.target.add(shift);
    this.camera.position.add(shift);
    this.controls.update();
  }
  moveWith(before) {
    const shift = this.bodyPosition(this.followed).sub(before);
    this.controls.target.add(shift);
    this.camera.position.add(shift);
    this.controls.update();
  }

  /** Place on the canvas [px] of a world point. */
  project(point) {
    this.camera.updateMatrixWorld();
    const v = (point.isVector3 ? point.clone() : new Vector3(...point)).project(this.camera);
    const {clientWidth, clientHeight} = this.canvas;
    return {x: (v.x + 1) / 2 * clientWidth, y: (1 - v.y) / 2 * clientHeight, visible: v.z < 1};
  }

  /** Where the line of sight through a place on the canvas [px] meets the plane through a world point that faces the camera. */
  placeAt(x, y, through) {
    const ray = new Raycaster(), {clientWidth, clientHeight} = this.canvas, facing = this.camera.getWorldDirection(new Vector3());
    ray.setFromCamera(new Vector2(2 * x / clientWidth - 1, 1 - 2 * y / clientHeight), this.camera);
    const {origin, direction} = ray.ray, away = facing.dot(new Vector3(...through).sub(origin)) / facing.dot(direction);
    return origin.clone().addScaledVector(direction, away).toArray();
  }

  /** What is drawn at a place on the canvas [px], or else at most `tolerance` beside it: {kind, id, point} or null. */
  pick(x, y, tolerance = 0) {
    const around = [0, 1, 2, 3, 4, 5, 6, 7].map((i) => [Math.cos(i * Math.PI / 4), Math.sin(i * Math.PI / 4)]);
    for (const [dx, dy] of [[0, 0], ...(tolerance ? around : [])]) {
      const found = this.pickExactly(x + tolerance * dx, y + tolerance * dy);
      if (found) return found;
    }
    return null;
  }

  pickExactly(x, y) {
    const ray = new Raycaster(), {clientWidth, clientHeight} = this.canvas;
    ray.setFromCamera(new Vector2(2 * x / clientWidth - 1, 1 - 2 * y / clientHeight), this.camera);
    const hits = ray.intersectObjects(this.instances.root.children.filter((mesh) => mesh.visible), false);
    if (!hits.length) return null;
    const item = ({object, instanceId, point}) => ({kind: object.userData.kind, id: object.userData.ids[instanceId], point});
    // Joints sit inside the ends of their bodies: one just under the surface is meant.
    const joint = hits.find((hit) => {
      const {kind, id} = item(hit);
      return kind === 'joint' && hit.distance - hits[0].distance < 4 * this.instances.jointRadius[id];
    });
    return item(joint ?? hits[0]);
  }
}
