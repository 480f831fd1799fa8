// A second page of taut beside the first: its recording, and the scales and curves of both.
import {Scale} from './colors.js';
import {Recording} from './data.js';

/** The recording inside a page of taut.  @throws Error if there is none, or it is damaged */
export async function recordingOfPage(file) {
  const found = (await file.text()).match(/<script type="application\/octet-stream" id="recording">([A-Za-z0-9+/=\s]*)<\/script>/);
  if (!found) throw new Error(`${file.name} is no page of taut`);
  try {
    const bytes = Uint8Array.from(atob(found[1]), (c) => c.charCodeAt(0));
    return new Recording(await new Response(new Blob([bytes]).stream().pipeThrough(new DecompressionStream('deflate'))).arrayBuffer());
  } catch (error) {
    throw new Error(`${file.name} cannot be read: ${error.message || error}`);
  }
}

/** Scales that hold the values of both, so that equal colours and arrows are equal numbers. */
export function commonScales(a, b) {
  const wider = (p, q) => new Scale(Math.min(p.low, q.low), Math.max(p.high, q.high), p.unit, p.kind);
  const all = Object.fromEntries(Object.keys(a).map((name) => [name, wider(a[name], b[name])]));
  all.gap.low = all.gap.high * 1e-4;
  all.contact.most = Math.max(a.contact.most, b.contact.most);
  return all;
}

/** The groups of curves of a recording and of another one, whose curves are dashed and keep their own times. */
export function commonCurves(own, others) {
  const dashed = ({series}) => series.map((one, s) => ({...one, dashed: true, color: s, times: others.times}));
  const found = own.map((group) => {
    const same = others.groups.find(({title}) => title === group.title);
    return same ? {...group, series: [...group.series, ...dashed(same)]} : group;
  });
  return [...found, ...others.groups.filter(({title}) => !own.some((group) => group.title === title)).map((group) => ({...group, series: dashed(group)}))];
}
