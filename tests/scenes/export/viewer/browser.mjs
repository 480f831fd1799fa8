// Runs scenes, opens their pages in a headless Chromium and reads what it draws.
import {execFileSync} from 'node:child_process';
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import {chromium} from 'playwright-core';
import {cross, dot, sub, unit} from './recording.mjs';

export const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'taut-viewer-'));
process.on('exit', () => fs.rmSync(folder, {recursive: true, force: true}));

export const taut = (...args) => execFileSync(process.env.TAUT_PROGRAM, args, {stdio: ['ignore', 'pipe', 'inherit']});
/** Runs a scene.  @returns {recording, page}: names of the files */
export function runScene(name, ...args) {
  const file = (ending) => path.join(folder, `${name}-${args.join('')}`.replace(/[^\w-]/g, '') + ending);
  taut('run', name, ...args, '--record', file('.taut'), '--html', file('.html'), '--quiet');
  return {recording: file('.taut'), page: file('.html')};
}

export const launch = () => chromium.launch({
  executablePath: process.env.CHROMIUM,
  args: ['--no-sandbox', '--use-angle=swiftshader', '--enable-unsafe-swiftshader', '--ignore-gpu-blocklist',
         '--disable-dev-shm-usage'],
});

/** Opens a page, a file or what a server has at a URL, and waits until it shows.  Whatever it complains about or asks of a network is in `complaints`. */
export async function open(browser, file, options = {}) {
  const context = await browser.newContext({viewport: {width: 1000, height: 700}, colorScheme: 'light', ...options});
  context.setDefaultTimeout(180000);  // ms; where there is no graphics card and much else to do, a page draws a few times a second
  const page = await context.newPage();
  const complaints = [];
  page.on('console', (message) => {
    // What SwiftShader says of its own speed is no complaint of the page.
    if (['error', 'warning'].includes(message.type()) && !/GPU stall|swiftshader/i.test(message.text()))
      complaints.push(message.text());
  });
  page.on('pageerror', (error) => complaints.push(String(error.stack)));
  page.on('request', (request) => {
    if (!/^(file|blob|data):/.test(request.url()) && request.url() !== file) complaints.push(`asks for ${request.url()}`);
  });
  await page.goto(file.startsWith('http') ? file : `file://${file}`);
  await page.waitForFunction(() => document.documentElement.dataset.state !== 'loading');
  await settle(page);
  return {page, complaints};
}

/** Waits until the browser has drawn twice. */
export const settle = (page) => page.evaluate(
  () => new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done))));

/** Moves the slider as a hand does. */
export async function scrub(page, time) {
  await page.locator('#time').evaluate((slider, t) => {
    slider.value = t;
    slider.dispatchEvent(new Event('input', {bubbles: true}));
  }, time);
  await settle(page);
}

/** Puts the camera somewhere. */
export const lookFrom = (page, position, target) => page.evaluate(([from, to]) => {
  const {camera, controls} = window.taut.view;
  camera.position.set(...from);
  controls.target.set(...to);
  controls.update();
}, [position, target]);

/** Place in the window of a world point, from nothing but position, target and opening angle of the camera. */
export async function project(page, point) {
  const c = await page.evaluate(() => {
    const {camera, controls} = window.taut.view, box = document.getElementById('view').getBoundingClientRect();
    return {position: camera.position.toArray(), target: controls.target.toArray(), up: camera.up.toArray(),
            fov: camera.fov, left: box.left, top: box.top, width: box.width, height: box.height};
  });
  const forward = unit(sub(c.target, c.position)), right = unit(cross(forward, c.up)), top = cross(right, forward);
  const d = sub(point, c.position), half = dot(d, forward) * Math.tan(c.fov * Math.PI / 360);
  return {x: c.left + (1 + dot(d, right) / (half * c.width / c.height)) / 2 * c.width,
          y: c.top + (1 - dot(d, top) / half) / 2 * c.height};
}

/** The window as it is seen: at(x, y) gives [r, g, b]. */
export async function picture(page) {
  await settle(page);
  const png = (await page.screenshot()).toString('base64');
  const reader = await page.context().newPage();
  const {width, rgba} = await reader.evaluate(async (data) => {
    const blob = await (await fetch(`data:image/png;base64,${data}`)).blob(), image = await createImageBitmap(blob);
    const context = new OffscreenCanvas(image.width, image.height).getContext('2d');
    context.drawImage(image, 0, 0);
    const bytes = context.getImageData(0, 0, image.width, image.height).data;
    let text = '';
    for (let i = 0; i < bytes.length; i += 32768) text += String.fromCharCode(...bytes.subarray(i, i + 32768));
    return {width: image.width, rgba: btoa(text)};
  }, png);
  await reader.close();
  const bytes = Buffer.from(rgba, 'base64');
  return {
    bytes, width,
    at: (x, y) => [...bytes.subarray(4 * (Math.round(y) * width + Math.round(x))).subarray(0, 3)],
  };
}

/** How many pixels of two pictures differ by more than noise, within a box of the window. */
export function differing(a, b, box) {
  let count = 0;
  for (let y = Math.ceil(box.y); y < box.y + box.height; ++y)
    for (let x = Math.ceil(box.x); x < box.x + box.width; ++x) {
      const [p, q] = [a.at(x, y), b.at(x, y)];
      if (Math.max(...p.map((value, i) => Math.abs(value - q[i]))) > 24) ++count;
    }
  return count;
}

const kStops = ['#34558b', '#2a8fa8', '#4fb286', '#c4cf4f', '#f4b13d', '#ea6a32', '#c9243f'];

/** Colour of a part of the way from slack to taut, [r, g, b] up to 255. */
export function rampColor(part) {
  const place = Math.min(Math.max(part, 0), 1) * (kStops.length - 1), k = Math.min(Math.floor(place), kStops.length - 2);
  const rgb = (hex) => [1, 3, 5].map((i) => parseInt(hex.slice(i, i + 2), 16));
  return rgb(kStops[k]).map((a, i) => a + (place - k) * (rgb(kStops[k + 1])[i] - a));
}

/** The name of what is selected. */
export const heading = (page) => page.locator('#inspector h2').evaluate((node) => node.firstChild.textContent);
