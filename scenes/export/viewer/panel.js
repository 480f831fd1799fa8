// Numbers of what is selected, and finding things by name.
import {worldPoint} from './instances.js';
import {format, withUnit} from './plots.js';

/** Rows of a vector; what is round-off beside the largest component is 0.  The page has three digits of a force. */
function vectorRows(name, values, unit, digits = 3) {
  const most = Math.max(...values.map(Math.abs));
  return values.map((value, i) => [`${name} ${'xyz'[i]}`, withUnit(Math.abs(value) < 1e-6 * most ? 0 : value, unit, digits)]);
}

/** Whether a joint's number is ever anything but 0. */
const isUsed = (recording, column, width, joint) => {
  if (!column.words) return false;
  for (let f = 0; f < recording.frames; ++f)
    for (let i = 0; i < width; ++i)
      if (column.at(width * (f * recording.jointCount + joint) + i) !== 0) return true;
  return false;
};

/** How many contacts a body has, and what they push it with together. */
function contactRows(contacts, id) {
  const sum = [0, 0, 0];
  for (const {b, force} of contacts) force.forEach((value, i) => { sum[i] += b === id ? value : -value; });
  return [['contacts', String(contacts.length)], ['contact force', withUnit(Math.hypot(...sum), 'N', 4)]];
}

/** [[name, text], ...] of a body, joint or spring at a frame. */
export function numbers(recording, {kind, id}, frame, poses, used) {
  const r = recording;
  if (kind === 'joint') {
    if (!r.isAttached(frame, id)) return [['state', 'broken or detached']];
    const rows = [['force', withUnit(r.jointForce(frame, id), 'N')],
                  ...vectorRows('force', r.jointVector(r.force, frame, id), 'N')];
    if (used.torque) rows.push(...vectorRows('torque', r.jointVector(r.torque, frame, id), 'N·m'));
    rows.push(['gap', withUnit(r.jointGap(frame, id), 'm')]);
    if (used.angle) rows.push(['gap angle', withUnit(r.jointGapAngle(frame, id), 'rad')]);
    return rows;
  }
  if (kind === 'spring') {
    const [p, q] = r.springs[id].course.map((end) => worldPoint(poses, ...end));
    return [['tension', withUnit(r.tensionOf(frame, id), 'N')],
            ['length', withUnit(Math.hypot(...p.map((x, i) => q[i] - x)), 'm', 4)]];
  }
  const at = poses.subarray(7 * id, 7 * id + 7), angle = 2 * Math.acos(Math.min(1, Math.abs(at[6])));
  const most = r.jointsOfBody[id].reduce((sum, joint) => Math.max(sum, r.jointForce(frame, joint)), 0);
  const rows = [];
  if (!r.bodies.fixed[id])
    rows.push(['mass', `${format(r.bodies.mass[id])} kg`], ['speed', withUnit(r.bodySpeed(frame, id), 'm/s')]);
  rows.push(...vectorRows('position', [...at.subarray(0, 3)], 'm', 4), ['turned by', `${format(angle * 180 / Math.PI)}°`]);
  if (r.jointsOfBody[id].length) rows.push(['largest joint force', withUnit(most, 'N')]);
  if (r.contactTotal) rows.push(...contactRows(r.contacts(frame).filter(({a, b}) => a === id || b === id), id));
  return rows;
}

export const nameOf = (recording, {kind, id}) => (kind === 'spring' ? recording.springs[id].name
  : (kind === 'body' ? recording.bodies : recording.joints).name[id]);

export class Inspector {
  /** @param actions {select, follow, trace} */
  constructor(element, recording, actions) {
    Object.assign(this, {element, recording, actions});
  }

  select(selected, followed) {
    this.selected = selected;
    this.element.hidden = !selected;
    if (!selected) return;
    const {recording: r} = this, {kind, id} = selected, make = (tag, text = '', parent = this.element) => {
      const node = document.createElement(tag);
      node.textContent = text;
      parent.append(node);
      return node;
    };
    this.element.replaceChildren();
    const head = make('h2', nameOf(r, selected));
    make('small', kind === 'spring' ? r.springs[id].type : kind === 'joint' ? `${r.joints.type[id]} joint` : r.bodies.fixed[id] ? 'fixed body' : 'body', head);
    const close = make('button', '✕');
    close.className = 'close';
    close.setAttribute('aria-label', 'Select nothing');
    close.onclick = () => this.actions.select(null);
    this.list = make('dl');
    this.used = kind === 'joint' ? {torque: !r.course.has(id) && isUsed(r, r.torque, 3, id), angle: isUsed(r, r.gap_angle, 1, id)} : {};
    if (kind === 'body' && id !== 0) {
      const row = make('div');
      row.className = 'actions';
      const follow = make('button', followed === id ? 'Following' : 'Follow', row);
      follow.id = 'follow';
      follow.setAttribute('aria-pressed', followed === id);
      follow.title = 'Keep it where it is in the view (F)';
      follow.onclick = () => this.actions.follow(followed === id ? null : id);
      const trace = (text, title, point) => {
        const button = make('button', text, row);
        button.title = title;
        button.onclick = () => this.actions.trace(point);
      };
      trace('Trace centre', 'Draw where its centre of mass has been (P)', [id, 0, 0, 0]);
      if (selected.at) trace('Trace point', 'Draw where the point that was clicked has been', selected.at);
    }
    const links = make('div');
    links.className = 'links';
    const others = kind === 'spring' ? r.springs[id].course.map(([body]) => ['body', body])
      : kind === 'joint' ? [['body', r.joints.a[id]], ['body', r.joints.b[id]]]
        : r.jointsOfBody[id].slice(0, 60).map((joint) => ['joint', joint]);
    for (const [otherKind, other] of others) {
      const link = make('button', nameOf(r, {kind: otherKind, id: other}), links);
      link.onclick = () => this.actions.select({kind: otherKind, id: other});
    }
  }

  /** How much of the view it takes [px]: at the right, or on a phone at the bottom. */
  covers() {
    if (this.element.hidden) return {right: 0, bottom: 0};
    const own = this.element.getBoundingClientRect(), all = this.element.parentElement.getBoundingClientRect();
    return own.width > 0.9 * all.width ? {right: 0, bottom: all.bottom - own.top} : {right: all.right - own.left, bottom: 0};
  }

  /** @param other the same thing in a second recording, whose numbers come behind a bar: {recording, selected, frame, poses} or null */
  show(frame, poses, other) {
    if (!this.selected) return;
    const others = new Map(other ? numbers(other.recording, other.selected, other.frame, other.poses, this.used) : []);
    const cells = numbers(this.recording, this.selected, frame, poses, this.used).flatMap(([name, text]) => {
      const dt = document.createElement('dt'), dd = document.createElement('dd');
      dt.textContent = name;
      dd.textContent = other ? `${text} | ${others.get(name) ?? '–'}` : text;
      return [dt, dd];
    });
    this.list.replaceChildren(...cells);
  }
}

const kindOf = (recording, {kind, id}) => (kind === 'joint' ? recording.joints.type[id]
  : kind === 'spring' ? recording.springs[id].type : 'body');

/** The dialog that finds bodies, joints and springs whose name contains what is typed. */
export function setUpFinder(dialog, recording, select) {
  const input = dialog.querySelector('input'), list = dialog.querySelector('ul');
  const all = [...recording.bodies.name.map((name, id) => ({kind: 'body', id, name})),
               ...recording.joints.name.map((name, id) => ({kind: 'joint', id, name})),
               ...recording.springs.map(({name}, id) => ({kind: 'spring', id, name}))];
  const choose = (item) => {
    dialog.close();
    select({kind: item.kind, id: item.id});
  };
  let found = [];
  const search = () => {
    const text = input.value.trim().toLowerCase();
    found = all.filter(({name}) => name.toLowerCase().includes(text))
      .sort((a, b) => (b.name.toLowerCase() === text) - (a.name.toLowerCase() === text)).slice(0, 8);
    if (!found.length) return list.replaceChildren(Object.assign(document.createElement('li'), {textContent: 'No name has this in it.'}));
    list.replaceChildren(...found.map((item) => {
      const row = document.createElement('li'), button = document.createElement('button');
      const kind = document.createElement('small');
      kind.textContent = kindOf(recording, item);
      button.textContent = item.name;
      button.append(kind);
      button.onclick = () => choose(item);
      row.append(button);
      return row;
    }));
  };
  input.oninput = search;
  input.onkeydown = (event) => {
    if (event.key === 'Escape') {  // which would only empty the field
      event.preventDefault();
      return dialog.close();
    }
    if (event.key !== 'Enter' || !found.length) return;
    event.preventDefault();
    choose(found[0]);
  };
  return () => {
    input.value = '';
    search();
    dialog.showModal();
    input.focus();
  };
}
