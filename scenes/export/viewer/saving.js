// Pictures, videos and tables of what is shown, as files of the browser.
/** Hands a file to the browser's downloads. */
export function save(blob, name) {
  const link = Object.assign(document.createElement('a'), {href: URL.createObjectURL(blob), download: name});
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

/** A canvas with pictures, overlay, name, time and the meaning of colours: what is seen without its buttons. */
export class Composite {
  constructor(player) {
    this.player = player;
    this.canvas = document.createElement('canvas');
    this.context = this.canvas.getContext('2d');
  }

  /** Must follow the drawing of the views at once: their pixels are gone later. */
  draw() {
    const {canvas, context: c, player} = this, {overlay, pictures, state, recording} = player;
    const {clientWidth: width, clientHeight: height} = overlay.canvas.parentElement;
    // Even sizes, which codecs ask for.
    const ratio = overlay.canvas.width / width, [w, h] = [width, height].map((size) => 2 * Math.floor(size * ratio / 2));
    if (canvas.width !== w || canvas.height !== h) Object.assign(canvas, {width: w, height: h});
    c.setTransform(ratio, 0, 0, ratio, 0, 0);
    for (const {canvas: own} of pictures.map(({view}) => view)) c.drawImage(own, own.offsetLeft, own.offsetTop, own.clientWidth, own.clientHeight);
    c.drawImage(overlay.canvas, 0, 0, width, height);
    const font = 'system-ui, -apple-system, "Segoe UI", Roboto, sans-serif', ink = getComputedStyle(document.documentElement);
    c.textAlign = 'left';
    c.fillStyle = ink.getPropertyValue('--text');
    c.font = `650 18px ${font}`;
    c.fillText(recording.scene, 16, 28);
    c.font = `13px ${font}`;
    c.fillStyle = ink.getPropertyValue('--quiet');
    c.fillText(`t = ${state.t.toFixed(3)} s`, 16, 47);
    this.legend(c, height, font, ink);
  }

  legend(c, height, font, ink) {
    const {player} = this, scale = player.scales[player.state.mode], [title, bar, row, arrows] = document.getElementById('legend').children;
    const y = height - 44;
    c.font = `600 12px ${font}`;
    c.fillStyle = ink.getPropertyValue('--text');
    c.fillText(title.textContent, 16, y);
    c.font = `12px ${font}`;
    c.fillStyle = ink.getPropertyValue('--quiet');
    if (scale) {
      const gradient = c.createLinearGradient(16, 0, 236, 0);
      const stops = getComputedStyle(bar).backgroundImage.match(/rgb\([^)]*\)/g) ?? [];
      stops.forEach((color, i) => gradient.addColorStop(i / (stops.length - 1), color));
      c.fillStyle = gradient;
      c.fillRect(16, y + 6, 220, 8);
      c.fillStyle = ink.getPropertyValue('--quiet');
      [...row.children].forEach((label, i) => {
        c.textAlign = ['left', 'center', 'right'][i];
        c.fillText(label.textContent, 16 + 110 * i, y + 28);
      });
      c.textAlign = 'left';
    }
    if (!arrows.hidden && player.state.contacts) c.fillText(arrows.textContent, 16, y + (scale ? 42 : 16));
  }
}

export function savePicture(player) {
  player.draw(performance.now());
  const composite = new Composite(player);
  composite.draw();
  composite.canvas.toBlob((blob) => save(blob, `${player.fileName()} ${player.state.t.toFixed(3)} s.png`), 'image/png');
}

const kTypes = ['video/webm;codecs=vp9', 'video/webm;codecs=vp8', 'video/webm', 'video/mp4'];

const kStill = 200;  // [ms] that the first and the last picture stand still: browsers may leave such frames out

/** Records a play-through, from the start to the end or until it is stopped. */
export class Video {
  static get type() { return typeof MediaRecorder === 'undefined' ? undefined : kTypes.find((type) => MediaRecorder.isTypeSupported(type)); }

  /** @param ready called when it records  @param done called when it has been saved */
  constructor(player, ready, done) {
    this.player = player;
    this.composite = new Composite(player);
    player.draw(performance.now());
    this.composite.draw();
    const chunks = [], type = Video.type;
    this.recorder = new MediaRecorder(this.composite.canvas.captureStream(60), {mimeType: type, videoBitsPerSecond: 12e6});
    this.recorder.ondataavailable = ({data}) => chunks.push(data);
    this.recorder.onstop = () => {
      save(new Blob(chunks, {type}), `${player.fileName()}.${type.includes('mp4') ? 'mp4' : 'webm'}`);
      done();
    };
    // Before that, frames are lost.
    this.recorder.onstart = () => {
      this.composite.draw();
      setTimeout(() => { if (!this.isStopped) ready(); }, kStill);
    };
    this.recorder.start();
  }
  frame() { this.composite.draw(); }
  stop() {
    this.isStopped = true;
    if (this.recorder.state === 'inactive') return;
    setTimeout(() => { if (this.recorder.state !== 'inactive') this.recorder.stop(); }, kStill);
  }
}

const quoted = (text) => (/[",\n]/.test(text) ? `"${text.replaceAll('"', '""')}"` : text);

/** All curves as a table: time, then a column for each [{name, unit, values}]. */
export function table(times, columns) {
  const head = ['time [s]', ...columns.map(({name, unit}) => (unit ? `${name} [${unit}]` : name))].map(quoted).join();
  const rows = Array.from(times, (t, f) => [t, ...columns.map(({values}) => values[f])].join());
  return `${[head, ...rows].join('\n')}\n`;
}

export const saveCurves = (player) => save(new Blob([table(player.recording.times, player.columns())], {type: 'text/csv'}), `${player.fileName()}.csv`);
