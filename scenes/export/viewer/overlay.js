// What is drawn flat on top of the picture: axes of the world, scale, traces of points, measured distances.
import {Quaternion, Vector3} from 'three';
import {roundBelow, withUnit} from './plots.js';

const kAxes = {light: ['#d0243c', '#23893f', '#2058d8'], dark: ['#ff6f7d', '#5bd47c', '#7fabff']};
export const traceColors = {light: ['#b5179e', '#0a7d8c', '#b85c00', '#4b3fbf'], dark: ['#ff8ae2', '#5fe0ee', '#ffb35c', '#ab9fff']};
const kArm = 30, kCorner = 46, kLongestBar = 110;  // [px]

export class Overlay {
  constructor(canvas) {
    this.canvas = canvas;
    this.context = canvas.getContext('2d');
  }

  /**
   * @param views the pictures: [{view, traces: [{path: [[x, y, z]…], color}], measured: [[x, y, z], …], name, pull: what is pulled, and whither}]
   * @param covered what hides the edges [px]: top, right, bottom
   */
  draw(views, theme, covered) {
    const {clientWidth: width, clientHeight: height} = this.canvas.parentElement, ratio = Math.min(window.devicePixelRatio, 2);
    const {canvas, context: c} = this;
    if (canvas.width !== Math.round(width * ratio) || canvas.height !== Math.round(height * ratio)) {
      canvas.width = Math.round(width * ratio);
      canvas.height = Math.round(height * ratio);
      canvas.style.width = `${width}px`;
      canvas.style.height = `${height}px`;
    }
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    c.clearRect(0, 0, width, height);
    this.ink = theme === 'dark' ? '#e7edf3' : '#1c2530';
    this.halo = theme === 'dark' ? '#12161bd0' : '#eef1f4d0';
    c.lineCap = c.lineJoin = 'round';
    c.font = '12px system-ui, -apple-system, "Segoe UI", Roboto, sans-serif';
    const isBelow = views.at(-1).view.canvas.offsetTop > views[0].view.canvas.offsetTop;
    for (const {view, traces, measured, name, pull} of views) {
      const {offsetLeft: left, offsetTop: top, clientWidth, clientHeight} = view.canvas;
      c.save();
      c.beginPath();
      c.rect(left, top, clientWidth, clientHeight);
      c.clip();
      c.translate(left, top);
      if (views.length > 1) this.name(name, isBelow ? 20 : covered.top - 8, clientWidth, clientHeight, view !== views[0].view);
      for (const {path, color} of traces) this.path(view, path, traceColors[theme][color % traceColors[theme].length], 2);
      this.measure(view, measured);
      if (pull) this.pull(view, pull, kAxes[theme][0]);
      c.restore();
    }
    const x = width - covered.right - kCorner, y = height - covered.bottom - kCorner;
    this.triad(views[0].view, x, y, kAxes[theme]);
    this.scaleBar(views[0].view, x - kCorner, y + kCorner - 16);
  }

  /** Which of two pictures this is. */
  name(text, y, width, height, isSecond) {
    const c = this.context;
    c.textAlign = 'left';
    let shown = text;
    while (shown && c.measureText(shown).width > width - 32) shown = shown.replace(/..?$/, '…').replace(/^…$/, '');
    this.text(shown, 16, y);
    if (!isSecond) return;
    c.strokeStyle = this.ink + '40';
    c.lineWidth = 1;
    c.strokeRect(0, 0, width + 2, height + 2);  // two of whose sides are outside
  }

  /** A curve through points of the world; what is behind the camera is left out. */
  path(view, points, color, width) {
    const c = this.context;
    c.strokeStyle = color;
    c.lineWidth = width;
    c.beginPath();
    let down = false;
    for (const point of points) {
      const {x, y, visible} = view.project(point);
      if (visible) down ? c.lineTo(x, y) : c.moveTo(x, y);
      down = visible;
    }
    c.stroke();
  }

  text(text, x, y, color = this.ink) {
    const c = this.context;
    c.lineWidth = 3;
    c.strokeStyle = this.halo;
    c.strokeText(text, x, y);
    c.fillStyle = color;
    c.fillText(text, x, y);
  }

  measure(view, points) {
    if (points.length === 2) {
      this.path(view, points, this.halo, 5);
      this.path(view, points, this.ink, 1.8);
    }
    const c = this.context, places = points.map((point) => view.project(point));
    for (const {x, y, visible} of places) {
      if (!visible) continue;
      c.beginPath();
      c.arc(x, y, 4, 0, 7);
      c.fillStyle = this.halo;
      c.fill();
      c.lineWidth = 1.8;
      c.strokeStyle = this.ink;
      c.stroke();
    }
    if (points.length < 2 || !places.every(({visible}) => visible)) return;
    c.textAlign = 'center';
    this.text(withUnit(distance(...points), 'm', 4), (places[0].x + places[1].x) / 2, (places[0].y + places[1].y) / 2 - 8);
  }

  pull(view, points, color) {
    this.path(view, points, this.halo, 6);
    this.path(view, points, color, 2.4);
    const c = this.context, {x, y} = view.project(points[1]);
    c.beginPath();
    c.arc(x, y, 5, 0, 7);
    c.fillStyle = color;
    c.fill();
  }

  /** The axes of the world as the camera sees them: x red, y green, z blue; those behind first. */
  triad(view, x, y, colors) {
    const c = this.context, turn = new Quaternion().copy(view.camera.quaternion).invert();
    const axes = ['x', 'y', 'z'].map((name, i) => ({name, color: colors[i], d: new Vector3().setComponent(i, 1).applyQuaternion(turn)}));
    c.textAlign = 'center';
    c.textBaseline = 'middle';
    for (const {name, color, d} of axes.sort((a, b) => a.d.z - b.d.z)) {
      c.lineWidth = 2.6;
      c.strokeStyle = color;
      c.beginPath();
      c.moveTo(x, y);
      c.lineTo(x + kArm * d.x, y - kArm * d.y);
      c.stroke();
      const far = kArm + 9;
      this.text(name, x + far * d.x, y - far * d.y, color);
    }
    c.textBaseline = 'alphabetic';
  }

  /** A round number of metres, at the distance of what the camera turns about; its right end is at (x, y). */
  scaleBar(view, x, y) {
    const c = this.context, {pixelsPerMetre} = view, metres = roundBelow(kLongestBar / pixelsPerMetre);
    const length = metres * pixelsPerMetre, left = x - length;
    this.bar = {metres, length};
    for (const [color, width] of [[this.halo, 5], [this.ink, 1.8]]) {
      c.strokeStyle = color;
      c.lineWidth = width;
      c.beginPath();
      c.moveTo(left, y - 5);
      c.lineTo(left, y);
      c.lineTo(x, y);
      c.lineTo(x, y - 5);
      c.stroke();
    }
    c.textAlign = 'center';
    this.text(withUnit(metres, 'm', 1), (left + x) / 2, y - 6);
  }
}

export const distance = (a, b) => Math.hypot(...a.map((value, i) => b[i] - value));
