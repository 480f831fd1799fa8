// The notebooks of the built site in a browser without a network: their formulas, what they print, figures and pages.
//   SITE=build/site/html CHROMIUM=chromium node --test tests/site/notebooks.test.mjs
// Needs the packages of tests/scenes/export/viewer/package.json.
import assert from 'node:assert/strict';
import fs from 'node:fs';
import path from 'node:path';
import {pathToFileURL} from 'node:url';
import {after, before, test} from 'node:test';
import {launch} from '../scenes/export/viewer/browser.mjs';

const folder = path.resolve(process.env.SITE, 'scenes/python/notebooks');
const own = new URL('../../scenes/python/notebooks/', import.meta.url);
let browser;
before(async () => { browser = await launch(); });
after(() => browser.close());

for (const file of fs.readdirSync(own).filter((name) => name.endsWith('.ipynb'))) {
  const {cells} = JSON.parse(fs.readFileSync(new URL(file, own))), text = (type) => cells.filter((cell) => cell.cell_type === type).map(({source}) => source.join('')).join('\n');
  test(`${file} is shown as it runs, and asks for nothing from elsewhere`, async () => {
    const page = await browser.newPage({viewport: {width: 1200, height: 900}}), complaints = [];
    page.on('request', (request) => { if (!/^(file|blob|data|about):/.test(request.url())) complaints.push(`asks for ${request.url()}`); });
    page.on('requestfailed', (request) => complaints.push(`does not get ${request.url()}`));
    page.on('pageerror', (error) => complaints.push(String(error.stack)));
    await page.goto(`${pathToFileURL(path.join(folder, file.replace('.ipynb', '.html')))}`);
    // As many formulas as the text has, each drawn, and none that MathJax did not understand.
    const formulas = text('markdown').match(/\$\$[^$]+\$\$|\$[^$]+\$/g) ?? [];
    await page.waitForFunction((count) => document.querySelectorAll('article mjx-container svg').length === count, formulas.length, {timeout: 60000});
    assert.equal(await page.locator('article [data-mjx-error], article mjx-merror').count(), 0);
    assert.doesNotMatch(await page.locator('article').evaluate((node) => [...node.querySelectorAll('p')].map((p) => p.innerText).join('\n')), /\\[a-z]+|\$/);
    // Figures and printed lines, and what a simulation shows of itself.
    const code = text('code'), figures = await page.$$eval('article .cell_output img', (all) => all.map((image) => image.naturalWidth));
    assert.equal(figures.length, cells.filter(({cell_type: type, source}) => type === 'code' && /plt\.(plot|loglog|semilogy|pcolormesh)|subplots/.test(source.join(''))).length);
    assert.ok(figures.length > 0 && figures.every((width) => width > 300), `${figures}`);
    assert.equal(/print\(/.test(code), (await page.locator('article .cell_output .output.stream').count()) > 0);
    assert.equal(await page.locator('article .cell_output .stderr, article .cell_output .traceback').count(), 0);
    const frames = page.frames().filter((frame) => frame !== page.mainFrame());
    assert.equal(frames.length, /^(film|simulator)$/m.test(code) ? 1 : 0);
    for (const frame of frames) {
      await frame.waitForFunction(() => document.documentElement.dataset.state === 'ready', null, {timeout: 60000});
      assert.ok(await frame.evaluate(() => window.taut.recording.bodyCount > 1));
    }
    assert.deepEqual(complaints, []);
    await page.close();
  });
}
