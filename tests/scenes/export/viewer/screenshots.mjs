// Pictures of pages for the README:  screenshots.mjs FOLDER [NAME...]
import {execFileSync} from 'node:child_process';
import path from 'node:path';
import {folder as temporary, launch, open, runScene, scrub, settle} from './browser.mjs';

const [folder, ...chosen] = process.argv.slice(2);
if (!folder) throw new Error('which folder?');

const kWide = {viewport: {width: 900, height: 520}};
const kPhone = {viewport: {width: 390, height: 660}, isMobile: true, hasTouch: true};
const kDark = {colorScheme: 'dark'};
const net = ['net-corners', '--set', 'n=40', '--time', '1', '--frames-per-second', '30'];
const grid = ['joint-grid', '--set', 'n=100', '--set', 'swing=true', '--time', '1', '--frames-per-second', '30'];
// The programs of scenes/examples, where tests/outside/run.sh has built them.
const outside = path.join(path.dirname(process.env.TAUT_PROGRAM), 'outside-examples');
const example = (name, ...args) => {
  execFileSync(path.join(outside, name), [...args, temporary], {stdio: 'inherit'});
  return {page: path.join(temporary, `${name}.html`)};
};
const fourBar = new URL('../../../../scenes/examples/four_bar.json', import.meta.url).pathname;
const kSmall = {viewport: {width: 600, height: 400}};
const springs = new URL('../../../../scenes/examples/spring_mass.json', import.meta.url).pathname;

// Name of the picture: the run, the instant [s], the window, and what is selected by name.
const kPictures = {
  'page-pendulum': {run: ['pendulum-ball', '--time', '3'], at: 0.75, window: kWide, select: 'joint_1'},
  'page-net': {run: net, at: 0.8, window: kWide},
  'page-bridge': {run: ['bridge', '--time', '2'], at: 0.27, window: {...kWide, ...kDark}},
  'page-grid': {run: grid, at: 0.9, window: kWide},
  'page-crane': {run: ['crane', '--time', '5'], at: 3, window: kWide, select: 'hoist_wire'},
  'page-wall': {run: ['wall', '--time', '0.5'], at: 0.4, window: {...kWide, ...kDark}},
  'page-tank': {run: ['tank', '--time', '0.5'], at: 0.4, window: kWide},
  'page-drag': {run: ['net-drag', '--set', 'bump=0.1', '--time', '4'], at: 3.6, window: kWide},
  'page-springs': {run: [springs, '--time', '2'], at: 0.3, window: kWide, select: 'spring_1'},
  'page-phone': {run: ['bridge', '--time', '2'], at: 0.27, window: kPhone, select: 'truck'},
  'example-pendulum': {example: ['pendulum'], at: 0.3, window: kSmall},
  'example-truss': {example: ['truss'], at: 0.5, window: kSmall},
  'example-ramp': {example: ['ramp'], at: 0.6, window: kSmall},
  'example-cart_pole': {example: ['cart_pole'], at: 0.2, window: kSmall},
  'example-from_file': {example: ['from_file', fourBar], at: 0.5, window: kSmall},
  'example-go_on': {example: ['go_on'], at: 0.45, window: kSmall},
};

const browser = await launch();
for (const [name, {run, example: program, at, window, select}] of Object.entries(kPictures)) {
  if (chosen.length && !chosen.includes(name)) continue;
  const {page} = await open(browser, (run ? runScene(...run) : example(...program)).page, window);
  await scrub(page, at);
  if (select) {
    await page.keyboard.press('/');
    await page.keyboard.type(select);
    await page.keyboard.press('Enter');
    await settle(page);
    await page.keyboard.press('r');  // beside its numbers
    await settle(page);
  }
  await page.screenshot({path: path.join(folder, `${name}.png`)});
  await page.close();
}
await browser.close();
