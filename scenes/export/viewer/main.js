// Puts the page together: time, selection, colours, curves.
import {rampCss, scales as makeScales} from './colors.js';
import {Recording} from './data.js';
import {setUpKeys} from './keys.js';
import {Inspector, nameOf, setUpFinder} from './panel.js';
import {Plot, withUnit} from './plots.js';
import {kLongestArrow, View} from './view.js';

const $ = (id) => document.getElementById(id);
const kShort = {'kinetic energy': 'kin.', 'potential energy': 'pot.'};
const kModes = {force: 'Joint force', gap: 'Joint gap', speed: 'Speed', body: 'Each body its colour'};

class Player {
  constructor(recording) {
    this.recording = recording;
    this.scales = makeScales(recording);
    this.view = new View($('view'), recording);
    this.state = {t: recording.start, playing: false, speed: 1, mode: recording.force.words || recording.tension.words ? 'force' : recording.jointCount ? 'speed' : 'body',
                  selected: null, joints: true, contacts: true};
    this.inspector = new Inspector($('inspector'), recording,
                                   {select: (s) => this.select(s), follow: (body) => this.follow(body)});
    this.find = setUpFinder($('finder'), recording, (selected) => this.select(selected));
    this.view.onchange = () => this.request();
    this.view.covered = () => this.inspector.covers();
    this.setUpTheme();
    this.setUpPlots();
    this.setUpControls();
    setUpKeys(this);
    this.setMode(this.state.mode);
    this.view.resize();  // the curves have taken their part of the height
    this.view.home();
    this.draw(performance.now());
  }

  setUpTheme() {
    const query = matchMedia('(prefers-color-scheme: dark)');
    this.setTheme(query.matches ? 'dark' : 'light');
    query.addEventListener('change', () => this.setTheme(query.matches ? 'dark' : 'light'));
  }

  setTheme(name) {
    document.documentElement.dataset.theme = name;
    this.view.applyTheme(name);
    this.plots?.forEach((plot) => plot.draw());
    this.request(true);
  }

  setUpPlots() {
    const r = this.recording, seek = (t) => this.seek(t);
    const column = (index) => Float64Array.from({length: r.frames}, (_, f) => r.scalar(f, index));
    const all = r.scalars.map((scalar, index) => ({...scalar, values: column(index)}));
    const of = (group) => all.filter((scalar) => scalar.group === group);
    this.plots = [];
    const add = (options, series) => {
      const plot = new Plot($('plots'), options, r.times, seek);
      plot.setSeries(series);
      this.plots.push(plot);
      return plot;
    };
    const energy = of('energy').map(({name, values}) => ({name: kShort[name] ?? name, values}));
    if (energy.length === 2)
      energy.push({name: 'total', values: energy[0].values.map((value, f) => value + energy[1].values[f])});
    if (energy.length) add({title: 'Energy', unit: 'J', digits: 3}, energy);
    const gaps = of('gap').filter(({values}, i) => i === 0 || values.some((value) => value > 0));
    if (gaps.length && r.jointCount) add({title: 'Largest gap', logarithmic: true}, gaps.map(({unit, values}) => ({name: `[${unit}]`, values})));
    this.selectionPlot = add({title: 'Selection'}, []);
    this.selectionPlot.element.hidden = true;
    const probes = new Map();
    for (const {name, unit, values} of of('probe')) {
      const dot = name.lastIndexOf('.'), stem = name.slice(0, dot);
      if (!probes.has(stem)) probes.set(stem, {unit, series: []});
      probes.get(stem).series.push({name: name.slice(dot + 1), values});
    }
    for (const [title, {unit, series}] of probes) add({title, unit}, series);
  }

  setUpControls() {
    const r = this.recording, moving = r.bodies.fixed.filter((fixed, i) => i > 0 && !fixed).length;
    const parameters = Object.entries(r.parameters).map(([key, value]) => `${key} = ${value}`);
    const counted = [[moving, 'body', 'bodies'], [r.jointCount, 'joint', 'joints'], ...(r.springCount ? [[r.springCount, 'spring', 'springs']] : [])];
    $('facts').textContent = [...parameters, ...counted.map(([count, one, many]) => `${count.toLocaleString('en')} ${count === 1 ? one : many}`)].join(' · ');
    const slider = $('time');
    Object.assign(slider, {min: r.start, max: r.end, value: r.start});
    slider.oninput = () => this.seek(Number(slider.value));
    $('play').onclick = () => this.setPlaying(!this.state.playing);
    $('back').onclick = () => this.step(-1);
    $('forward').onclick = () => this.step(1);
    $('speed').onchange = () => { this.state.speed = Number($('speed').value); };
    $('mode').onchange = () => this.setMode($('mode').value);
    $('find').onclick = this.find;
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
    this.setUpPicking($('view'));
    // The title ends where the buttons begin.
    new ResizeObserver(() => $('head').style.setProperty('--tools', `${$('tools').offsetWidth}px`)).observe($('tools'));
  }

  /** A press that does not move picks; a drag is the camera's. */
  setUpPicking(canvas) {
    let down = null;
    canvas.addEventListener('pointerdown', (event) => { down = event.button === 0 ? [event.clientX, event.clientY] : null; });
    canvas.addEventListener('pointerup', (event) => {
      if (!down || Math.hypot(event.clientX - down[0], event.clientY - down[1]) > 5) return;
      const {left, top} = canvas.getBoundingClientRect();
      const tolerance = event.pointerType === 'mouse' ? 4 : 14;
      this.select(this.view.pick(event.clientX - left, event.clientY - top, tolerance));
    });
  }

  toggle(id) {
    const on = $(id).getAttribute('aria-pressed') !== 'true';
    $(id).setAttribute('aria-pressed', on);
    if (id === 'curves') $('plots').hidden = !on;
    if (id === 'joints') this.view.instances.showJoints(on);
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
    arrows.hidden = $('contacts').hidden;
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
    const r = this.recording, plot = this.selectionPlot;
    plot.element.hidden = !selected || (selected.kind === 'body' && selected.id === 0);
    if (plot.element.hidden) return;
    const series = (name, at) => [{name, values: Float64Array.from({length: r.frames}, (_, f) => at(f))}];
    plot.setTitle(nameOf(r, selected));
    plot.unit = selected.kind === 'body' ? 'm/s' : 'N';
    plot.setSeries(selected.kind === 'joint' ? series('force', (f) => r.jointForce(f, selected.id))
      : selected.kind === 'spring' ? series('tension', (f) => r.tensionOf(f, selected.id))
        : series('speed', (f) => r.bodySpeed(f, selected.id)));
  }

  follow(body) {
    this.view.follow(body);
    this.inspector.select(this.state.selected, body);
    this.request(true);
  }

  home() {
    this.view.follow(null);
    this.inspector.select(this.state.selected, null);
    this.showNumbers(this.recording.nearest(this.state.t));  // the view goes beside them
    this.view.home();
    this.request(true);
  }

  seek(t) {
    this.state.t = Math.min(Math.max(t, this.recording.start), this.recording.end);
    this.request(true);
  }

  step(frames) {
    this.setPlaying(false);
    const {recording: r, state} = this, frame = r.nearest(state.t) + frames;
    this.seek(r.times[Math.min(Math.max(frame, 0), r.frames - 1)]);
  }

  setPlaying(playing) {
    if (playing && this.state.t >= this.recording.end) this.state.t = this.recording.start;
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

  draw(now) {
    const {state, recording: r, view} = this;
    if (state.playing) {
      state.t += Math.max(0, now - this.last) / 1000 * state.speed;
      this.last = now;
      if (state.t >= r.end) {
        state.t = r.end;
        this.setPlaying(false);
      }
      this.moved = true;
    }
    if (this.moved !== false) {
      view.show(state.t, {...state, scales: this.scales});
      this.showNumbers(r.nearest(state.t));
      this.moved = false;
    }
    view.render();
    this.placeLabel();
    if (state.playing) this.request();
  }

  showNumbers(frame) {
    const {state, recording: r} = this, digits = r.end - r.start < 10 ? 3 : 2;
    $('time').value = state.t;
    $('time').setAttribute('aria-valuetext', `${state.t.toFixed(digits)} s`);
    $('clock').textContent = `${state.t.toFixed(digits)} / ${r.end.toFixed(digits)} s`;
    this.inspector.show(frame, this.view.poses);
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

/** Starts the page.  @param {ArrayBuffer} data  @returns the player, for scripts and tests */
export async function start(data) {
  return new Player(new Recording(data));
}
