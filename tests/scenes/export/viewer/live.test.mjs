// A run that is watched and driven in a real browser while it goes on; what is not its page is turned away.
import assert from 'node:assert/strict';
import {execFileSync, spawn} from 'node:child_process';
import fs from 'node:fs';
import http from 'node:http';
import net from 'node:net';
import os from 'node:os';
import path from 'node:path';
import {after, before, test} from 'node:test';
import {folder, launch, open, project, settle} from './browser.mjs';
import {norm, readRecording, sub} from './recording.mjs';

// A ball that floats, a block that is fixed, and a wheel with a motor.
const scene = path.join(folder, 'live.json');
fs.writeFileSync(scene, JSON.stringify({
  format: 'taut-scene/1', name: 'live', dt: 0.002, duration: 1, gravity: [0, 0, 0], settings: {contacts: false},
  bodies: [
    {name: 'ball', density: 1000, shape: {type: 'sphere', radius: 0.15}, position: [0, 0, 0]},
    {name: 'wheel', density: 1000, shape: {type: 'box', size: [0.4, 0.1, 0.1]}, position: [1, 0, 0]},
    {name: 'block', fixed: true, density: 1000, shape: {type: 'box', size: [0.2, 0.2, 0.2]}, position: [-1, 0, 0]},
  ],
  joints: [{name: 'axle', type: 'hinge', a: 'ground', b: 'wheel', anchor: [1, 0, 0], axis: [0, 1, 0], axes: {angle: {motor: {velocity: 1}}}}],
}));

const running = new Set();
/** Starts a run and waits for the address of its page. */
async function start(...args) {
  const child = spawn(process.env.TAUT_PROGRAM, ['run', ...args], {stdio: ['ignore', 'pipe', 'pipe']});
  const run = {child, said: '', ended: new Promise((done) => { child.on('exit', (code, signal) => done({code, signal})); })};
  running.add(child);
  child.on('exit', () => running.delete(child));
  child.stdout.on('data', (data) => { run.said += data; });
  run.url = await new Promise((done, fail) => {
    child.stderr.on('data', (data) => {
      run.said += data;
      const found = run.said.match(/live at (http:\S+) /);
      if (found) done(found[1]);
    });
    child.on('exit', () => fail(new Error(run.said)));
  });
  return run;
}
const stop = async (run) => {
  run.child.kill('SIGINT');
  return run.ended;
};
/** Status and body of a request; a status of 0: the connection was closed without a word. */
const ask = (url, headers = {}) => new Promise((done) => {
  const request = http.get(url, {headers}, (answer) => {
    let text = '';
    answer.on('data', (data) => { text += data; });
    answer.on('end', () => done({status: answer.statusCode, text}));
  });
  request.on('upgrade', (answer, socket) => {
    socket.destroy();
    done({status: answer.statusCode, text: ''});
  });
  request.on('error', () => done({status: 0, text: ''}));
});
const kUpgrade = {Connection: 'Upgrade', Upgrade: 'websocket', 'Sec-WebSocket-Version': '13', 'Sec-WebSocket-Key': 'dGhlIHNhbXBsZSBub25jZQ=='};

const live = (page) => page.evaluate(() => ({...window.taut.recording.live, time: window.taut.recording.end, frames: window.taut.recording.frames}));
const until = (page, condition, value) => page.waitForFunction(condition, value);
const placeOf = (page, body) => page.evaluate((id) => Array.from(window.taut.view.poses.slice(7 * id, 7 * id + 3)), body);

/** Nothing acts on the ball: over a second its velocity is the same. */
async function moveFreely(page) {
  const from = await page.evaluate(() => window.taut.recording.frames && window.taut.recording.end);
  await until(page, (t) => window.taut.recording.end > t + 1.2, from);
  const places = await page.evaluate((t) => {
    const {recording: r} = window.taut;
    return [0.2, 0.6, 1].map((later) => {
      const f = r.nearest(t + later);
      return [r.times[f], r.pointAt(f, [1, 0, 0, 0])];
    });
  }, from);
  const velocity = (k) => sub(places[k + 1][1], places[k][1]).map((x) => x / (places[k + 1][0] - places[k][0]));
  assert.ok(norm(sub(velocity(0), velocity(1))) < 1e-3 + 1e-3 * norm(velocity(0)), `${velocity(0)}, then ${velocity(1)} m/s`);
}

let browser;
before(async () => { browser = await launch(); });
after(async () => {
  for (const child of running) child.kill('SIGKILL');
  await browser?.close();
});

test('waits for a page, shows the frames of the run, pauses, goes on, and takes single steps', async () => {
  const run = await start(scene, '--live'), {page, complaints} = await open(browser, run.url);
  await until(page, () => window.taut.recording.end > 0.3);
  assert.ok((await live(page)).frames > 5);
  assert.ok(await page.evaluate(() => window.taut.recording.times[1]) < 0.2, 'it began without a page');
  // Simulated time goes as the clock does.
  const [from, clock] = [(await live(page)).time, Date.now()];
  await page.waitForTimeout(2500);
  const rate = ((await live(page)).time - from) / (Date.now() - clock) * 1000;
  assert.ok(rate > 0.05 && rate < 1.3, `${rate}`);  // a machine that is busy with others may be slower

  await page.click('#play');
  await until(page, () => window.taut.recording.live.paused);
  await page.waitForTimeout(300);
  const paused = await live(page);
  await page.waitForTimeout(500);
  assert.deepEqual(await live(page), paused);
  assert.match(await page.locator('#run').textContent(), /^paused · step/);
  for (let k = 1; k <= 3; ++k) {
    await page.click('#forward');
    await until(page, (steps) => window.taut.recording.live.steps >= steps, paused.steps + k);
    await page.waitForTimeout(150);
    const now = await live(page);
    assert.equal(now.steps, paused.steps + k);
    assert.ok(Math.abs(now.time - paused.time - 0.002 * k) < 1e-9, `${now.time}`);
  }
  await page.click('#play');
  await until(page, (steps) => window.taut.recording.live.steps > steps + 50, paused.steps);
  await page.click('#restart');
  await until(page, (time) => window.taut.recording.end < time, paused.time);
  assert.ok(await page.evaluate(() => window.taut.recording.times.every((t, i, all) => i === 0 || t > all[i - 1])));
  assert.deepEqual(complaints, []);
  await page.close();
  assert.deepEqual(await stop(run), {code: 130, signal: null});
  assert.match(run.said, /interrupted: stopped by a signal after step \d+/);
});

test('a body that is dragged moves to the cursor and is let go; a drag beside turns the view', async () => {
  const run = await start(scene, '--live'), {page, complaints} = await open(browser, run.url);
  await page.keyboard.press('1');
  await until(page, () => window.taut.recording.end > 0.1);
  await settle(page);
  const start3 = [0, 0, 0], goal = [0.1, 0, 0.6], [from, to] = [await project(page, start3), await project(page, goal)];
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  await page.mouse.move(to.x, to.y, {steps: 8});
  const distance = () => page.evaluate(() => {
    const [p, q] = window.taut.pulled();
    return Math.hypot(...p.map((x, i) => x - q[i]));
  });
  assert.ok(norm(sub(await page.evaluate(() => window.taut.pulled()[1]), [goal[0], -0.15, goal[2]])) < 0.05);
  await until(page, () => {
    const [p, q] = window.taut.pulled() ?? [[9, 9, 9], [0, 0, 0]];
    return Math.hypot(...p.map((x, i) => x - q[i])) < 0.08;
  });
  const time = (await live(page)).time;
  await until(page, (t) => window.taut.recording.end > t + 1, time);
  assert.ok(await distance() < 0.15, `${await distance()} m`);
  await page.mouse.up();
  await page.waitForTimeout(400);
  assert.equal(await page.evaluate(() => window.taut.pulling), null);
  await moveFreely(page);
  await page.click('#play');  // so that it is where it is seen
  await until(page, () => window.taut.recording.live.paused);
  await settle(page);
  const camera = () => page.evaluate(() => window.taut.view.camera.position.toArray());
  const turnsFrom = async (point) => {
    const before = await camera(), {x, y} = await project(page, point);
    await page.mouse.move(x, y);
    await page.mouse.down();
    await page.mouse.move(x + 40, y + 3, {steps: 4});
    await page.mouse.up();
    await settle(page);
    return norm(sub(await camera(), before)) > 1e-3;
  };
  assert.ok(await turnsFrom([-1, 0, 0]), 'the block is fixed');
  assert.ok(await turnsFrom([0.5, 0, -0.3]), 'there is nothing');
  // Where the ball has got to depends on how long all that took.
  await page.click('#home');
  await settle(page);
  assert.equal(await turnsFrom(await placeOf(page, 1)), false, 'the ball');
  // A page that goes away in the middle of a drag: the body is let go, and the run goes on.
  const last = await project(page, await placeOf(page, 1));
  await page.mouse.move(last.x, last.y);
  await page.mouse.down();
  await page.mouse.move(last.x - 150, last.y, {steps: 4});
  await page.keyboard.press('Space');
  const {steps} = await live(page);
  await until(page, (before) => window.taut.recording.live.steps > before + 20, steps);
  assert.deepEqual(complaints, []);
  await page.close();
  const {page: again} = await open(browser, run.url);
  await until(again, () => window.taut.recording.frames > 20);
  await moveFreely(again);
  await again.close();
  assert.equal((await stop(run)).code, 130);
});

test('a slider turns the motor faster', async () => {
  const recorded = path.join(folder, 'driven.taut');
  const run = await start(scene, '--live', '--record', recorded), {page, complaints} = await open(browser, run.url);
  assert.equal(await page.locator('#motors .motor span').textContent(), 'axle angle');
  assert.equal(await page.locator('#motors output').textContent(), '1.000 rad/s');
  assert.equal(await page.locator('#contacts').isVisible(), false, 'there is none');
  assert.equal(await page.locator('#restart').isVisible(), false, 'a run that writes files cannot go back');
  await until(page, () => window.taut.recording.end > 0.4);
  await page.locator('#motors input').evaluate((slider) => {
    slider.value = 3;
    slider.dispatchEvent(new Event('input', {bubbles: true}));
  });
  await until(page, () => window.taut.recording.live.targets[0] === 3);
  assert.equal(await page.locator('#motors output').textContent(), '3.000 rad/s');
  const time = (await live(page)).time;
  await until(page, (t) => window.taut.recording.end > t + 0.4, time);
  assert.deepEqual(complaints, []);
  await page.close();
  assert.equal((await stop(run)).code, 130);
  const {frames} = readRecording(recorded);
  const rate = (frame, next) => {
    const angle = (f) => 2 * Math.atan2(f.rotation(2)[2], f.rotation(2)[0]);
    return Math.abs(Math.atan2(Math.sin(angle(next) - angle(frame)), Math.cos(angle(next) - angle(frame)))) / (next.time - frame.time);
  };
  const late = frames.filter((frame) => frame.time > time + 0.05 && frame.time < time + 0.35);
  assert.ok(Math.abs(rate(frames[3], frames[4]) - 1) < 1e-3 && Math.abs(rate(late[2], late[3]) - 3) < 1e-3);
});

test('a motor to a position, and one with a trajectory, go where their sliders say; the latter goes back to its trajectory', async () => {
  const file = path.join(folder, 'driven.json'), at = (x) => ({density: 1000, shape: {type: 'box', size: [0.4, 0.1, 0.1]}, position: [x, 0, 0]});
  const hinge = (b, x, axis) => ({name: `${b} pin`, type: 'hinge', a: 'ground', b, anchor: [x, 0, 0], axis: [0, 1, 0], axes: {angle: axis}});
  const omega = 2, amplitude = 0.5;
  fs.writeFileSync(file, JSON.stringify({
    format: 'taut-scene/1', name: 'driven', dt: 0.002, duration: 1, gravity: [0, 0, 0], settings: {contacts: false},
    bodies: [{name: 'arm', ...at(0)}, {name: 'crank', ...at(1)}],
    joints: [hinge('arm', 0, {motor: {position: 0.25}, limits: {lower: -1, upper: 2}}), hinge('crank', 1, {motor: {trajectory: {harmonic: {mean: 0, amplitude, omega}}}})],
  }));
  const run = await start(file, '--live'), {page, complaints} = await open(browser, run.url);
  const row = (i) => page.locator('#motors .motor').nth(i), box = page.locator('#motors .follows input');
  assert.deepEqual(await page.locator('#motors .motor span').allTextContents(), ['arm pin angle', 'crank pin angle']);
  assert.equal(await page.locator('#motors .follows').count(), 1, 'only a trajectory can be followed');
  const range = await row(0).locator('input').evaluate(({min, max}) => [Number(min), Number(max)]);
  assert.deepEqual(range, [-1, 2], 'a position goes as far as its limits');
  const move = (i, value) => row(i).locator('input').evaluate((slider, to) => {
    slider.value = to;
    slider.dispatchEvent(new Event('input', {bubbles: true}));
  }, value);
  /** The angle about y that a body is turned by in a frame. */
  const angleOf = (body, f = -1) => page.evaluate(([id, frame]) => {
    const {list} = window.taut.recording, shown = list.at(frame), out = new Float64Array(7 * shown.bodyCount);
    const poses = shown.poses(shown.times[0], out) ?? out;
    const [, , , x, y, z, w] = poses.slice(7 * id, 7 * id + 7);
    return {time: shown.times[0], angle: 2 * Math.atan2(y, w), rest: Math.hypot(x, z)};
  }, [body, f]);
  await until(page, () => window.taut.recording.end > 0.6);
  assert.ok(await box.isChecked());
  const early = await angleOf(2);
  assert.ok(Math.abs(early.angle - amplitude * Math.sin(omega * early.time)) < 1e-3, JSON.stringify(early));
  // While it is followed the slider is where the trajectory is.
  await until(page, () => window.taut.recording.end > 0.8);
  const shown = await page.evaluate(() => [window.taut.recording.live.targets[1], window.taut.recording.end]);
  assert.ok(Math.abs(shown[0] - amplitude * Math.sin(omega * shown[1])) < 1e-9, `${shown}`);

  await move(0, 1.5);
  await move(1, -0.7);
  await until(page, () => !window.taut.recording.live.follows[1] && window.taut.recording.live.targets[0] === 1.5);
  assert.equal(await box.isChecked(), false);
  assert.equal(await row(1).locator('output').textContent(), '−40.1°');
  assert.equal(await row(1).locator('input').getAttribute('aria-valuetext'), '−40.1°');
  assert.equal(await row(0).locator('output').textContent(), '85.9°');
  assert.equal(await page.locator('#contacts').isVisible(), false, 'contacts are off');
  const {time} = await live(page);
  await until(page, (t) => window.taut.recording.end > t + 1.1, time);  // from end to end of a slider in 1 s
  for (const [body, target] of [[1, 1.5], [2, -0.7]]) {
    const {angle, rest} = await angleOf(body);
    assert.ok(Math.abs(angle - target) < 1e-3 && rest < 1e-3, `${angle} instead of ${target}`);
  }
  assert.equal(await page.evaluate(() => window.taut.recording.live.status), 'running');
  await box.check();
  await until(page, () => window.taut.recording.live.follows[1]);
  const again = (await live(page)).time;
  await until(page, (t) => window.taut.recording.end > t + 2, again);
  const late = await angleOf(2);
  assert.ok(Math.abs(late.angle - amplitude * Math.sin(omega * late.time)) < 1e-3, JSON.stringify(late));
  assert.equal(await page.evaluate(() => window.taut.recording.live.targets[0]), 1.5, 'the other one stays');
  // Back at the start both are as in the file.
  await box.uncheck();
  await until(page, () => !window.taut.recording.live.follows[1]);
  await page.click('#restart');
  await until(page, () => window.taut.recording.live.follows[1] && window.taut.recording.live.targets[0] === 0.25);
  assert.deepEqual(complaints, []);
  await page.close();
  assert.equal((await stop(run)).code, 130);
});

test('the slider of a way is in metres, and contacts are offered as soon as there are some', async () => {
  // Nothing touches before the slider is moved, however long that takes.
  const file = path.join(folder, 'lift.json'), shape = (size) => ({density: 1000, shapes: [{type: 'box', size}]});
  fs.writeFileSync(file, JSON.stringify({
    format: 'taut-scene/1', name: 'lift', dt: 0.002, duration: 1, gravity: [0, 0, 0],
    bodies: [{name: 'table', ...shape([0.4, 0.4, 0.1]), position: [0, 0, 0]},
             {name: 'ceiling', fixed: true, ...shape([0.4, 0.4, 0.1]), position: [0, 0, 0.12]}],
    joints: [{name: 'mast', type: 'slider', a: 'ground', b: 'table', anchor: [0, 0, 0], axis: [0, 0, 1],
              axes: {displacement: {motor: {position: 0.004, max_force: 1000}, limits: {lower: -0.01, upper: 0.03}}}}],
  }));
  const run = await start(file, '--live'), {page, complaints} = await open(browser, run.url);
  assert.equal(await page.locator('#motors output').textContent(), '0.00400 m');
  await until(page, () => window.taut.recording.end > 0.1);
  assert.equal(await page.evaluate(() => window.taut.recording.contactTotal), 0, 'the table is below the ceiling');
  assert.equal(await page.locator('#contacts').isVisible(), false);
  await page.locator('#motors input').evaluate((slider) => {
    slider.value = 0.03;
    slider.dispatchEvent(new Event('input', {bubbles: true}));
  });
  await until(page, () => window.taut.recording.contactTotal > 0);
  await page.waitForSelector('#contacts:not([hidden])');
  assert.deepEqual(complaints, []);
  await page.close();
  assert.equal((await stop(run)).code, 130);
});

test('what is no message is ignored with a notice, and the run goes on', async () => {
  const run = await start(scene, '--live'), {page} = await open(browser, run.url);
  await until(page, () => window.taut.recording.end > 0.1);
  const bad = ['', '{', 'null', '[]', '"pause"', '{"do":1}', '{"do":"fly"}', '{"do":"motor"}', '{"do":"motor","motor":7,"target":1}', '{"do":"motor","motor":-1,"target":1}',
               '{"do":"motor","motor":0.5,"target":1}', '{"do":"follow","motor":0}', '{"do":"motor","motor":0,"target":1e300}', '{"do":"motor","motor":0,"target":"fast"}', '{"do":"speed","value":0}',
               '{"do":"speed","value":-1}', '{"do":"pull","body":0,"point":[0,0,0],"to":[0,0,0],"strength":1}', '{"do":"pull","body":3,"point":[0,0,0],"to":[0,0,0],"strength":1}',
               '{"do":"pull","body":1,"point":[0,0],"to":[0,0,0],"strength":1}', '{"do":"pull","body":1,"point":[0,0,0],"to":[0,0,1e99],"strength":1}',
               '{"do":"pull","body":1,"point":[0,0,0],"to":[0,0,0],"strength":1e99}', '{"do":"pull","body":99999999999999999999,"point":[0,0,0],"to":[0,0,0],"strength":1}',
               `${'['.repeat(30000)}`, '\u0000\u0007\u001b[31m'];
  await page.evaluate((texts) => {
    window.notices = [];
    window.taut.socket.addEventListener('message', ({data}) => { if (typeof data === 'string') window.notices.push(JSON.parse(data).notice); });
    for (const text of texts) window.taut.socket.send(text);
    window.taut.socket.send(new Uint8Array([1, 2, 3]));
  }, bad);
  await until(page, (count) => window.notices.length >= count, bad.length + 1);
  const {notices} = await page.evaluate(() => ({notices: window.notices}));
  for (const notice of notices) assert.match(notice, /^a message is ignored: /);
  assert.match(await page.locator('#notice').textContent(), /a message is ignored/);
  assert.match(run.said, /a message is ignored/);
  assert.ok(!run.said.includes('\u001b'));
  // Random changes of a sound message, by a generator of its own so that a find can be repeated.
  await page.evaluate(() => {
    const sound = '{"do":"pull","body":1,"point":[0,0,0.1],"to":[0.1,0,0.2],"strength":1}';
    let seed = 1;
    const random = (count) => {
      seed = (Math.imul(seed, 1664525) + 1013904223) >>> 0;
      return Math.floor(seed / 2 ** 32 * count);
    };
    for (let k = 0; k < 500; ++k) {
      const text = [...sound];
      for (let i = 0; i <= random(4); ++i) text[random(text.length)] = String.fromCharCode(32 + random(95));
      window.taut.socket.send(text.slice(0, random(8) ? undefined : random(text.length)).join(''));
    }
    window.taut.socket.send('{"do":"release"}');
  });
  const {steps} = await live(page);
  await until(page, (before) => window.taut.recording.live.steps > before + 50, steps);
  // A message that is too long ends the connection, not the run; likewise bytes that are no HTTP.
  await page.evaluate(() => window.taut.socket.send('x'.repeat(200000)));
  await page.waitForFunction(() => window.taut.socket.readyState === WebSocket.CLOSED);
  const {port} = new URL(run.url);
  for (const junk of ['\r\n\r\n', 'GET / HTTP/9.9\r\n\r\n', 'GET / HTTP/1.1\r\nHost: ', `GET /${'a'.repeat(40000)} HTTP/1.1\r\n\r\n`, Buffer.from([0x16, 3, 1, 2, 0, 1, 0, 1, 0xfc])])
    await new Promise((done) => {
      const socket = net.connect(Number(port), '127.0.0.1', () => socket.end(junk));
      socket.on('error', done);
      socket.on('close', done);
      socket.resume();
    });
  await page.reload();
  await until(page, (before) => window.taut?.recording.live.steps > before + 60, steps);
  await page.close();
  assert.equal((await stop(run)).code, 130);
});

test('other pages and other names are turned away', async () => {
  const run = await start(scene, '--live'), {host, port} = new URL(run.url), own = `http://${host}`;
  assert.equal((await ask(run.url)).status, 200);
  assert.equal((await ask(`${own}/elsewhere`)).status, 404);
  for (const name of ['evil.example', `evil.example:${port}`, '127.0.0.1']) assert.equal((await ask(run.url, {Host: name})).status, 403, name);
  const nameless = await new Promise((done) => {
    let text = '';
    const socket = net.connect(Number(port), '127.0.0.1', () => socket.write('GET / HTTP/1.1\r\n\r\n'));
    socket.on('data', (data) => { text += data; });
    socket.on('close', () => done(text));
  });
  assert.match(nameless, /^HTTP\/1.1 403 /);
  assert.equal((await ask(run.url, {Host: `localhost:${port}`})).status, 200);
  assert.equal((await ask(`${own}/live`, {...kUpgrade, Origin: own})).status, 101);
  for (const Origin of ['http://evil.example', `http://localhost:${port}`, 'null', `https://${host}`])
    assert.equal((await ask(`${own}/live`, {...kUpgrade, Origin})).status, 403, Origin);
  assert.equal((await ask(`${own}/live`, kUpgrade)).status, 403, 'without an origin');
  assert.equal((await stop(run)).code, 130);
});

const refused = (...args) => {
  try {
    execFileSync(process.env.TAUT_PROGRAM, ['run', scene, ...args], {stdio: ['ignore', 'pipe', 'pipe'], timeout: 20000});
  } catch (error) {
    return {status: error.status, said: String(error.stderr)};
  }
  return {status: 0, said: ''};
};

test('other addresses are refused unless they are asked for, and then need the token', async (t) => {
  for (const port of ['0.0.0.0:8000', '0.0.0.0', '65536', '-1', '80x', 'example.org'])
    assert.ok(((found) => found.status === 2 && /--live/.test(found.said))(refused(`--live=${port}`)), port);
  for (const address of ['example.org', '300.1.1.1', '', '192.0.2.250'])
    assert.ok(((found) => found.status === 2 && /--live/.test(found.said))(refused('--live-address', address)), address);
  const mine = Object.values(os.networkInterfaces()).flat().find(({family, internal}) => family === 'IPv4' && !internal)?.address;
  if (!mine) return t.skip('this machine has no other address than 127.0.0.1');
  const run = await start(scene, '--live', '--live-address', mine), url = new URL(run.url), token = url.searchParams.get('token');
  assert.match(token, /^[0-9a-f]{32}$/);
  assert.equal(url.hostname, mine);
  const wrong = (token.startsWith('0') ? '1' : '0') + token.slice(1), Origin = url.origin;
  for (const query of ['', '?token=', `?token=${wrong}`, `?token=${token}0`, `?tokens=${token}`, `?x=${token}`]) {
    assert.equal((await ask(`${url.origin}/${query}`)).status, 403, query);
    assert.equal((await ask(`${url.origin}/live${query}`, {...kUpgrade, Origin})).status, 403, query);
  }
  assert.equal((await ask(`${url.origin}/live?token=${token}`, {...kUpgrade, Origin: 'http://evil.example'})).status, 403);
  assert.equal((await ask(`${url.origin}/live?token=${token}`, {...kUpgrade, Origin})).status, 101);
  const {page, complaints} = await open(browser, run.url);
  await until(page, () => window.taut.recording.end > 0.1);
  assert.deepEqual(complaints, []);
  await page.close();
  const second = await start(scene, '--live', '--live-address', mine);
  assert.notEqual(new URL(second.url).searchParams.get('token'), token);
  assert.equal((await stop(second)).code, 130);
  assert.equal((await stop(run)).code, 130);
});

test('on a phone the panel of the run can be opened, and all of it be reached', async () => {
  const run = await start(scene, '--live');
  const {page, complaints} = await open(browser, run.url, {viewport: {width: 372, height: 700}, hasTouch: true, isMobile: true, colorScheme: 'dark'});
  await page.tap('#live summary');
  for (const id of ['strength', 'motors', 'play', 'restart', 'forward', 'speed']) {
    const box = await page.locator(`#${id}`).boundingBox();
    assert.ok(box.x >= 0 && box.x + box.width <= 372 && box.y >= 0 && box.y + box.height <= 700, id);
  }
  assert.deepEqual(complaints, []);
  await page.close();
  assert.equal((await stop(run)).code, 130);
});

test('a run of a given time ends by itself, and says so on its page', async () => {
  const run = await start(scene, '--live', '--time', '0.5'), {page} = await open(browser, run.url);
  assert.equal((await run.ended).code, 0);
  await until(page, () => document.documentElement.dataset.run === 'ended');
  assert.match(await page.locator('#run').textContent(), /^success · step 250$/);
  await page.close();
});
