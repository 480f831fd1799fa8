// A run that goes on: its frames come through a WebSocket, and what is pressed, pulled and turned goes back.
import {scales as makeScales} from './colors.js';
import {Recording} from './data.js';
import {worldPoint} from './instances.js';
import {curveGroups, Player} from './player.js';
import {Video} from './saving.js';

const $ = (id) => document.getElementById(id);
const kMostFrames = 1800, kMostBytes = 2e8;  // that are kept: half a minute
const kCurvesEvery = 200, kScalesEvery = 1000;  // [ms]

/** A column of all frames that are kept. */
class LiveColumn {
  constructor(recording, name, width) {
    Object.assign(this, {recording, name, width});
  }
  of(index) { return this.recording.list[Math.floor(index / this.width)][this.name]; }
  get words() { return this.recording.list.some((frame) => frame[this.name].words); }
  at(index) { return this.of(index).at(index % this.width); }
  norm3(index) { return this.of(index).norm3(index % this.width); }
}

/** The last frames of a run, each by itself; like a Recording, but it grows. */
export class LiveRecording extends Recording {
  constructor(buffer) {
    super(buffer);
    this.list = [new Recording(buffer)];
    this.size = buffer.byteLength;
    const {jointCount: joints} = this;
    for (const [name, width] of Object.entries({force: 3 * joints, torque: 3 * joints, gap: joints, gap_angle: joints, tension: this.springCount, speed: this.bodyCount - 1}))
      this[name] = new LiveColumn(this, name, width);
    this.update();
  }

  /** @returns the state of the run that came with the frame */
  append(buffer) {
    const frame = this.another(buffer), last = this.list.at(-1);
    // The frame that the page was made with may be from long ago.
    if (frame.live.resets !== this.live.resets || !this.isFed) this.list = [];
    else if (frame.times[0] <= last.times[0]) this.list.pop();
    this.list.push(frame);
    this.isFed = true;
    const most = Math.max(2, Math.min(kMostFrames, Math.floor(kMostBytes / buffer.byteLength)));
    if (this.list.length > most) this.list.splice(0, this.list.length - most);
    this.live = {...this.live, ...frame.live};
    this.update();
    return this.live;
  }
  update() {
    this.frames = this.list.length;
    this.times = this.list.map(({times}) => times[0]);
    this.contactTotal = this.list.reduce((sum, frame) => sum + frame.contactTotal, 0);
  }

  poses(t, out) {
    const frame = this.list[this.nearest(t)];
    return frame.poses(frame.times[0], out);
  }
  pointAt(frame, point) { return this.list[frame].pointAt(0, point); }
  scalar(frame, index) { return this.list[frame].scalar(0, index); }
  contacts(frame) { return this.list[frame].contacts(0); }
  contactPeak(frame) { return this.list[frame].contactPeak(0); }
  isAttached(frame, joint) { return this.list[frame].isAttached(0, joint); }
}

export class LivePlayer extends Player {
  constructor(data) {
    super(new LiveRecording(data));
    this.isAtEnd = true;
    for (const id of ['loop', 'autoplay', 'beside']) $(id).hidden = true;
    $('video').title = 'Records until it is pressed again';
    $('live').hidden = false;
    if (window.innerWidth <= 760) $('live').open = false;
    $('restart').hidden = !this.recording.live.may_reset;
    $('restart').onclick = () => this.send({do: 'reset'});
    $('forward').title = 'One step of the run (→)';
    $('speed').onchange = () => this.send({do: 'speed', value: Number($('speed').value)});
    $('strength').onchange = () => $('view').focus();
    this.setUpMotors();
    this.setUpPulling($('view'));
    this.view.home();  // beside the panel
    this.showRun(this.recording.live);
    this.connect();
  }

  connect() {
    this.socket = new WebSocket(`ws://${window.location.host}/live${window.location.search}`);
    this.socket.binaryType = 'arraybuffer';
    this.socket.onopen = () => {
      if (this.state.speed !== 1) this.send({do: 'speed', value: this.state.speed});
    };
    this.socket.onmessage = ({data}) => {
      if (typeof data === 'string') return this.notify(JSON.parse(data).notice);
      this.take(data);
    };
    this.socket.onclose = () => {
      if (this.recording.live.status === 'running') this.showRun({...this.recording.live, status: 'not connected', message: 'reload the page when it runs'});
    };
  }
  send(message) {
    if (this.socket?.readyState === WebSocket.OPEN) this.socket.send(JSON.stringify(message));
  }

  take(buffer) {
    const {recording: r, state} = this, live = r.append(buffer), now = performance.now();
    if (this.isAtEnd || live.resets !== this.resets) {
      state.t = r.end;
      this.isAtEnd = true;
    }
    this.resets = live.resets;
    Object.assign($('time'), {min: r.start, max: r.end});
    if (r.contactTotal > 0) $('contacts').hidden = false;
    this.showRun(live);
    if (!(now - this.curvesAt < kCurvesEvery) || live.paused) this.showCurves(now);
    if (!(now - this.scalesAt < kScalesEvery)) this.showScales(now);
    this.request(true);
  }

  showRun(live) {
    const {status, message, paused, steps} = live, runs = status === 'running';
    document.documentElement.dataset.run = runs ? (paused ? 'paused' : 'running') : 'ended';
    document.documentElement.toggleAttribute('data-playing', runs && !paused);
    $('play').setAttribute('aria-label', runs && !paused ? 'Pause' : 'Play');
    $('run').textContent = `${runs ? (paused ? 'paused' : 'running') : [status, message].filter(Boolean).join(': ')} · step ${steps.toLocaleString('en')}`;
    for (const id of ['play', 'restart']) $(id).disabled = !runs;
    if (document.activeElement !== $('speed')) this.showSpeed(live.speed);
    live.targets.forEach((target, i) => this.showMotor(i, target, live.follows[i]));
  }

  showCurves(now) {
    this.curvesAt = now;
    const {recording: r} = this, groups = curveGroups(r);
    for (const plot of this.plots) Object.assign(plot, {times: r.times, span: [r.start, r.end]});
    groups.forEach(({title, series}) => this.plots.find((plot) => plot.title === title && plot !== this.selectionPlot)?.setSeries(series));
    this.plotSelection(this.state.selected);
  }

  /** Scales grow with what they have to show, and do not shrink again. */
  showScales(now) {
    this.scalesAt = now;
    const found = makeScales(this.recording);
    let grown = false;
    for (const [name, scale] of Object.entries(found)) {
      const old = this.scales[name];
      grown ||= scale.high > old.high || scale.most > old.most;
      scale.high = Math.max(scale.high, old.high);
      if (name === 'contact') scale.most = Math.max(scale.most, old.most);
    }
    found.gap.low = found.gap.high * 1e-4;
    this.scales = found;
    if (grown || $('legend').children[3].hidden === this.recording.contactTotal > 0) this.setMode(this.state.mode);
  }

  setUpMotors() {
    this.motors = this.recording.live.motors.map(({name, unit, low, high, has_trajectory: hasTrajectory}, i) => {
      const row = document.createElement('label'), text = document.createElement('span'), value = document.createElement('output');
      const slider = Object.assign(document.createElement('input'), {type: 'range', min: low, max: high, step: 'any'});
      row.className = 'motor';
      text.textContent = name;
      row.append(text, value, slider);
      $('motors').append(row);
      const follows = hasTrajectory && this.addFollowBox(row, name, i);
      slider.oninput = () => {
        this.showTarget(i, Number(slider.value));
        this.send({do: 'motor', motor: i, target: Number(slider.value)});
      };
      // A slider that is held is not moved by what comes back.
      slider.onpointerdown = () => { slider.dataset.held = ''; };
      slider.onpointerup = slider.onpointercancel = () => { delete slider.dataset.held; };
      return {slider, value, unit, follows};
    });
  }
  /** Of a motor with a trajectory: while it is checked the slider shows where that is; moving the slider leaves it. */
  addFollowBox(row, name, i) {
    const label = document.createElement('label'), box = Object.assign(document.createElement('input'), {type: 'checkbox', checked: true});
    label.className = 'follows';
    label.title = `Whether ${name} follows its trajectory`;
    label.append(box, 'follows its trajectory');
    row.after(label);
    box.onchange = () => this.send(box.checked ? {do: 'follow', motor: i} : {do: 'motor', motor: i, target: Number(this.motors[i].slider.value)});
    return box;
  }
  showMotor(i, target, isFollowing) {
    const {slider, follows} = this.motors[i];
    if (follows) follows.checked = isFollowing;
    if ('held' in slider.dataset) return;
    slider.min = Math.min(slider.min, target);
    slider.max = Math.max(slider.max, target);
    slider.value = target;
    this.showTarget(i, target);
  }
  /** Angles in degrees, other targets in their unit without a prefix; to a thousandth of the slider, so that no digit comes and goes. */
  showTarget(i, target) {
    const {slider, value, unit} = this.motors[i], [factor, written] = unit === 'rad' ? [180 / Math.PI, '°'] : [1, ` ${unit}`];
    const digits = Math.min(Math.max(0, Math.ceil(-Math.log10(factor * (slider.max - slider.min) / 1000))), 9);
    const text = (factor * target).toFixed(digits).replace(/^-(?=.*[1-9])/, '−').replace(/^-/, '') + written;
    value.textContent = text;
    slider.setAttribute('aria-valuetext', text);
  }

  /** The body that a pull of what was hit moves: of a joint one that moves; 0 for none. */
  movingBodyOf({kind, id}) {
    const {bodies, joints} = this.recording, candidates = kind === 'body' ? [id] : kind === 'joint' ? [joints.b[id], joints.a[id]] : [];
    return candidates.find((body) => body > 0 && !bodies.fixed[body]) ?? 0;
  }

  /** The panel at the left is beside the picture, too. */
  covered() {
    const panel = $('live').getBoundingClientRect(), all = $('stage').getBoundingClientRect();
    return {...super.covered(), left: $('live').open && panel.width < all.width / 2 ? panel.right - all.left : 0};
  }

  /** A drag that begins on a body pulls it; one that begins beside turns the view. */
  setUpPulling(canvas) {
    const place = (event) => {
      const {left, top} = canvas.getBoundingClientRect();
      return [event.clientX - left, event.clientY - top];
    };
    canvas.addEventListener('pointerdown', (event) => {
      if (event.button !== 0 || this.isMeasuring || this.pulling) return;
      const found = this.view.pick(...place(event), event.pointerType === 'mouse' ? 2 : 10);
      const body = found && this.movingBodyOf(found);
      if (!body) return;
      this.view.controls.enabled = false;
      canvas.setPointerCapture(event.pointerId);
      this.pulling = {pointer: event.pointerId, from: place(event), body, point: this.view.pointOf({kind: 'body', id: body, point: found.point}).slice(1), through: found.point.toArray()};
    }, {capture: true});
    canvas.addEventListener('pointermove', (event) => {
      const {pulling} = this;
      if (pulling?.pointer !== event.pointerId) return;
      const [x, y] = place(event);
      if (!pulling.to && Math.hypot(x - pulling.from[0], y - pulling.from[1]) < 5) return;
      pulling.to = this.view.placeAt(x, y, pulling.through);
      const {body, point, to} = pulling;
      this.send({do: 'pull', body, point, to, strength: Number($('strength').value)});
      this.request(true);
    });
    const end = (event) => {
      if (this.pulling?.pointer !== event.pointerId) return;
      if (this.pulling.to) this.send({do: 'release'});
      this.pulling = null;
      this.view.controls.enabled = true;
      this.request(true);
    };
    canvas.addEventListener('pointerup', end);
    canvas.addEventListener('pointercancel', end);
  }
  pulled() {
    const {pulling} = this;
    return pulling?.to && [worldPoint(this.view.poses, pulling.body, ...pulling.point), pulling.to];
  }

  seek(t) {
    super.seek(t);
    this.isAtEnd = this.state.t >= this.end;
  }
  step(frames) {
    if (frames > 0 && this.isAtEnd) return this.send({do: 'step'});
    if (!this.recording.live.paused) this.send({do: 'pause'});
    super.step(frames);
  }
  togglePlaying() {
    this.seek(this.end);
    this.send({do: this.recording.live.paused ? 'play' : 'pause'});
  }
  setPlaying(playing) { this.send?.({do: playing ? 'play' : 'pause'}); }

  /** What happens from now on, until it is pressed again. */
  setRecording(on) {
    if (!on) return this.video?.stop();
    this.video = new Video(this, () => {}, () => {
      this.video = null;
      $('video').setAttribute('aria-pressed', false);
    });
    $('video').setAttribute('aria-pressed', true);
  }

  showNumbers() {
    super.showNumbers();
    $('clock').textContent = `${this.state.t.toFixed(3)} s`;
  }
}
