// What the address of a page says after #: autoplay, loop, speed=2, t=1.5, view=top, colour=gap, theme=dark.
const kFlags = ['autoplay', 'loop'];

export function readOptions() {
  const given = new URLSearchParams(window.location.hash.slice(1)), options = {};
  for (const flag of kFlags) options[flag] = given.has(flag) && given.get(flag) !== '0';
  for (const name of ['speed', 't']) {
    const value = Number.parseFloat(given.get(name));
    if (Number.isFinite(value)) options[name] = value;
  }
  for (const name of ['view', 'colour', 'theme']) if (given.get(name)) options[name] = given.get(name);
  return options;
}

/** Puts a flag into the address, or takes it away: whoever opens it again gets the same. */
export function writeFlag(name, on) {
  const kept = window.location.hash.slice(1).split('&').filter((part) => part && part.split('=')[0] !== name);
  try {
    window.history.replaceState(window.history.state, '', `#${[...kept, ...(on ? [name] : [])].join('&')}`);
  } catch {
    // A page inside a notebook has no address of its own.
  }
}
