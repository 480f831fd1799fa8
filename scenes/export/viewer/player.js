// Puts the page together: time, selection, colours, curves.
import {commonCurves, commonScales, recordingOfPage} from './beside.js';
import {rampCss, scales as makeScales} from './colors.js';
import {Recording} from './data.js';
import {worldPoint} from './instances.js';
import {setUpKeys} from './keys.js';
import {setUpMenu} from './menus.js';
import {readOptions, writeFlag} from './options.js';
import {distance, Overlay} from './overlay.js';
import {Inspector, nameOf, setUpFinder} from './panel.js';
import {Plot, withUnit} from './plots.js';
import {saveCurves, savePicture, Video} from './saving.js';
import {kLongestArrow, View} from './view.js';

const $ = (id) => document.getElementById(id);
const kShort = {'kinetic energy': 'kin.', 'potential energy': 'pot.'};
const kModes = {force: 'Joint force', gap: 'Joint gap', speed: 'Speed', body: 'Each body its colour'};

/** A trace has at most this many points. */
const kMostOfTrace = 2000;

/** What the name of one of two pictures takes of its height [px]. */
const kNameHeight = 28;

export class Player {
  constructor(recording, second) {
    this.recording = recording;
    this.scales = makeScales(recording);
    this.view = new View($('view'), recording);
    this.pictures = [{view: this.view, recording}];
    this.overlay = new Overlay($('overlay'));
    this.names = [];  // of two pictures
    this.options = readOptions();
    this.traces = [];    // [{point: [body, x, y, z], color}]
    this.measured = [];  // up to two points likewise
    this.state = {t: recording.start, playing: false, speed: 1, mode: recording.force.words || recording.tension.words ? 'force' : recording.jointCount ? 'speed' : 'body',
                  selected: null, joints: true, contacts: true, loop: false};
    this.inspector = new Inspector($('inspector'), recording, {
      select: (s) => this.select(s), follow: (body) => this.follow(body), trace: (point) => this.trace(point)});
    this.find = setUpFinder($('finder'), recording, (selected) => this.select(selected));
    this.view.onchange = () => this.request();
    this.view.covered = () => this.covered();
    this.setUpTheme();
    this.setUpPlots();
    this.setUpControls();
    this.setUpMore();
    setUpKeys(this);
    this.setMode(this.state.mode);
    this.placeBelowTools();
    this.view.resize();  // the curves have taken their part of the height
    this.view.home();
    if (second) this.showBeside(second);
    this.apply(this.options);
    this.draw(performance.now());
  }

  /** What the address asks for. */
  apply({autoplay, loop, speed, t, view, colour, theme}) {
    if (theme === 'light' || theme === 'dark') this.setTheme(theme);
    if (colour && $('mode').querySelector(`[value="${CSS.escape(colour)}"]`)) this.setMode(colour);
    if (['front', 'side', 'top', 'isometric'].includes(view)) this.look(view);
    if (t !== undefined) this.seek(t);
    if (speed > 0) {
      this.showSpeed(speed);
      this.state.speed = speed;
    }
    if (loop) this.setLoop(true);
    $('autoplay').setAttribute('aria-pressed', autoplay);
    if (autoplay) this.setPlaying(true);
  }

  showSpeed(speed) {
    const box = $('speed');
    if (![...box.options].some(({value}) => Number(value) === speed)) box.add(new Option(`${speed}×`, speed));
    box.value = [...box.options].find(({value}) => Number(value) === speed).value;
  }

  get start() { return Math.min(...this.pictures.map(({recording}) => recording.start)); }
  get end() { return Math.max(...this.pictures.map(({recording}) => recording.end)); }

  /** What hides the edges of the view [px]. */
  covered() {
    const all = $('stage').getBoundingClientRect(), isPhone = all.width <= 760;
    const top = Math.max(...(isPhone ? ['legend'] : ['tools', 'head']).map((id) => $(id).getBoundingClientRect().bottom)) - all.top;
    // Of two pictures the numbers hide a part of the second one, which is seen from where the first is.
    if (this.pictures.length > 1) return {top: isPhone ? kNameHeight : Math.min(top + kNameHeight, 0.4 * this.view.canvas.clientHeight), right: 0, bottom: 0};
    return {top: top + 8, ...this.inspector.covers()};
  }

  placeBelowTools() {
    const {offsetWidth, offsetTop, offsetHeight} = $('tools'), stage = $('stage').style;
    stage.setProperty('--tools', `${offsetWidth}px`);  // the title ends where the buttons begin
    stage.setProperty('--below-head', `${$('head').offsetTop + $('head').offsetHeight + 8}px`);
    stage.setProperty('--below-tools', `${offsetTop + offsetHeight + 8}px`);
    stage.setProperty('--below-legend', `${$('legend').offsetTop + $('legend').offsetHeight + 8}px`);  // where two pictures begin on a phone
  }

  setUpTheme() {
    const query = matchMedia('(prefers-color-scheme: dark)');
    this.setTheme(query.matches ? 'dark' : 'light');
    if (this.options.theme) return;
    query.addEventListener('change', () => this.setTheme(query.matches ? 'dark' : 'light'));
  }

  setTheme(name) {
    document.documentElement.dataset.theme = name;
    for (const {view} of this.pictures) view.applyTheme(name);
    this.plots?.forEach((plot) => plot.draw());
    this.request(true);
  }

  setUpPlots() {
    const [{recording: r}, other] = this.pictures, span = [this.start, this.end], seek = (t) => this.seek(t);
    const own = curveGroups(r);
    const groups = other ? commonCurves(own, {groups: curveGroups(other.recording), times: other.recording.times}) : own;
    $('plots').replaceChildren();
    this.plots = groups.map(({series, ...options}) => {
      const plot = new Plot($('plots'), options, r.times, span, seek);
      plot.setSeries(series);
      return plot;
    });
    this.selectionPlot = new Plot($('plots'), {title: 'Selection'}, r.times, span, seek);
    $('plots').insertBefore(this.selectionPlot.element, $('plots').children[2] ?? null);
    this.plots.push(this.selectionPlot);
    this.plotSelection(this.state.selected);
  }

  setUpControls() {
    const r = this.recording, moving = r.bodies.fixed.filter((fixed, i) => i > 0 && !fixed).length, parameters = parametersOf(r);
    const counted = [[moving, 'body', 'bodies'], [r.jointCount, 'joint', 'joints'], ...(r.springCount ? [[r.springCount, 'spring', 'springs']] : [])];
    $('facts').textContent = [...parameters, ...counted.map(([count, one, many]) => `${count.toLocaleString('en')} ${count === 1 ? one : many}`)].join(' · ');
    const slider = $('time');
    Object.assign(slider, {min: this.start, max: this.end, value: this.start});
    slider.oninput = () => this.seek(Number(slider.value));
    $('play').onclick = () => this.togglePlaying();
    $('back').onclick = () => this.step(-1);
    $('forward').onclick = () => this.step(1);
    $('speed').onchange = () => { this.state.speed = Number($('speed').value); };
    $('mode').onchange = () => this.setMode($('mode').value);
    $('find').onclick = this.find;
    $('loop').onclick = () => this.setLoop(!this.state.loop);
    $('home').onclick = () => this.home();
    $('theme').onclick = () => this.setTheme(this.view.theme === 'dark' ? 'light' : 'dark');
    $('help').onclick = () => $('keys').showModal();
    for (const id of ['joints', 'contacts', 'curves']) $(id).onclick = () => this.toggle(id);
    $('contacts').hidden = r.contactTotal === 0;
    $('joints').hidden = r.jointCount + r.springCount === 0;
    if (r.springCount) kModes.force = r.jointCount ? 'Force of joints and springs' : 'Force of springs';
    const without = [...(r.jointCount ? [] : ['gap']), ...(r.jointCount + r.springCount ? [] : ['force'])];
    for (const mode of without) $('mode').querySelector(`[value=${mode}]`).remove();
    if (window.innerHeight < 480) this.toggle('curves');
    this.setUpPicking($('view'), 0);
    const sizes = new ResizeObserver(() => this.placeBelowTools());
    for (const id of ['tools', 'legend', 'head']) sizes.observe($(id));
  }

  setUpMore() {
    setUpMenu($('views'), $('views-menu'));
    setUpMenu($('more'), $('more-menu'));
    for (const button of document.querySelectorAll('[data-look]')) button.onclick = () => this.look(button.dataset.look);
    $('measure').onclick = () => this.setMeasuring(!this.isMeasuring);
    $('untrace').onclick = () => {
      this.traces = [];
      this.traced();
    };
    $('picture').onclick = () => savePicture(this);
    $('csv').onclick = () => saveCurves(this);
    $('video').hidden = !Video.type;
    $('video').onclick = () => this.setRecording(!this.video);
    $('beside').onclick = () => (this.pictures.length > 1 ? this.closeBeside() : $('other').click());
    $('other').onchange = () => {
      const [file] = $('other').files;
      $('other').value = '';
      if (file) this.openBeside(file);
    };
    $('stage').addEventListener('dragover', (event) => event.preventDefault());
    $('stage').addEventListener('drop', (event) => {
      event.preventDefault();
      if (event.dataTransfer.files.length) this.openBeside(event.dataTransfer.files[0]);
    });
    $('autoplay').onclick = () => {
      const on = $('autoplay').getAttribute('aria-pressed') !== 'true';
      $('autoplay').setAttribute('aria-pressed', on);
      writeFlag('autoplay', on);
    };
  }

  notify(text) {
    $('notice').textContent = text;
    $('notice').hidden = false;
    clearTimeout(this.noticeTimer);
    this.noticeTimer = setTimeout(() => { $('notice').hidden = true; }, 6000);
  }

  /** Shows the recording of another page of taut beside this one: same instant, same camera, same colours. */
  async openBeside(file) {
    let recording;
    try {
      recording = await recordingOfPage(file);
    } catch (error) {
      return this.notify(error.message);
    }
    this.closeBeside();
    recording.file = file.name;
    this.showBeside(recording);
  }

  showBeside(recording) {
    const canvas = Object.assign(document.createElement('canvas'), {id: 'view2', tabIndex: 0});
    $('view').after(canvas);
    $('stage').classList.add('two');
    const view = new View(canvas, recording);
    this.pictures.push({view, recording});
    view.isMoved = true;  // by the first one
    view.onchange = () => this.copyCamera(1);
    this.view.onchange = () => this.copyCamera(0);
    view.applyTheme(this.view.theme);
    view.instances.showJoints($('joints').getAttribute('aria-pressed') === 'true');
    this.view.partner = view;
    this.setUpPicking(canvas, 1);
    this.names = this.namesOfPictures();
    this.names.forEach((name, side) => this.pictures[side].view.canvas.setAttribute('aria-label', `${name}: drag to orbit, click to select`));
    $('beside').textContent = 'Close the page beside';
    if (window.innerWidth <= 760 && !$('plots').hidden) this.toggle('curves');  // which would leave each half too low
    this.arrange();
  }

  /** What tells the pictures apart: file, scene and parameters. */
  namesOfPictures() {
    const own = /^(file|https?):$/.test(window.location.protocol) ? plainText(window.location.pathname.split('/').at(-1)) : '';
    const all = this.pictures.map(({recording}, side) => [recording.file ?? (side ? '' : own), factsOf(recording)].filter(Boolean).join(' · '));
    return all.map((name, side) => (all.indexOf(name) !== all.lastIndexOf(name) ? `${side + 1}: ${name}` : name));
  }

  closeBeside() {
    if (this.pictures.length < 2) return;
    const [{view}] = this.pictures.splice(1);
    view.dispose();
    view.canvas.remove();
    this.view.partner = null;
    $('stage').classList.remove('two');
    $('beside').textContent = 'Open a page beside…';
    this.arrange();
  }

  /** After a picture has come or gone. */
  arrange() {
    const [first, second] = this.pictures.map(({recording}) => makeScales(recording));
    this.scales = second ? commonScales(first, second) : first;
    Object.assign($('time'), {min: this.start, max: this.end});
    $('contacts').hidden = this.pictures.every(({recording}) => recording.contactTotal === 0);
    this.setUpPlots();
    this.setMode(this.state.mode);
    this.seek(this.state.t);
    for (const {view} of this.pictures) view.resize();
    this.home();
  }

  /** Both pictures are seen from the same place. */
  copyCamera(from) {
    const {view} = this.pictures[from] ?? this.pictures[0], other = this.pictures[1 - from]?.view;
    if (other && !this.isCopying) {
      this.isCopying = true;
      other.camera.position.copy(view.camera.position);
      other.controls.target.copy(view.controls.target);
      other.controls.update();
      this.isCopying = false;
    }
    this.request();
  }

  /** A press that does not move picks; a drag is the camera's. */
  setUpPicking(canvas, side) {
    let down = null;
    canvas.addEventListener('pointerdown', (event) => { down = event.button === 0 ? [event.clientX, event.clientY] : null; });
    canvas.addEventListener('pointerup', (event) => {
      if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 5) return;
      const {left, top} = canvas.getBoundingClientRect(), {view} = this.pictures[side];
      const tolerance = event.pointerType === 'mouse' ? 4 : 14;
      const found = view.pick(event.clientX - left, event.clientY - top, tolerance);
      if (found) found.at = view.pointOf(found);
      this.picked(this.inFirst(found, side));
    });
  }

  picked(found) {
    if (!this.isMeasuring) return this.select(found);
    if (!found) return;
    this.measured = [...(this.measured.length === 2 ? [] : this.measured), found.at];
    this.showMeasured();
    this.request(true);
  }

  setMeasuring(on) {
    this.isMeasuring = on;
    this.measured = [];
    $('measure').setAttribute('aria-pressed', on);
    $('view').style.cursor = on ? 'crosshair' : '';
    this.showMeasured();
    this.request(true);
  }

  /** What was measured, in each picture; or what to do for it. */
  showMeasured() {
    const box = $('measured');
    box.hidden = !this.isMeasuring;
    if (box.hidden) return;
    if (this.measured.length < 2) {
      box.textContent = this.measured.length ? 'Click the second point' : 'Click the first point';
      return;
    }
    box.textContent = this.pictures.map((picture, side) => {
      const [p, q] = this.measuredIn(side);
      return p && q ? `${withUnit(distance(p, q), 'm', 4)} (${p.map((x, i) => `${'xyz'[i]} ${withUnit(q[i] - x, 'm', 3)}`).join(', ')})` : '–';
    }).join(' | ');
  }

  /** A point of a body of the first recording, or what is selected in it, as the picture of that number has it; null if it has not. */
  inPicture(point, side) {
    if (side === 0 || !point) return point;
    const body = this.recording.bodies.name[point[0]], id = this.pictures[side].recording.bodies.name.indexOf(body);
    return id < 0 ? null : [id, ...point.slice(1)];
  }
  selectedIn(side) {
    const {selected} = this.state, {recording} = this.pictures[side];
    return selected && side > 0 ? counterpart(this.recording, recording, selected) : selected;
  }
  inFirst(found, side) {
    if (side === 0 || !found) return found;
    const {recording} = this.pictures[side], same = counterpart(recording, this.recording, found);
    const body = this.recording.bodies.name.indexOf(recording.bodies.name[found.at[0]]);
    return same && body >= 0 ? {...same, at: [body, ...found.at.slice(1)]} : null;
  }

  measuredIn(side) {
    const {view} = this.pictures[side];
    return this.measured.map((point) => this.inPicture(point, side)).filter(Boolean).map((point) => worldPoint(view.poses, ...point));
  }

  /** Draws where a point of a body [body, x, y, z] has been, or no longer does. */
  trace(point) {
    const same = ({point: other}) => other.every((x, i) => x === point[i]);
    if (this.traces.some(same)) this.traces = this.traces.filter((other) => !same(other));
    else this.traces.push({point, color: this.traces.reduce((most, {color}) => Math.max(most, color + 1), 0)});
    this.traced();
  }
  traced() {
    $('untrace').disabled = !this.traces.length;
    this.request(true);
  }

  /** Where a point was up to now, in a picture. */
  pathOf({point}, side) {
    const {recording: r, view} = this.pictures[side], own = this.inPicture(point, side), path = [];
    if (!own) return path;
    const {frame} = r.locate(this.state.t), every = Math.ceil(r.frames / kMostOfTrace);
    for (let f = 0; f <= frame; f += every) path.push(r.pointAt(f, own));
    path.push(worldPoint(view.poses, ...own));
    return path;
  }

  look(name) {
    this.view.follow(null);
    this.inspector.select(this.state.selected, null);
    this.showNumbers();
    this.view.preset(name);
    this.request(true);
  }

  setLoop(on) {
    this.state.loop = on;
    $('loop').setAttribute('aria-pressed', on);
    writeFlag('loop', on);
  }

  setRecording(on) {
    if (!on) return this.setPlaying(false);
    this.seek(this.start);
    this.setPlaying(false);
    this.video = new Video(this, () => this.setPlaying(true), () => {
      this.video = null;
      $('video').setAttribute('aria-pressed', false);
    });
    $('video').setAttribute('aria-pressed', true);
  }

  /** For files: the name of the scene, without what a file system might not like. */
  fileName() { return this.recording.scene.replace(/[^\p{L}\p{N} ._-]+/gu, '-').slice(0, 80) || 'taut'; }

  /** All curves, the selection's last: [{name, unit, values}]. */
  columns() {
    const {selectionPlot: own} = this;
    return [...scalarCurves(this.recording), ...(own.element.hidden ? [] : own.series.map(({name, values}) => ({name: `${own.title} ${name}`, unit: own.unit, values})))];
  }

  toggle(id) {
    const on = $(id).getAttribute('aria-pressed') !== 'true';
    $(id).setAttribute('aria-pressed', on);
    if (id === 'curves') $('plots').hidden = !on;
    if (id === 'joints') for (const {view} of this.pictures) view.instances.showJoints(on);
    if (id === 'contacts') this.state.contacts = on;
    this.request(true);
  }

  setMode(mode) {
    this.state.mode = mode;
    $('mode').value = mode;
    const scale = this.scales[mode], [title, bar, row, arrows] = $('legend').children;
    title.textContent = kModes[mode];
    bar.style.background = scale ? rampCss() : 'none';
    bar.hidden = !scale;
    row.replaceChildren(...(scale ? [0, 0.5, 1] : []).map((part) => {
      const item = document.createElement('span');
      const end = part === 1 ? '≥ ' : part === 0 && scale.kind === 'log' ? '≤ ' : '';
      item.textContent = end + (scale.kind === 'log' ? `${scale.value(part).toExponential(0)} ${scale.unit}`
        : withUnit(scale.value(part), scale.unit, 2));
      return item;
    }));
    arrows.hidden = this.pictures.every(({recording}) => recording.contactTotal === 0);
    const {most, high} = this.scales.contact, isCut = most > kLongestArrow * high;
    arrows.textContent = `Arrows: contact forces; the longest ${isCut ? '≥' : '≈'} ${withUnit(isCut ? kLongestArrow * high : most, 'N', 2)}`;
    this.request(true);
  }

  select(selected) {
    this.state.selected = selected;
    if (!selected && this.view.followed !== null) this.view.follow(null);
    this.inspector.select(selected, this.view.followed);
    this.plotSelection(selected);
    this.request(true);
  }

  plotSelection(selected) {
    const plot = this.selectionPlot;
    plot.element.hidden = !selected || (selected.kind === 'body' && selected.id === 0);
    if (plot.element.hidden) return;
    const [name, unit, at] = {joint: ['force', 'N', (r, id, f) => r.jointForce(f, id)], spring: ['tension', 'N', (r, id, f) => r.tensionOf(f, id)],
                              body: ['speed', 'm/s', (r, id, f) => r.bodySpeed(f, id)]}[selected.kind];
    plot.setTitle(nameOf(this.recording, selected));
    plot.unit = unit;
    plot.setSeries(this.pictures.flatMap(({recording: r}, side) => {
      const own = this.selectedIn(side), values = () => Float64Array.from({length: r.frames}, (_, f) => at(r, own.id, f));
      return own ? [{name, values: values(), ...(side ? {dashed: true, color: 0, times: r.times} : {})}] : [];
    }));
  }

  follow(body) {
    this.view.follow(body);
    this.inspector.select(this.state.selected, body);
    this.request(true);
  }

  home() {
    this.view.follow(null);
    this.inspector.select(this.state.selected, null);
    this.showNumbers();  // the view goes beside them
    this.view.home();
    this.request(true);
  }

  seek(t) {
    this.state.t = Math.min(Math.max(t, this.start), this.end);
    this.request(true);
  }

  step(frames) {
    this.setPlaying(false);
    const {recording: r, state} = this, frame = r.nearest(state.t) + frames;
    this.seek(r.times[Math.min(Math.max(frame, 0), r.frames - 1)]);
  }

  togglePlaying() { this.setPlaying(!this.state.playing); }

  setPlaying(playing) {
    if (playing && this.state.t >= this.end) this.state.t = this.start;
    if (!playing) this.video?.stop();
    this.state.playing = playing;
    document.documentElement.toggleAttribute('data-playing', playing);
    $('play').setAttribute('aria-label', playing ? 'Pause' : 'Play');
    this.last = performance.now();
    this.request(true);
  }

  /** Draws soon.  @param moved whether more than the camera changed */
  request(moved = false) {
    this.moved ||= moved;
    if (this.requested) return;
    this.requested = true;
    requestAnimationFrame((now) => {
      this.requested = false;
      this.draw(now);
    });
  }

  advance(now) {
    const {state} = this;
    state.t += Math.max(0, now - this.last) / 1000 * state.speed;
    this.last = now;
    this.moved = true;
    if (state.t < this.end) return;
    if (state.loop && !this.video && this.end > this.start) {
      state.t = this.start + (state.t - this.start) % (this.end - this.start);
    } else {
      state.t = this.end;
      this.setPlaying(false);
    }
  }

  draw(now) {
    const {state, pictures} = this;
    if (state.playing) this.advance(now);
    if (this.moved !== false) {
      pictures.forEach(({view}, side) => view.show(state.t, {...state, selected: this.selectedIn(side), scales: this.scales}));
      this.showNumbers();
      this.moved = false;
    }
    for (const {view} of pictures) view.render();
    const traced = (side) => this.traces.map((trace) => ({path: this.pathOf(trace, side), color: trace.color}));
    this.overlay.draw(pictures.map(({view}, side) => ({view, traces: traced(side), measured: this.measuredIn(side), name: this.names[side], pull: this.pulled?.(side)})), this.view.theme, {...this.covered(), ...this.inspector.covers()});
    this.placeLabel();
    this.video?.frame();
    if (state.playing) this.request();
  }

  showNumbers() {
    const {state} = this, {start, end} = this, digits = end - start < 10 ? 3 : 2;
    $('time').value = state.t;
    $('time').setAttribute('aria-valuetext', `${state.t.toFixed(digits)} s`);
    $('clock').textContent = `${state.t.toFixed(digits)} / ${end.toFixed(digits)} s`;
    const frame = this.recording.nearest(state.t);
    const [, other] = this.pictures, same = other && this.selectedIn(1);
    this.inspector.show(frame, this.view.poses, same && {...other, selected: same, frame: other.recording.nearest(state.t), poses: other.view.poses});
    this.showMeasured();
    if (!$('plots').hidden) for (const plot of this.plots) if (!plot.element.hidden) plot.show(state.t, frame);
  }

  placeLabel() {
    const {selected} = this.state, label = $('label');
    const at = selected && this.view.project(this.view.positionOf(selected));
    label.hidden = !at || !at.visible;
    if (label.hidden) return;
    label.textContent = nameOf(this.recording, selected);
    label.style.left = `${at.x}px`;
    label.style.top = `${at.y}px`;
  }
}

/** Units are written as in the catalogue, `kg` or `m/s`: no prefix is put before them. */
const parametersOf = ({parameters, parameterUnits: units}) => Object.entries(parameters).map(([key, value]) =>
  `${key} = ${units[key] === 'bool' ? value !== 0 : [value, units[key]].filter((part) => part !== undefined).join(' ')}`);
/** Of a part of an address; as it stands if it is no text that someone has encoded. */
const plainText = (part) => {
  try {
    return decodeURIComponent(part);
  } catch {
    return part;
  }
};
const factsOf = (recording) => [recording.scene, ...parametersOf(recording)].join(' · ');

/** The curves of a recording by their titles: [{title, unit, logarithmic, digits, series}]. */
export function curveGroups(r) {
  const all = scalarCurves(r), of = (group) => all.filter((scalar) => scalar.group === group), groups = [];
  const energy = of('energy').map(({name, values}) => ({name: kShort[name] ?? name, values}));
  if (energy.length === 2)
    energy.push({name: 'total', values: energy[0].values.map((value, f) => value + energy[1].values[f])});
  if (energy.length) groups.push({title: 'Energy', unit: 'J', digits: 3, series: energy});
  const gaps = of('gap').filter(({values}, i) => i === 0 || values.some((value) => value > 0));
  if (gaps.length && r.jointCount)
    groups.push({title: 'Largest gap', logarithmic: true, series: gaps.map(({unit, values}) => ({name: '', unit, values}))});
  const probes = new Map();
  for (const {name, unit, values} of of('probe')) {
    const dot = name.lastIndexOf('.'), stem = name.slice(0, dot);
    if (!probes.has(stem)) probes.set(stem, {title: stem, unit, series: []});
    const probe = probes.get(stem);
    if (probe.unit !== unit) delete probe.unit;  // each number has its own: an angle, and its rate
    probe.series.push({name: name.slice(dot + 1), unit, values});
  }
  return [...groups, ...probes.values()];
}

/** Energies, gaps and probes of a recording over its frames. */
function scalarCurves(r) {
  return r.scalars.map((scalar, index) => ({...scalar, values: Float64Array.from({length: r.frames}, (_, f) => r.scalar(f, index))}));
}

/** What has the same kind and name in another recording; null if nothing has. */
function counterpart(recording, other, selected) {
  const names = {body: other.bodies.name, joint: other.joints.name, spring: other.springs.map(({name}) => name)}[selected.kind];
  const id = names.indexOf(nameOf(recording, selected));
  return id < 0 ? null : {...selected, id};
}
