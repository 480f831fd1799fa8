// The keyboard does what the mouse does.
const kOrbit = {ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1]};

/** What each key does; called with whether shift is held. */
function actions(player) {
  const {state, view, recording} = player, select = (id) => document.getElementById(id);
  const cycle = (id, step) => {
    const box = select(id);
    box.selectedIndex = Math.min(Math.max(box.selectedIndex + step, 0), box.length - 1);
    box.onchange();
  };
  const neighbour = (kind, step) => {
    const count = kind === 'body' ? recording.bodyCount : recording.jointCount, first = kind === 'body' ? 1 : 0;
    if (count <= first) return;
    const from = state.selected?.kind === kind ? state.selected.id : step > 0 ? first - 1 : count;
    player.select({kind, id: from + step < first ? count - 1 : from + step >= count ? first : from + step});
  };
  return {
    ' ': () => player.togglePlaying(),
    ArrowLeft: (shift) => player.step(shift ? -10 : -1),
    ArrowRight: (shift) => player.step(shift ? 10 : 1),
    Home: () => player.seek(player.start),
    End: () => player.seek(player.end),
    '+': () => cycle('speed', 1),
    '=': () => cycle('speed', 1),
    '-': () => cycle('speed', -1),
    c: () => {
      const box = select('mode');
      box.selectedIndex = (box.selectedIndex + 1) % box.length;
      box.onchange();
    },
    '[': () => neighbour('body', -1),
    ']': () => neighbour('body', 1),
    '{': () => neighbour('joint', -1),
    '}': () => neighbour('joint', 1),
    '/': () => player.find(),
    f: () => {
      if (state.selected?.kind === 'body') player.follow(view.followed === null ? state.selected.id : null);
    },
    Escape: () => (player.isMeasuring ? player.setMeasuring(false) : player.select(null)),
    1: () => player.look('front'),
    2: () => player.look('side'),
    3: () => player.look('top'),
    4: () => player.look('isometric'),
    l: () => player.setLoop(!state.loop),
    m: () => player.setMeasuring(!player.isMeasuring),
    p: () => {
      if (state.selected?.kind === 'body' && state.selected.id > 0) player.trace([state.selected.id, 0, 0, 0]);
    },
    j: () => player.toggle('joints'),
    x: () => player.toggle('contacts'),
    g: () => player.toggle('curves'),
    r: () => player.home(),
    t: () => select('theme').click(),
    '?': () => select('keys').showModal(),
  };
}

/** Turns the camera about what it looks at. */
function orbit(player, [x, y]) {
  const {camera, controls, up} = player.view, offset = camera.position.clone().sub(controls.target);
  offset.applyAxisAngle(up, 0.1 * x);
  const side = up.clone().cross(offset).normalize(), raised = offset.clone().applyAxisAngle(side, 0.08 * y);
  if (Math.abs(raised.clone().normalize().dot(up)) < 0.98) offset.copy(raised);
  camera.position.copy(controls.target).add(offset);
  player.view.isMoved = true;
  controls.update();
  player.request();
}

export function setUpKeys(player) {
  const keys = actions(player);
  document.addEventListener('keydown', (event) => {
    if (event.ctrlKey || event.metaKey || document.querySelector('dialog[open]')) return;
    if (event.altKey) {
      if (!kOrbit[event.key]) return;
      event.preventDefault();
      return orbit(player, kOrbit[event.key]);
    }
    const tag = event.target.tagName;
    if (tag === 'SELECT' && event.key !== 'Escape') return;  // keys choose in it
    if (tag === 'BUTTON' && event.key === ' ') return;       // space presses it
    if (tag === 'INPUT' && event.key.startsWith('Arrow')) event.target.blur();
    const action = keys[event.key] ?? keys[event.key.toLowerCase()];
    if (!action) return;
    event.preventDefault();
    action(event.shiftKey);
  });
}
