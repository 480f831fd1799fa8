// What is drawn of forces in a real browser: ropes and wires with their colours, contacts as arrows.
import assert from 'node:assert/strict';
import {execFileSync} from 'node:child_process';
import path from 'node:path';
import {after, before, test} from 'node:test';
import {folder, heading, launch, open, picture, project, rampColor, runScene, scrub, settle, taut} from './browser.mjs';
import {add, course, dot, norm, readRecording, springEnds, sub, unit} from './recording.mjs';

let browser;
before(async () => { browser = await launch(); });
after(() => browser?.close());

const wires = ({header}) => header.joints.flatMap((joint, j) => (joint.course ? [j] : []));
/** Middles of the sections of a rod, rope or wire that are longer than the marks at their ends. */
const middles = (recording, frame, j) => course(recording, frame, j).flatMap((end, i, points) => {
  const from = points[i - 1];
  return i && norm(sub(end, from)) > 0.5 ? [add(from, sub(end, from).map((x) => x / 2))] : [];
});

for (const [name, args] of [['crane', ['--time', '3']],
                            ['suspension-bridge', ['--set', 'n=6', '--set', 'strength=4', '--set', 'load=3000', '--set', 'speed=6', '--time', '1']]])
  test(`${name}: ropes and wires are drawn from end to end, have their colour and name, and are gone when broken`, async () => {
    const files = runScene(name, ...args), recording = readRecording(files.recording), {frames, header} = recording;
    const {page, complaints} = await open(browser, files.page);
    const top = await page.evaluate(() => window.taut.scales.force.high), all = wires(recording);
    assert.equal(all.length, name === 'crane' ? 2 : 5);
    let hits = 0, sections = 0, broken = 0;
    const torn = frames.find((frame) => all.filter((j) => !frame.attached(j)).length >= 2);
    for (const frame of [frames[8], torn ?? frames.at(-1)]) {
      await scrub(page, frame.time);
      for (const j of all)
        for (const middle of middles(recording, frame, j)) {
          const at = await project(page, middle);
          await page.mouse.click(at.x, at.y);
          const hit = await page.locator('#inspector').isHidden() ? null : await heading(page);
          await page.keyboard.press('Escape');
          await settle(page);
          if (!frame.attached(j)) {
            assert.notEqual(hit, header.joints[j].name);
            ++broken;
            continue;
          }
          ++sections;
          if (hit !== header.joints[j].name) continue;
          ++hits;
          const linear = await page.evaluate((id) => window.taut.view.instances.colorOf('joint', id), j);
          const color = linear.map((c) => 255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055));
          rampColor(Math.sqrt(norm(frame.force(j)) / top)).forEach((c, i) => assert.ok(Math.abs(c - color[i]) < 3, `${color}`));
          // The line itself is seen, and nothing of it beside it.
          const seen = await picture(page), close = [-1, 0, 1].flatMap((dx) => [-1, 0, 1].map((dy) => seen.at(at.x + dx, at.y + dy)));
          assert.ok(close.some((pixel) => dot(unit(pixel), unit(color)) > 0.95), `${close} instead of ${color}`);
        }
    }
    assert.ok(sections >= 4 && hits === sections, `${hits} of ${sections} sections are hit`);
    assert.equal(broken > 0, name !== 'crane');
    assert.deepEqual(complaints, []);
    await page.close();
  });

/** The colour as a screen has it of a spring's tension, by the scale of the page. */
async function springColor(page, id) {
  const linear = await page.evaluate((i) => window.taut.view.instances.colorOf('spring', i), id);
  return linear.map((c) => 255 * (c <= 0.0031308 ? 12.92 * c : 1.055 * c ** (1 / 2.4) - 0.055));
}

test('springs are drawn from end to end, have name, length, tension and its colour', async () => {
  const scene = new URL('../../../../scenes/examples/spring_mass.json', import.meta.url).pathname;
  const files = runScene(scene, '--time', '2'), recording = readRecording(files.recording), {frames, header} = recording;
  assert.deepEqual(header.springs.map(({name, type}) => [name, type]), [['spring_0', 'spring'], ['spring_1', 'spring']]);
  const {page, complaints} = await open(browser, files.page, {hasTouch: true});
  const top = await page.evaluate(() => window.taut.scales.force.high);
  // Relaxed at 0.85 m by 1 kN/m with 8 N s/m, on a guide: Hooke's law and the damper's by hand.
  for (const frame of [frames[9], frames[70], frames.at(-1)]) {
    const [from, to] = springEnds(recording, frame, 0), expected = 1000 * (norm(sub(to, from)) - 0.85) - 8 * frame.velocity(2)[2];
    assert.ok(Math.abs(frame.tension(0) - expected) < 2e-3, `${frame.tension(0)} N instead of ${expected} N`);
  }
  const row = (name) => page.locator('#inspector dl').evaluate(
    (list, wanted) => [...list.children].find((node) => node.textContent === wanted).nextElementSibling.textContent, name);
  for (const frame of [frames[20], frames[77]]) {
    await scrub(page, frame.time);
    for (const s of [0, 1]) {
      const [from, to] = springEnds(recording, frame, s), middle = add(from, sub(to, from).map((x) => x / 2));
      // The ends of a coil are on its axis; its middle is around it, where a finger's width is allowed.
      for (const place of [add(from, sub(to, from).map((x) => 0.95 * x)), middle]) {
        const at = await project(page, place), seen = await picture(page), color = await springColor(page, s);
        rampColor(Math.sqrt(Math.abs(frame.tension(s)) / top)).forEach((c, i) => assert.ok(Math.abs(c - color[i]) < 3, `${color}`));
        const around = Array.from({length: 21 * 9}, (_, i) => seen.at(at.x - 10 + i % 21, at.y - 4 + Math.floor(i / 21)));
        assert.ok(around.some((pixel) => dot(unit(pixel), unit(color)) > 0.97), `nothing like ${color}`);
        await page.evaluate(() => window.taut.select(null));
        await page.touchscreen.tap(at.x, at.y);
        await settle(page);
        assert.equal(await heading(page), header.springs[s].name);
        assert.ok(Math.abs(parseFloat((await row('tension')).replace('−', '-')) - frame.tension(s)) <= 7e-3 * Math.abs(frame.tension(s)));
        assert.ok(Math.abs(parseFloat(await row('length')) / norm(sub(to, from)) - 1) < 2e-3 || /mm/.test(await row('length')));
        await page.evaluate(() => window.taut.select(null));
        await settle(page);
      }
    }
  }
  await page.keyboard.press('/');
  await page.keyboard.type('spring_1');
  await page.keyboard.press('Enter');
  assert.equal(await heading(page), 'spring_1');
  const plot = await page.evaluate(() => window.taut.selectionPlot.series[0]);
  assert.equal(plot.name, 'tension');
  await page.keyboard.press('j');
  assert.ok(await page.evaluate(() => window.taut.view.instances.springMeshes.every((mesh) => !mesh.visible)));
  assert.deepEqual(complaints, []);
  await page.close();
});

test('a damper is not drawn as a spring, and its colour is that of its force when it pushes too', async () => {
  const file = path.join(folder, 'sample.taut'), html = path.join(folder, 'sample.html');
  execFileSync(process.env.TAUT_SAMPLE, [file]);
  taut('replay', file, '--html', html, '--quiet');
  const {page, complaints} = await open(browser, html), recording = readRecording(file), top = await page.evaluate(() => window.taut.scales.force.high);
  const pushing = recording.frames[0], pulling = recording.frames[29];
  assert.ok(pushing.tension(1) < 0 && pulling.tension(1) > 0);
  for (const frame of [pushing, pulling]) {
    await scrub(page, frame.time);
    const [from, to] = springEnds(recording, frame, 1), at = await project(page, add(from, sub(to, from).map((x) => x / 2)));
    const color = await springColor(page, 1);
    rampColor(Math.sqrt(Math.abs(frame.tension(1)) / top)).forEach((c, i) => assert.ok(Math.abs(c - color[i]) < 3, `${color}`));
    await page.mouse.click(at.x, at.y);
    await settle(page);
    assert.equal(await page.locator('#inspector h2').textContent(), 'damper_1damper');
    assert.match(await page.locator('#inspector dl').textContent(), frame === pushing ? /tension−5 N/ : /tension4.6\d N/);
    await page.keyboard.press('Escape');
  }
  assert.deepEqual(complaints, []);
  await page.close();
});

test('contact forces of a stack are those of the recording and carry its weight', async () => {
  const n = 5, files = runScene('stack', '--set', `n=${n}`, '--time', '0.5'), recording = readRecording(files.recording);
  const {page, complaints} = await open(browser, files.page), frame = recording.frames.at(-1);
  await scrub(page, frame.time);
  const shownContacts = await page.evaluate(() => {
    const {recording: r} = window.taut;
    return Array.from({length: r.frames}, (_, f) => r.contacts(f));
  });
  // Places are on a grid over the box around all of them, forces have 9 significant bits of the largest or more.
  let most = 0;
  recording.frames.forEach(({contacts}) => contacts.forEach(({force}) => { most = Math.max(most, norm([...force])); }));
  recording.frames.forEach(({contacts}, f) => {
    assert.equal(contacts.length, shownContacts[f].length);
    contacts.forEach(({a, b, position, force}, c) => {
      const own = shownContacts[f][c];
      assert.deepEqual([own.a, own.b], [a, b]);
      assert.ok(norm(sub(own.position, [...position])) < n / 65535);
      own.force.forEach((x, i) => assert.ok(Math.abs(x - force[i]) <= 2 ** -9 * Math.abs(force[i]) + 2 ** -14 * most));
    });
  });
  // What every box rests on carries what is above it: density 1000 kg/m³, cubes of 1 m.
  for (let level = 0; level < n; ++level) {
    const sum = shownContacts.at(-1).filter(({a, b}) => Math.min(a, b) === level && Math.max(a, b) === level + 1)
      .reduce((total, {b, force}) => total + (b === level + 1 ? force[2] : -force[2]), 0);
    const weight = (n - level) * 1000 * 9.81;
    assert.ok(Math.abs(sum / weight - 1) < 3e-3, `${sum} N under box ${level} instead of ${weight} N`);
  }
  // The largest arrow is drawn as long as the legend says.
  assert.match(await page.locator('#legend small').textContent(), /contact forces/);
  const drawn = await page.evaluate(() => {
    const {arrows} = window.taut.view, [shaft] = arrows.root.children, m = shaft.instanceMatrix.array;
    return Array.from({length: shaft.count}, (_, i) => [12, 13, 14, 8, 9, 10].map((k) => m[16 * i + k]));
  });
  const {reach, high} = await page.evaluate(() => ({reach: window.taut.view.reach, high: window.taut.scales.contact.high}));
  assert.equal(drawn.length, frame.contacts.length);
  const up = drawn.filter(([, , z]) => Math.abs(z) < 0.01).reduce((total, arrow) => total + arrow[5], 0) / reach * high;
  assert.ok(Math.abs(up / (n * 9810) - 1) < 3e-3, `${up} N in arrows instead of ${n * 9810} N`);
  assert.deepEqual(complaints, []);
  await page.close();
});
