// Tools of the page in a real browser: axes and scale, views, loop, traces, distances, files, a second page beside.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import {after, before, test} from 'node:test';
import {folder, launch, lookFrom, open, picture, project, runScene, scrub, settle, taut} from './browser.mjs';
import {add, anchor, cross, dot, norm, readRecording, sub, turned, unit} from './recording.mjs';

let browser, files, recording;
before(async () => {
  files = runScene('pendulum-hinge', '--time', '1');
  recording = readRecording(files.recording);
  browser = await launch();
});
after(() => browser?.close());

const stage = (page) => page.locator('#stage').boundingBox();
const click = async (page, id) => {
  await page.click('#more');
  await page.click(`#${id}`);
};
/** The point of a body in the world. */
const at = (frame, body, local) => add(frame.position(body), turned(frame.rotation(body), local));
const clickAt = async (page, point) => {
  const {x, y} = await project(page, point);
  await page.mouse.click(x, y);
};
const metres = (text) => {
  const [, number, prefix] = text.match(/(\d+(?:\.\d+)?) ([kmµn]?)m\b/);
  return Number(number) * {k: 1e3, '': 1, m: 1e-3, µ: 1e-6, n: 1e-9}[prefix];
};

/** Axes of the camera from nothing but its position, its target and its upward direction. */
async function cameraAxes(page) {
  const {position, target, up} = await page.evaluate(() => {
    const {camera, controls} = window.taut.view;
    return {position: camera.position.toArray(), target: controls.target.toArray(), up: camera.up.toArray()};
  });
  const forward = unit(sub(target, position)), right = unit(cross(forward, up));
  return {right, top: cross(right, forward), forward, distance: norm(sub(target, position))};
}

test('the triad in the corner shows where x, y and z point, and turns with the camera', async () => {
  const {page, complaints} = await open(browser, files.page), box = await stage(page);
  const center = {x: box.x + box.width - 46, y: box.y + box.height - 46};
  for (const from of [[2, -5, 3], [-4, 3, 2], [5, 1, -2]]) {
    await lookFrom(page, from, [0, 0, 0]);
    const seen = await picture(page), {right, top} = await cameraAxes(page);
    for (const [i, color] of [[208, 36, 60], [35, 137, 63], [32, 88, 216]].entries()) {
      const axis = [0, 1, 2].map((k) => (k === i ? 1 : 0)), arm = [30 * dot(axis, right), -30 * dot(axis, top)];
      if (Math.hypot(...arm) < 8) continue;  // it points at the camera
      const pixel = seen.at(center.x + 0.8 * arm[0], center.y + 0.8 * arm[1]);
      assert.ok(norm(sub(pixel, color)) < 70, `axis ${'xyz'[i]} from ${from}: ${pixel} instead of ${color}`);
    }
  }
  assert.deepEqual(complaints, []);
  await page.close();
});

test('the scale bar is as long as its number of metres, 1, 2 or 5 times a power of ten, at any zoom', async () => {
  const {page} = await open(browser, files.page), seen = new Set();
  for (const distance of [0.7, 2, 4, 11, 300, 9e4]) {
    await lookFrom(page, [0, -distance, 0], [0, 0, 0]);
    await settle(page);
    const bar = await page.evaluate(() => window.taut.overlay.bar), box = await page.locator('#view').boundingBox();
    const fov = await page.evaluate(() => window.taut.view.camera.fov);
    const perMetre = box.height / (2 * distance * Math.tan(fov * Math.PI / 360));
    assert.ok(Math.abs(bar.length / (bar.metres * perMetre) - 1) < 1e-9);
    assert.ok(bar.length <= 110 && bar.length > 40, `${bar.length} px`);
    const part = bar.metres / 10 ** Math.floor(Math.log10(bar.metres) + 1e-9);
    assert.ok([1, 2, 5].some((round) => Math.abs(part - round) < 1e-6), `${bar.metres} m`);
    seen.add(bar.metres);
    // What is drawn is as long: its two ends are dark, what is beyond them is not.
    const pixels = await picture(page), right = box.x + box.width - 92, y = box.y + box.height - 16;
    const dark = (x) => [-1, 0, 1].some((dy) => Math.max(...pixels.at(x, y + dy)) < 110);
    assert.ok(dark(right - 2) && dark(right - bar.length + 2) && !dark(right + 6) && !dark(right - bar.length - 6));
  }
  assert.ok(seen.size >= 5);
  await page.close();
});

test('views from the front, the side, above and a corner, by buttons and keys', async () => {
  const {page} = await open(browser, files.page);
  for (const [key, name, direction] of [['1', 'front', [0, 1, 0]], ['2', 'side', [-1, 0, 0]], ['3', 'top', [0, 0, -1]],
                                        ['4', 'isometric', unit([-1, 1, -1])]]) {
    for (const way of ['key', 'button']) {
      await page.keyboard.press('r');
      if (way === 'key') await page.keyboard.press(key);
      else {
        await page.click('#views');
        await page.click(`[data-look=${name}]`);
      }
      await settle(page);
      const {forward} = await cameraAxes(page);
      assert.ok(norm(sub(forward, direction)) < 2e-3, `${name} by ${way}: ${forward}`);
      const box = await page.locator('#view').boundingBox();
      for (const frame of recording.frames)  // everything that moves is in the picture
        for (const body of [1, 2]) {
          const {x, y} = await project(page, frame.position(body));
          assert.ok(x > box.x && x < box.x + box.width && y > box.y && y < box.y + box.height, name);
        }
    }
  }
  // From the front x points to the right and z up.
  await page.keyboard.press('1');
  const {right, top} = await cameraAxes(page);
  assert.ok(norm(sub(right, [1, 0, 0])) < 1e-6 && norm(sub(top, [0, 0, 1])) < 1e-6);
  await page.close();
});

test('plays by itself and in a loop if its address says so, and keeps both in the address', async () => {
  const {page, complaints} = await open(browser, `${files.page}#autoplay&loop&speed=4&view=top&theme=dark`);
  assert.equal(await page.evaluate(() => document.documentElement.dataset.theme), 'dark');
  assert.ok(norm(sub((await cameraAxes(page)).forward, [0, 0, -1])) < 2e-3);
  const turns = await page.evaluate(async () => {
    let count = 0, last = window.taut.state.t;
    for (const start = performance.now(); performance.now() - start < 20000 && count < 3;) {
      await new Promise((done) => { setTimeout(done, 20); });
      if (window.taut.state.t < last) ++count;
      last = window.taut.state.t;
    }
    return [count, window.taut.state.playing, window.taut.state.speed];
  });
  assert.deepEqual(turns, [3, true, 4]);
  await page.click('#loop');
  assert.ok(!/loop/.test(page.url()));
  await page.waitForFunction(() => !window.taut.state.playing);
  await click(page, 'autoplay');
  assert.ok(!/autoplay/.test(page.url()) && /speed=4/.test(page.url()));
  await page.reload();
  await page.waitForFunction(() => document.documentElement.dataset.state === 'ready');
  assert.equal(await page.evaluate(() => window.taut.state.playing), false);
  assert.deepEqual(complaints, []);
  await page.close();
});

test('axes of hinges are drawn at their anchors, along the axis', async () => {
  const {page} = await open(browser, files.page), frame = recording.frames[30];
  const {axes} = recording.header.joints[1];
  assert.deepEqual(axes.map(({name, type}) => [name, type]), [['angle', 'turn']]);
  await scrub(page, frame.time);
  const place = anchor(recording, frame, 1), axis = turned(frame.rotation(axes[0].body), axes[0].direction);
  assert.ok(Math.abs(Math.abs(axis[1]) - 1) < 1e-6, 'the hinge is about y');
  // From where neither rod is in front of it or behind what is beside it.
  await lookFrom(page, add(place, cross(turned(frame.rotation(1), [2, 0, 0]), [0, 0.6, 0]).map((x, i) => x + [0, -0.4, 0][i])), place);
  await settle(page);
  const radius = await page.evaluate(() => window.taut.view.instances.jointRadius[1]);
  const hit = async (point) => {
    await page.keyboard.press('Escape');
    await settle(page);
    await clickAt(page, point);
    return page.evaluate(() => window.taut.state.selected);
  };
  for (const side of [-1, 1]) {
    const found = await hit(add(place, axis.map((x) => side * 1.5 * radius * x)));
    assert.deepEqual([found?.kind, found?.id], ['joint', 1]);
    assert.equal(await hit(add(place, axis.map((x) => side * 3.4 * radius * x))), null);
  }
  await page.close();
});

test('a trace goes through the recorded places of its point, up to the present instant', async () => {
  const {page} = await open(browser, files.page), frame = recording.frames[50];
  await scrub(page, frame.time);
  await page.keyboard.press('1');
  await settle(page);
  const local = [0.3, 0, 0], before = await picture(page);
  await clickAt(page, at(frame, 2, local));
  await page.click('text=Trace point');
  const clicked = await page.evaluate(() => window.taut.traces[0].point);
  assert.equal(clicked[0], 2);
  assert.ok(norm(sub(clicked.slice(1), local)) < 0.08, `${clicked}`);
  await page.keyboard.press('Escape');
  const seen = await picture(page), color = [181, 23, 158];
  const isTraced = async (f) => {
    const {x, y} = await project(page, at(recording.frames[f], 2, clicked.slice(1)));
    return [-1, 0, 1].some((dx) => [-1, 0, 1].some((dy) => norm(sub(seen.at(x + dx, y + dy), color)) < 60 && norm(sub(before.at(x + dx, y + dy), color)) > 100));
  };
  for (const f of [6, 15, 25, 35, 44]) assert.ok(await isTraced(f), `frame ${f} is not on the trace`);
  for (const f of [57, 60]) assert.ok(!await isTraced(f), `frame ${f} is still to come`);
  await click(page, 'untrace');
  assert.equal(await page.evaluate(() => window.taut.traces.length), 0);
  await page.close();
});

test('the distance of two clicked points is that of the recording, at every instant', async () => {
  const {page} = await open(browser, files.page);
  await page.keyboard.press('1');
  const first = recording.frames[0];
  await scrub(page, first.time);
  await page.keyboard.press('m');
  assert.match(await page.locator('#measured').textContent(), /first point/);
  for (const body of [1, 2]) await clickAt(page, at(first, body, [0.25, 0, 0]));
  const points = await page.evaluate(() => window.taut.measured), lengths = new Set();
  assert.deepEqual(points.map(([body]) => body), [1, 2]);
  for (const f of [0, 20, 45, 60]) {
    const frame = recording.frames[f];
    await scrub(page, frame.time);
    const expected = norm(sub(...points.map(([body, ...local]) => at(frame, body, local))));
    const text = await page.locator('#measured').textContent();
    assert.ok(Math.abs(metres(text) / expected - 1) < 2e-3, `${text} instead of ${expected} m`);
    lengths.add(expected.toFixed(3));
  }
  assert.ok(lengths.size === 4, 'the distance never changes');
  await page.keyboard.press('Escape');
  assert.equal(await page.locator('#measured').isVisible(), false);
  await page.close();
});

const download = async (page, id) => {
  const [file] = await Promise.all([page.waitForEvent('download'), click(page, id)]);
  const place = path.join(folder, file.suggestedFilename());
  await file.saveAs(place);
  return place;
};

test('curves are saved as a table with units, and are those of the recording', async () => {
  const {page} = await open(browser, files.page);
  await page.keyboard.press(']');
  const file = await download(page, 'csv'), lines = fs.readFileSync(file, 'utf8').trim().split('\n');
  assert.match(path.basename(file), /^pendulum-hinge\.csv$/);
  const names = lines[0].split(','), {scalars} = recording.header;
  assert.deepEqual(names.slice(0, -1), ['time [s]', ...scalars.map(({name, unit: own}) => (own ? `${name} [${own}]` : name))]);
  assert.equal(names.at(-1), 'rod_0 speed [m/s]');
  const rows = lines.slice(1).map((line) => line.split(',').map(Number));
  assert.deepEqual(rows.map((row) => row.slice(0, -1)), recording.frames.map((frame) => [frame.time, ...frame.scalars]));
  rows.forEach((row, f) => assert.ok(Math.abs(row.at(-1) - norm(recording.frames[f].velocity(1))) < 0.02));
  await page.close();
});

test('the picture that is saved shows what is seen, without the buttons', async () => {
  const {page} = await open(browser, files.page), frame = recording.frames[40];
  await scrub(page, frame.time);
  const bytes = fs.readFileSync(await download(page, 'picture')), box = await stage(page);
  assert.equal(bytes.subarray(1, 4).toString(), 'PNG');
  const places = [];
  for (const body of [1, 2]) places.push(await project(page, frame.position(body)));
  const colors = await page.evaluate(async ([data, points]) => {
    const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    context.drawImage(image, 0, 0);
    return [[image.width, image.height], ...points.map(({x, y}) => [...context.getImageData(Math.round(x), Math.round(y), 1, 1).data.slice(0, 3)])];
  }, [bytes.toString('base64'), [...places, {x: box.width - 300, y: 34}]]);
  assert.deepEqual(colors[0], [box.width, 2 * Math.floor(box.height / 2)]);
  const seen = await picture(page);
  for (const [i, {x, y}] of places.entries()) assert.ok(norm(sub(colors[1 + i], seen.at(x, y))) < 12, `${colors[1 + i]} instead of ${seen.at(x, y)}`);
  assert.ok(norm(sub(colors[3], [238, 241, 244])) < 12, 'a button is in the picture');
  await page.close();
});

test('the video that is saved plays the whole run', async () => {
  const {page, complaints} = await open(browser, files.page);
  const bytes = fs.readFileSync(await download(page, 'video'));
  assert.equal(bytes.readUInt32BE(0), 0x1a45dfa3, 'it is no WebM');
  // The browser itself plays it: how long it is, and whether its first and its last picture differ.
  const [duration, differing] = await page.evaluate(async (data) => {
    const blob = new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], {type: 'video/webm'});
    const video = Object.assign(document.createElement('video'), {muted: true, src: URL.createObjectURL(blob)});
    const grab = () => {
      const context = new OffscreenCanvas(200, 100).getContext('2d');
      context.drawImage(video, 0, 0, 200, 100);
      return context.getImageData(0, 0, 200, 100).data;
    };
    await new Promise((done) => { video.onloadeddata = done; });
    const first = grab();
    video.play();
    await new Promise((done) => { video.onended = done; });
    const last = grab();
    return [video.currentTime, first.filter((value, i) => Math.abs(value - last[i]) > 30).length];
  }, bytes.toString('base64'));
  assert.ok(duration > 0.8 && duration < 8, `${duration} s`);
  assert.ok(differing > 20);
  assert.equal(await page.locator('#video').getAttribute('aria-pressed'), 'false');
  assert.deepEqual(complaints, []);
  await page.close();
});

test('taut replay of two recordings makes one page of both', async () => {
  const other = runScene('pendulum-hinge', '--set', 'n=3', '--time', '1.5'), {frames, header} = readRecording(other.recording);
  const both = path.join(folder, 'both.html');
  const said = String(taut('replay', files.recording, other.recording, '--html', both));
  assert.match(said, /scene +pendulum-hinge n=2[^]*scene +pendulum-hinge n=3/);
  const {page, complaints} = await open(browser, `${both}#view=front&t=1.2&colour=speed`);
  assert.equal(await page.title(), 'pendulum-hinge');
  assert.equal(await page.evaluate(() => window.taut.state.t), 1.2, 'it goes on to the end of the longer one');
  assert.equal(await page.locator('#time').getAttribute('max'), String(frames.at(-1).time));
  const frame = frames[40];
  await scrub(page, frame.time);
  await settle(page);
  const {forward} = await cameraAxes(page);
  assert.ok(norm(sub(forward, [0, 1, 0])) < 2e-3, `${forward}`);
  const [first, second] = [await page.locator('#view').boundingBox(), await page.locator('#view2').boundingBox()];
  const shift = second.x - first.x, pixels = await picture(page);
  assert.ok(shift > 300);
  for (const [data, dx] of [[recording, 0], [{frames, header}, shift]])
    for (let body = 1; body < data.header.bodies.length; ++body) {
      const {x, y} = await project(page, data.frames[40].position(body));
      assert.ok(norm(sub(pixels.at(x + dx, y), [238, 241, 244])) > 60, `body ${body} is not at ${x + dx}, ${y}`);
    }
  assert.match((await page.locator('.plot figcaption span').allTextContents()).join(), /┄ kin\. [\d.]+ J/);
  // Closed, and another page opened in its place: the first of the two that a page may have.
  await click(page, 'beside');
  assert.equal(await page.locator('#view2').count(), 0);
  await page.setInputFiles('#other', both);
  await page.waitForSelector('#view2');
  assert.equal(await page.evaluate(() => window.taut.pictures[1].recording.bodyCount), recording.header.bodies.length);
  assert.deepEqual(complaints, []);
  await page.close();
});

test('parameters of a scene stand with their units below its name', async () => {
  const scene = runScene('vehicle-bridge', '--set', 'n=6', '--set', 'load=20', '--time', '0.05'), {header} = readRecording(scene.recording);
  assert.deepEqual(header.parameter_units.speed, 'm/s');
  const {page, complaints} = await open(browser, scene.page), facts = await page.locator('#facts').textContent();
  for (const part of ['load = 20 kg', 'n = 6', 'speed = 2 m/s']) assert.ok(facts.split(' · ').includes(part), `${part} is not in ${facts}`);
  const bridge = await open(browser, runScene('bridge', '--set', 'n=10', '--time', '0.05').page);
  assert.ok((await bridge.page.locator('#facts').textContent()).split(' · ').includes('truck = true'));
  assert.deepEqual([...complaints, ...bridge.complaints], []);
  await page.close();
  await bridge.page.close();
});

test('a second page beside has the same instant, camera and colours, and its curves are dashed', async () => {
  const other = runScene('pendulum-hinge', '--set', 'n=3', '--time', '1.5'), {frames, header} = readRecording(other.recording);
  const {page, complaints} = await open(browser, files.page);
  await page.setInputFiles('#other', other.page);
  await page.waitForSelector('#view2');
  const frame = frames[40];
  await scrub(page, frame.time);
  await settle(page);
  const [first, second] = [await page.locator('#view').boundingBox(), await page.locator('#view2').boundingBox()];
  assert.ok(Math.abs(first.width - second.width) < 2 && second.x >= first.x + first.width - 1);
  // Bodies of both are where the recordings have them; a point has the same place in either picture.
  const shift = second.x - first.x, [pixels, ink] = [await picture(page), [238, 241, 244]];
  for (const [data, dx] of [[recording, 0], [{frames, header}, shift]])
    for (const body of data.header.bodies.keys()) {
      if (body === 0) continue;
      const {x, y} = await project(page, data.frames[40].position(body));
      assert.ok(norm(sub(pixels.at(x + dx, y), ink)) > 60, `body ${body} is not at ${x + dx}, ${y}`);
    }
  // What only the second has is nothing in the first; what both have is selected in both.
  const third = await project(page, frame.position(3));
  await page.mouse.click(third.x + shift, third.y);
  assert.equal(await page.evaluate(() => window.taut.state.selected), null);
  const rod = await project(page, frame.position(2));
  await page.mouse.click(rod.x + shift, rod.y);
  assert.equal(await page.locator('#inspector h2').evaluate((node) => node.firstChild.textContent), 'rod_1');
  await settle(page);
  const speeds = await page.locator('#inspector dl').evaluate((list) => [...list.children].find((node) => node.textContent === 'speed').nextElementSibling.textContent);
  const [a, b] = speeds.split(' | ').map((text) => Number.parseFloat(text));
  assert.ok(Math.abs(a - norm(recording.frames[40].velocity(2))) < 0.02 && Math.abs(b - norm(frame.velocity(2))) < 0.02, speeds);
  // Colours are of one scale, and time goes to the end of the longer one.
  const top = await page.evaluate(() => window.taut.scales.force.high);
  assert.ok(top >= Math.max(...frames.map((one) => Math.max(norm(one.force(0)), norm(one.force(1))))) * 0.9);
  assert.equal(await page.locator('#time').getAttribute('max'), String(frames.at(-1).time));
  assert.match((await page.locator('.plot figcaption span').allTextContents()).join(), /┄ kin\. [\d.]+ J/);
  // Turning one picture turns the other.
  await page.mouse.move(second.x + 100, second.y + 250);
  await page.mouse.down();
  await page.mouse.move(second.x + 160, second.y + 260, {steps: 4});
  await page.mouse.up();
  const cameras = await page.evaluate(() => window.taut.pictures.map(({view}) => view.camera.position.toArray()));
  assert.ok(norm(sub(...cameras)) < 1e-9);
  // A file that is none is refused in words; closing leaves the page as it was.
  await page.setInputFiles('#other', {name: 'notes.html', mimeType: 'text/html', buffer: Buffer.from('<p>no page</p>')});
  await page.waitForSelector('#notice:not([hidden])');
  assert.match(await page.locator('#notice').textContent(), /notes\.html is no page of taut/);
  await click(page, 'beside');
  await settle(page);
  assert.equal(await page.locator('#view2').count(), 0);
  assert.ok((await page.locator('#view').boundingBox()).width > 900);
  assert.deepEqual(complaints, []);
  await page.close();
});

test('everything can be reached on a phone of 372 pixels', async () => {
  const {page, complaints} = await open(browser, files.page, {viewport: {width: 372, height: 700}, hasTouch: true, isMobile: true});
  const inside = async () => page.evaluate(() => [...document.querySelectorAll('button, select, input')].filter((node) => node.offsetParent).flatMap((node) => {
    const {left, right, top, bottom, width} = node.getBoundingClientRect();
    const seen = width > 8 && left >= 0 && right <= innerWidth && top >= 0 && bottom <= innerHeight;
    const on = document.elementFromPoint((left + right) / 2, (top + bottom) / 2);
    return seen && (on === node || node.contains(on)) ? [] : [node.id || node.textContent];
  }));
  assert.deepEqual(await inside(), []);
  for (const menu of ['views', 'more']) {
    await page.tap(`#${menu}`);
    assert.deepEqual((await inside()).filter((id) => !['mode', 'joints', 'contacts', 'curves', 'find'].includes(id)), []);
    await page.tap(`#${menu}`);
  }
  for (const id of ['loop', 'help', 'back', 'forward', 'theme', 'home']) assert.ok(await page.locator(`#${id}`).isVisible(), id);
  assert.ok(await page.evaluate(() => document.documentElement.scrollWidth <= innerWidth));
  // The legend is below the buttons.
  const [legend, tools] = [await page.locator('#legend').boundingBox(), await page.locator('#tools').boundingBox()];
  assert.ok(legend.y >= tools.y + tools.height);
  assert.deepEqual(complaints, []);
  await page.close();
});

test('two recordings of a scene stand below each other on a phone, nothing covers them, and each has its name', async () => {
  // The longest legend there is: with arrows.
  const run = (dt) => runScene('net-catch', '--set', 'n=6', '--time', '0.5', '--dt', dt), runs = [run('0.004'), run('0.002')];
  const both = path.join(folder, 'two of one.html');
  taut('replay', runs[0].recording, runs[1].recording, '--html', both);
  const phone = {viewport: {width: 372, height: 660}, hasTouch: true, isMobile: true};
  const {page, complaints} = await open(browser, both, phone);
  await scrub(page, 0.4);
  const box = (id) => page.locator(id).boundingBox();
  const labels = () => page.evaluate(() => window.taut.pictures.map(({view}) => view.canvas.getAttribute('aria-label')));
  const apart = async () => {
    const [tools, legend, first, second] = [await box('#tools'), await box('#legend'), await box('#view'), await box('#view2')];
    assert.ok(legend.y >= tools.y + tools.height && first.y >= legend.y + legend.height && second.y >= first.y + first.height - 1);
    assert.ok(first.height > 140 && Math.abs(first.height - second.height) < 2 && first.width === 372 && second.width === 372);
    // Over all of each picture nothing else is pressed or seen, and what is there shows in it.
    for (const [side, {x, y, width, height}] of [first, second].entries()) {
      const hits = await page.evaluate(([left, top, w, h]) => [0.05, 0.5, 0.95].flatMap((u) => [0.05, 0.5, 0.95].map((v) => document.elementFromPoint(left + u * w, top + v * h).id)), [x, y, width, height]);
      assert.deepEqual([...new Set(hits)], [['view', 'view2'][side]]);
      const ball = await page.evaluate((s) => {
        const {view} = window.taut.pictures[s];
        return view.project(view.positionOf({kind: 'body', id: view.recording.bodies.name.indexOf('ball')}));
      }, side);
      assert.ok(ball.x > 0 && ball.x < width && ball.y > 28 && ball.y < height, JSON.stringify(ball));
    }
    return [first, second];
  };
  const [first, second] = await apart(), [a, b] = await labels();
  for (const [label, {recording: file}] of [[a, runs[0]], [b, runs[1]]]) assert.ok(label.startsWith(`${path.basename(file)} · net-catch`), label);
  // The names are written, and differ.
  const pixels = await picture(page);
  const darks = ({x, y}) => Array.from({length: 340 * 24}, (_, i) => Math.max(...pixels.at(x + 8 + i % 340, y + 4 + Math.floor(i / 340))) < 100 ? 1 : 0);
  const [upper, lower] = [darks(first), darks(second)];
  assert.ok(upper.filter(Boolean).length > 150 && lower.filter(Boolean).length > 150);
  // Pages that are opened beside have the names of their files, and the same one twice has numbers.
  await page.tap('#more');
  await page.tap('#beside');
  await page.setInputFiles('#other', runs[1].page);
  await page.waitForSelector('#view2');
  assert.ok((await labels())[1].startsWith(path.basename(runs[1].page)));
  const own = await open(browser, runs[0].page, phone);
  await own.page.setInputFiles('#other', runs[0].page);
  await own.page.waitForSelector('#view2');
  const same = await own.page.evaluate(() => window.taut.pictures.map(({view}) => view.canvas.getAttribute('aria-label')));
  for (const [side, label] of same.entries()) assert.ok(label.startsWith(`${side + 1}: ${path.basename(runs[0].page)}`), label);
  assert.deepEqual([...complaints, ...own.complaints], []);
  await page.close();
  await own.page.close();
});

test('every number of the curves and of a selection has its unit', async () => {
  const {page} = await open(browser, files.page);
  await page.keyboard.press('}');
  await scrub(page, 0.5);
  const captions = await page.locator('.plot:not([hidden]) figcaption span').allTextContents();
  for (const text of captions) assert.match(text, / (k?J|m|rad|k?N|m\/s)$/, text);
  for (const text of await page.locator('#inspector dd').allTextContents()) assert.match(text, / [Gkmµnp]?(N|N·m|m|rad|kg|m\/s)$|°$/, text);
  await page.close();
});
