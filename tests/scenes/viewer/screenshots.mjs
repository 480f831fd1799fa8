// Pictures of pages for the README:  screenshots.mjs FOLDER
import path from 'node:path';
import {launch, open, runScene, scrub} from './browser.mjs';

const out = process.argv[2];
if (!out) throw new Error('which folder?');

// name of the picture: scene with its options, instant [s], and what else is done to the page
const kPictures = {
  pendulum: {run: ['pendulum-ball', '--time', '3'], at: 2.3},
  net: {run: ['net-corners', '--set', 'n=40', '--time', '1', '--frames-per-second', '30'], at: 0.8},
  bridge: {run: ['bridge', '--time', '2'], at: 0.27},
  grid: {run: ['joint-grid', '--set', 'n=100', '--set', 'swing=true', '--time', '0.5', '--frames-per-second', '30'],
         at: 0.4},
};
const wide = {viewport: {width: 1100, height: 680}}, phone = {viewport: {width: 390, height: 780}, isMobile: true,
                                                              hasTouch: true, deviceScaleFactor: 2};

const browser = await launch();
for (const [name, {run, at}] of Object.entries(kPictures).filter(([n]) => !process.argv[3] || process.argv[3].split(`,`).includes(n))) {
  const file = runScene(...run).page;
  for (const [suffix, options] of (process.argv[3] ? [[``, wide], [`-phone`, phone]] : [[``, wide], [`-dark`, {...wide, colorScheme: `dark`}], [`-phone`, phone]])) {
    const {page} = await open(browser, file, options);
    await scrub(page, at);
    await page.screenshot({path: path.join(out, `${name}${suffix}.png`)});
    await page.close();
  }
}
await browser.close();
