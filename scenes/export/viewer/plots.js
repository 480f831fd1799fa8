// Curves over time with a cursor at the present instant; a press or drag on them moves it.

const kColors = {light: ['#2f6db5', '#cf6a1b', '#2f8a55', '#a5478f'], dark: ['#6db0ff', '#ffab5e', '#69d394', '#e58fd0']};

export const format = (value, digits = 4) => {
  if (!Number.isFinite(value)) return '–';
  if (value === 0) return '0';
  const size = Math.abs(value);
  const text = size >= 1e5 || size < 1e-3 ? value.toExponential(2).replace('e+', 'e') : String(Number(value.toPrecision(digits)));
  return text.replace(/^-/, '−');
};

const kPrefixes = [[1e9, 'G'], [1e6, 'M'], [1e3, 'k'], [1, ''], [1e-3, 'm'], [1e-6, 'µ'], [1e-9, 'n'], [1e-12, 'p']];

/** [factor, letter] of the prefix that a number of this size is written with. */
const prefixOf = (size) => kPrefixes.find(([factor]) => size >= 0.9995 * factor) ?? [1, ''];

/** A number with its unit and a prefix of it: 27.7 kN. */
export function withUnit(value, unit, digits = 3) {
  if (!Number.isFinite(value)) return '–';
  const [factor, prefix] = prefixOf(Math.abs(value));
  const text = value === 0 || factor === 1e-12 && Math.abs(value) < 1e-12 ? format(value)
    : String(Number((value / factor).toPrecision(digits))).replace(/^-/, '−');
  return `${text} ${prefix}${unit}`.trim();
}

/** The next number from `least` on that is 1, 2 or 5 times a power of ten. */
export function roundStep(least) {
  const power = 10 ** Math.floor(Math.log10(least)), part = least / power;
  return power * (part > 5 ? 10 : part > 2 ? 5 : part > 1 ? 2 : 1);
}

/** The largest number up to `most` that is 1, 2 or 5 times a power of ten. */
export function roundBelow(most) {
  const power = 10 ** Math.floor(Math.log10(most)), part = most / power;
  return power * (part >= 5 ? 5 : part >= 2 ? 2 : 1);
}

/** Round numbers from low to high, about count of them. */
export function ticks(low, high, count) {
  const step = roundStep((high - low) / count), found = [];
  for (let k = Math.ceil(low / step); k * step <= high + 1e-9 * step && found.length < 50; ++k) found.push(k * step);
  return found;
}

/** Indices that keep every peak: of each `stride` values the least and the largest, in their order. */
export function outline(values, stride) {
  if (stride < 3) return values.keys();
  const kept = [];
  for (let start = 0; start < values.length; start += stride) {
    let least = start, most = start;
    for (let f = start; f < Math.min(start + stride, values.length); ++f) {
      if (values[f] < values[least]) least = f;
      if (values[f] > values[most]) most = f;
    }
    kept.push(Math.min(least, most), ...(least === most ? [] : [Math.max(least, most)]));
  }
  return kept;
}

export class Plot {
  /** @param span of the axis of time [s]  @param series [{name, values: Float64Array; where it has its own: unit, times, color; dashed}]  @param seek called with a time */
  constructor(parent, {title, unit, logarithmic = false, digits = 4}, times, span, seek) {
    Object.assign(this, {times, span, unit, logarithmic, digits, seek, series: []});
    this.element = document.createElement('figure');
    this.element.className = 'plot';
    this.caption = document.createElement('figcaption');
    this.canvas = document.createElement('canvas');
    this.canvas.setAttribute('role', 'img');
    this.element.append(this.caption, this.canvas);
    parent.append(this.element);
    this.setTitle(title);
    const move = (event) => {
      if (event.buttons !== 1) return;
      const {left, width} = this.canvas.getBoundingClientRect(), [x0, x1] = this.range(width);
      const part = Math.min(Math.max((event.clientX - left - x0) / (x1 - x0), 0), 1);
      this.seek(this.span[0] + part * (this.span[1] - this.span[0]));
    };
    this.canvas.addEventListener('pointerdown', (event) => {
      this.canvas.setPointerCapture(event.pointerId);
      move(event);
    });
    this.canvas.addEventListener('pointermove', move);
    new ResizeObserver(() => this.draw()).observe(this.canvas);
  }

  range(width) { return [58, width - 8]; }

  setTitle(title) {
    this.title = title;
    this.canvas.setAttribute('aria-label', `${title} over time`);
  }

  setSeries(series) {
    this.series = series;
    let low = Infinity, high = -Infinity;
    for (const {values} of series)
      for (const value of values) {
        const v = this.map(value);
        if (Number.isFinite(v)) low = Math.min(low, v), high = Math.max(high, v);
      }
    if (!(low <= high)) [low, high] = this.logarithmic ? [-12, -9] : [0, 1];
    if (this.logarithmic) {
      [low, high] = [Math.max(Math.floor(low), Math.ceil(high) - 8), Math.ceil(high)];
      if (low === high) --low;
    } else {
      const margin = 0.06 * (high - low) || 0.05 * Math.abs(high) || 1;
      [low, high] = [low - margin, high + margin];
    }
    // One prefix for axis and numbers, that of the largest: a column of kJ is easier to read than one of 50000 J.
    const size = Math.max(Math.abs(low), Math.abs(high));
    [this.factor, this.prefix] = this.unit && !this.logarithmic && size >= 1000 ? prefixOf(size) : [1, ''];
    Object.assign(this, {low, high});
    this.draw();
  }

  map(value) { return this.logarithmic ? (value > 0 ? Math.log10(value) : NaN) : value; }

  /** Moves the cursor. */
  show(t, frame) {
    Object.assign(this, {t, frame});
    this.draw();
  }

  /** Curves are drawn once and kept as an image; the cursor comes on top each time. */
  draw() {
    const {clientWidth: width, clientHeight: height} = this.canvas, ratio = Math.min(window.devicePixelRatio, 2);
    if (!width || !height) return;
    const dark = document.documentElement.dataset.theme === 'dark', key = [width, height, dark, ratio].join();
    if (this.key !== key || this.drawnSeries !== this.series) {
      this.canvas.width = width * ratio;
      this.canvas.height = height * ratio;
      this.key = key;
      this.drawnSeries = this.series;
      this.image = new OffscreenCanvas(width * ratio, height * ratio);
      const context = this.image.getContext('2d');
      context.scale(ratio, ratio);
      this.drawCurves(context, width, height, kColors[dark ? 'dark' : 'light'], dark);
    }
    const context = this.canvas.getContext('2d');
    context.clearRect(0, 0, this.canvas.width, this.canvas.height);
    context.drawImage(this.image, 0, 0);
    if (this.t !== undefined) this.drawCursor(context, ratio, width, height, kColors[dark ? 'dark' : 'light'], dark);
    this.writeCaption(kColors[dark ? 'dark' : 'light']);
  }

  place(width, height) {
    const [x0, x1] = this.range(width), [t0, t1] = this.span;
    return {
      x: (t) => x0 + (t1 > t0 ? (t - t0) / (t1 - t0) : 0) * (x1 - x0),
      // What is far below the decades that are shown runs along the bottom.
      y: (value) => Math.min(height - 18 - (this.map(value) - this.low) / (this.high - this.low) * (height - 26), height - 17),
    };
  }

  drawCurves(context, width, height, colors, dark) {
    const {x, y} = this.place(width, height), [x0, x1] = this.range(width);
    context.font = '10px system-ui, sans-serif';
    context.fillStyle = dark ? '#9aa7b5' : '#5d6a78';
    context.strokeStyle = dark ? '#ffffff14' : '#00000012';
    context.textAlign = 'right';
    const each = this.factor, levels = Math.max(2, Math.round(height / 24));
    for (const tick of ticks(this.low / each, this.high / each, levels)) {
      if (this.logarithmic && tick !== Math.round(tick)) continue;
      const at = y(this.logarithmic ? 10 ** tick : tick * each);
      context.beginPath();
      context.moveTo(x0, at);
      context.lineTo(x1, at);
      context.stroke();
      context.fillText(`${this.logarithmic ? `1e${tick}` : format(tick)} ${this.unitOf(this.series.length === 1 ? this.series[0] : {})}`.trim(), x0 - 5, at + 3);
    }
    context.textAlign = 'center';
    const [t0, t1] = this.span;
    if (t1 > t0)
      for (const tick of ticks(t0, t1, Math.max(2, Math.round(width / 80))))
        context.fillText(`${format(tick)} s`, Math.min(Math.max(x(tick), x0 + 6), x1 - 10), height - 4);
    context.lineWidth = 1.6;
    context.lineJoin = 'round';
    this.series.forEach(({values, times = this.times, dashed, color}, s) => {
      context.strokeStyle = colors[(color ?? s) % colors.length];
      context.setLineDash(dashed ? [4, 4] : []);
      context.beginPath();
      let down = false;
      for (const f of outline(values, Math.ceil(values.length / width))) {
        const at = y(values[f]);
        if (Number.isFinite(at)) down ? context.lineTo(x(times[f]), at) : context.moveTo(x(times[f]), at);
        down = Number.isFinite(at);
      }
      context.stroke();
    });
  }

  drawCursor(context, ratio, width, height, colors, dark) {
    const {x, y} = this.place(width, height);
    context.save();
    context.scale(ratio, ratio);
    context.strokeStyle = dark ? '#ffffff90' : '#00000070';
    context.beginPath();
    context.moveTo(x(this.t), 4);
    context.lineTo(x(this.t), height - 18);
    context.stroke();
    this.series.forEach((series, s) => {
      const frame = this.frameOf(series), at = y(series.values[frame]);
      if (!Number.isFinite(at)) return;
      context.fillStyle = colors[(series.color ?? s) % colors.length];
      context.beginPath();
      context.arc(x((series.times ?? this.times)[frame]), at, 3, 0, 7);
      context.fill();
    });
    context.restore();
  }

  /** The frame of a curve that is nearest to the present instant. */
  frameOf({times}) {
    if (!times) return Math.min(this.frame, this.times.length - 1);  // of a run that goes on, curves come a little later
    let low = 0, high = times.length - 1;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (times[middle] < this.t) low = middle + 1; else high = middle;
    }
    return low > 0 && this.t - times[low - 1] <= times[low] - this.t ? low - 1 : low;
  }

  /** A number of a curve; what hardly differs from 0 in the picture with one digit. */
  short(value) {
    const isSmall = !this.logarithmic && Math.abs(value) < 1e-4 * (this.high - this.low);
    return isSmall && value !== 0 ? (value / this.factor).toExponential(0).replaceAll('-', '−') : format(value / this.factor, this.digits);
  }

  writeCaption(colors) {
    const title = document.createElement('strong');
    title.textContent = this.title;
    this.caption.replaceChildren(title, ...this.series.map((series, s) => {
      const item = document.createElement('span');
      item.style.setProperty('--line', colors[(series.color ?? s) % colors.length]);
      item.textContent = this.frame === undefined ? series.name : `${series.dashed ? '┄ ' : ''}${series.name} ${this.short(series.values[this.frameOf(series)])} ${this.unitOf(series)}`.trim();
      return item;
    }));
  }

  /** The unit that numbers of a curve are written with, "" if it has none; for the axis, that of all. */
  unitOf({unit = this.unit}) { return unit ? this.prefix + unit : ''; }
}
