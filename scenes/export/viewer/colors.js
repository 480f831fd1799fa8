// What colours mean: a ramp from slack to taut, and the range of each quantity over the whole recording.
import {Color, SRGBColorSpace} from 'three';

// From quiet blue to hot red; every step also differs in lightness from its neighbours.
const kStops = ['#34558b', '#2a8fa8', '#4fb286', '#c4cf4f', '#f4b13d', '#ea6a32', '#c9243f'];
const kPalette = ['#4e79a7', '#e08a3c', '#5aa469', '#c2557a', '#8a6fb0', '#b59a3a', '#4aa3a8', '#a8705a'];

function ramp() {
  const colors = kStops.map((stop) => Number.parseInt(stop.slice(1), 16));
  const table = new Uint8Array(3 * 256);
  for (let i = 0; i < 256; ++i) {
    const place = i / 255 * (colors.length - 1), k = Math.min(Math.floor(place), colors.length - 2);
    for (let c = 0; c < 3; ++c) {
      const a = colors[k] >> (16 - 8 * c) & 255, b = colors[k + 1] >> (16 - 8 * c) & 255;
      table[3 * i + c] = Math.round(a + (place - k) * (b - a));
    }
  }
  return table;
}
export const kRamp = ramp();

/** The ramp in the linear colours that the renderer computes with. */
const linear = (() => {
  const table = new Float32Array(3 * 256), color = new Color();
  for (let i = 0; i < 256; ++i)
    color.setRGB(kRamp[3 * i] / 255, kRamp[3 * i + 1] / 255, kRamp[3 * i + 2] / 255, SRGBColorSpace)
      .toArray(table, 3 * i);
  return table;
})();

export const palette = kPalette.map((hex) => new Color(hex));
export const rampCss = () => `linear-gradient(90deg, ${kStops.join(',')})`;

/** From a value to 0…1; values outside are held at the ends.  kind: linear, root (√(v/high), from 0) or log. */
export class Scale {
  constructor(low, high, unit, kind = 'linear') {
    Object.assign(this, {low, high, unit, kind});
  }
  part(value) {
    const {low, high, kind} = this;
    if (!(high > low)) return 0;
    const part = kind === 'log' ? Math.log(Math.max(value, low) / low) / Math.log(high / low)
      : kind === 'root' ? Math.sqrt(Math.max(value, 0) / high) : (value - low) / (high - low);
    return Math.min(Math.max(part, 0), 1);
  }
  value(part) {
    const {low, high, kind} = this;
    return kind === 'log' ? low * (high / low) ** part : kind === 'root' ? part * part * high
      : low + part * (high - low);
  }
  /** Writes the linear colour of a value. */
  color(value, out, offset) {
    const i = 3 * Math.round(255 * this.part(value));
    out[offset] = linear[i];
    out[offset + 1] = linear[i + 1];
    out[offset + 2] = linear[i + 2];
  }
}

/** A quantile over at most some ten thousand samples: single peaks must not make all else look slack. */
function quantile(count, at, q) {
  const step = Math.max(1, Math.floor(count / 40000)), values = [];
  for (let i = 0; i < count; i += step) values.push(at(i));
  values.sort((a, b) => a - b);
  return values.length ? values[Math.min(values.length - 1, Math.floor(q * values.length))] : 0;
}

export function scales(recording) {
  const {frames, jointCount, bodyCount} = recording, joints = frames * jointCount;
  // The values of joints, then those of springs.
  const force = quantile(joints + frames * recording.springCount,
    (i) => (i < joints ? recording.force.norm3(3 * i) : Math.abs(recording.tension.at(i - joints))), 0.997);
  const gap = quantile(joints, (i) => recording.gap.at(i), 1);
  const speed = quantile(frames * (bodyCount - 1), (i) => recording.speed.at(i), 0.999);
  // What moves less than a thousandth of the picture in the whole run is at rest: its speed is round-off.
  const {low, high} = recording.box(), rest = 1e-3 * Math.hypot(...low.map((x, i) => high[i] - x)) / ((recording.end - recording.start) || 1);
  // Single impacts must not make what rests look forceless: the median of the largest force of each frame that has any.
  const peaks = Array.from({length: frames}, (_, f) => recording.contactPeak(f)).filter((peak) => peak > 0);
  const contact = new Scale(0, quantile(peaks.length, (i) => peaks[i], 0.5) || 1, 'N');
  contact.most = peaks.reduce((a, b) => Math.max(a, b), 0);
  return {
    // Where one cable carries hundreds of others, the small forces must still differ.
    force: new Scale(0, force || 1, 'N', 'root'),
    gap: new Scale(Math.max(gap, 1e-15) * 1e-4, Math.max(gap, 1e-15), 'm', 'log'),
    speed: new Scale(0, Math.max(speed, rest), 'm/s'),
    contact,
  };
}
