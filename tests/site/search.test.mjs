// What a reader does with the built site in a browser: asks the search, and goes from the first page to all that it promises.
//   SITE=build/site/html CHROMIUM=chromium node --test tests/site/search.test.mjs
// Needs the packages of tests/scenes/export/viewer/package.json.
import assert from 'node:assert/strict';
import path from 'node:path';
import {pathToFileURL} from 'node:url';
import {after, before, test} from 'node:test';
import {launch} from '../scenes/export/viewer/browser.mjs';

const root = pathToFileURL(path.resolve(process.env.SITE)) + '/';
let browser, page;
before(async () => {
  browser = await launch();
  page = await browser.newPage();
});
after(() => browser.close());

/** Types a query where a reader does.  @returns the pages that it finds, best first, each once and without the ending */
async function search(query) {
  await page.goto(root + 'index.html');
  await page.fill('input.sidebar-search', query);
  await page.press('input.sidebar-search', 'Enter');
  await page.waitForFunction(
    () => /found|did not match/.test(document.querySelector('#search-results .search-summary')?.textContent ?? ''), null,
    {timeout: 60000});
  const found = await page.$$eval('#search-results ul.search > li > a', (links) => links.map((link) => link.href));
  return [...new Set(found.map((link) => link.replace(root, '').replace(/\.html.*/, '')))];
}

// A query, pages that must be among its first results, and how many of these count.
const QUERIES = [
  ['hinge', ['api/cpp/core/joints/hinge', 'api/python/taut/Hinge'], 3],
  ['servo', ['scenes/examples/tutorials/control_loop', 'solvers/laws/axes/index'], 5],
  ['penetration', ['api/python/taut/StepReport', 'api/cpp/solvers/common/step_report', 'collision/index'], 10],
  ['bridge', ['scenes/examples/tutorials/bridge'], 3],
  ['urdf', ['scenes/examples/tutorials/importing', 'scenes/import/index'], 8],
  ['set_break', ['api/cpp/core/world/world', 'api/python/taut/World'], 5],
];
for (const [query, wanted, most] of QUERIES)
  test(`the search for ${query} finds its pages`, async () => {
    const found = (await search(query)).slice(0, most);
    for (const name of wanted) assert.ok(found.includes(name), `${name} is not among ${found.join(', ')}`);
  });

test('a result leads to what was asked for', async () => {
  await search('hinge');
  await page.click('#search-results ul.search > li > a');
  await page.waitForLoadState();
  assert.match(page.url(), /hinge/i);
  assert.match(await page.textContent('article'), /hinge/i);
});

test('what is not there is not found', async () => assert.deepEqual(await search('xylophone'), []));

test('the first page leads to every part', async () => {
  await page.goto(root + 'index.html');
  const links = await page.$$eval('article a', (all) => all.map((link) => link.href.replace(/#.*/, '')));
  const parts = {
    'overview': 'Try it',
    'scenes/examples/tutorials/first_mechanism': 'First mechanism',
    'solvers/simulator/FORCES': 'Reading forces',
    'scenes/examples/tutorials/contacts': 'Contacts',
    'scenes/examples/tutorials/control_loop': 'Control loop',
    'scenes/examples/tutorials/bridge': 'Bridge',
    'scenes/examples/tutorials/importing': 'Importing',
    'scenes/examples/pictures/index': 'Gallery',
    'api/cpp/index': 'C++ reference',
    'api/python/taut/index': 'Simulator',
    'scenes/files/FORMAT': 'The format of scene files',
    'core/index': 'what exists',
    'solvers/index': 'how a World moves',
    'benchmarks/index': 'Benchmarks',
  };
  for (const [name, words] of Object.entries(parts)) {
    assert.ok(links.includes(`${root}${name}.html`), `the first page has no link to ${name}`);
    await page.goto(`${root}${name}.html`);
    assert.ok((await page.textContent('article')).includes(words), name);
  }
});

test('each picture of the gallery has its command', async () => {
  await page.goto(root + 'scenes/examples/pictures/index.html');
  const sections = await page.$$eval('article section section', (all) => all.map(
    (one) => [one.querySelector('h2').textContent, one.querySelector('img')?.naturalWidth > 0, /taut run/.test(one.textContent)]));
  assert.ok(sections.length >= 10);
  for (const [title, hasPicture, hasCommand] of sections) assert.ok(hasPicture && hasCommand, title);
});
