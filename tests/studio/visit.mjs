// Tests the page of ngs-studio: actions by mouse, touch and keyboard, and their expected results.
//
//   node visit.mjs --modules NODE_MODULES --chromium PROGRAM --folder DIR [--page studio.html]
//
// DIR/scene.json is the scene; pictures go to DIR/pictures. Ring and box are at the strokes of tutorial.md on view
// 0011. --page: the page without a server gets the scene's splat; what needs the tools (Refine, the commands) is left out.
// One line per check; exit code 1 if a check failed.
import fs from 'node:fs';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';

import { colourAt, difference, drag, openBrowser, placeOf, settled, touch } from './browser.mjs';
import { looksOf } from './looks.mjs';
import { filesOf, runCommands, startStudio } from './server.mjs';

const text = { type: 'string' };
const { values } = parseArgs({ options: { modules: text, chromium: text, folder: text, page: text } });
const kind = values.page ? 'module-' : '';  // of names of pictures
const work = path.join(values.folder, 'visit'), pictures = path.join(values.folder, 'pictures');
let views;  // of the scene, for the page without a server
const errors = [];
const open = (look) => openBrowser({ ...values, folder: work, errors }, look);

let passed = 0, failed = 0;
function check(good, what) {
  passed += good ? 1 : 0;
  failed += good ? 0 : 1;
  console.log(`${good ? 'ok  ' : 'FAIL'} ${what}`);
}

// Converts pixels of a 320 x 240 photo to places: heights from the middle, heights from the top.
const pixels = (...points) => points.map(([x, y]) => [(x - 160) / 240, y / 240]);
const kView = '0011.png';
const kRing = pixels([165, 30], [205, 95], [200, 160], [186, 165]);
const kBesideRing = [
  pixels([110, 120], [165, 165]), pixels([60, 50], [50, 170], [180, 200]), pixels([260, 170], [250, 60])];
const kAcrossRing = pixels([172, 150], [218, 138]);
const kBox = pixels([110, 120], [120, 140], [150, 160]);
const kWall = pixels([250, 40])[0];
const kBlue = '#2040ff';
const kTinted = 25, kSame = 12;  // of 255; JPEG changes a colour by less than kSame

async function countOf(page, row) {
  const text = await page.locator(`#objects li:nth-child(${row}) .count`).textContent();
  return text === 'unmarked' ? 0 : Number(text.replaceAll(',', ''));
}

const stateOf = (page) => page.evaluate(async () => (await (globalThis.ngsCarrier ?? fetch)('/api/state')).json());
const snap = (page, name) => page.screenshot({ path: path.join(pictures, `${kind}${name}.png`) });
const pressed = (page, id) => page.locator(`#${id}`).getAttribute('aria-pressed');

async function pressAndSettle(page, key) {
  await page.keyboard.press(key);
  await settled(page);
}

// Runs in the page without a server: its states, of a splat alone, have the views of the scene too, for the same strokes.
function addViews(added) {
  let ask;
  const withViews = async (to, options) => {
    const response = await ask(to, options), { status, headers } = response;
    if (!/json/.test(headers.get('Content-Type'))) return response;
    const reply = await response.json();
    return new Response(JSON.stringify('views' in reply ? { ...reply, views: added } : reply), { status, headers });
  };
  Object.defineProperty(globalThis, 'ngsCarrier', { get: () => ask && withViews, set: (carrier) => { ask = carrier; } });
}

async function visit(url, look) {
  const { page, close } = await open(look);
  if (views) await page.addInitScript(addViews, views);
  await page.goto(url);
  if (views) await page.locator('#open-file').setInputFiles(path.join(values.folder, 'capture/point_cloud.ply'));
  await settled(page);
  return { page, close };
}

async function openAndTurn(page) {
  check(/\d Gaussians$/.test(await page.locator('#gaussians').textContent()), 'open: title and number of Gaussians are shown');
  check(page.url().includes('token') === false, 'open: the token is removed from the address');
  check(await page.locator('#hint').isVisible(), 'open: the first session shows the hint');
  await snap(page, '1600-light-first');
  const before = await colourAt(page, kWall), samples = pixels([60, 60], [160, 120], [250, 200], [200, 90]);
  const at = async () => Promise.all(samples.map((place) => colourAt(page, place)));
  const start = await at();
  await drag(page, pixels([160, 120], [60, 160]));
  await settled(page);
  const turned = await at();
  check(start.some((colour, k) => difference(colour, turned[k]) > kTinted), 'turn: dragging changes the picture');
  await pressAndSettle(page, 'c');
  check(difference(before, await colourAt(page, kWall)) < kSame, 'turn: C restores the first view');
  check((await page.locator('#views option').count()) === 13, 'views: the first view and twelve of the scene');
  await page.locator('#views').selectOption({ label: kView });
  await settled(page);
}

async function paintAndCorrect(page) {
  const plain = [await colourAt(page, kRing[1]), await colourAt(page, kWall)];
  await page.locator('#paint').focus();
  await page.keyboard.press('b');
  check((await pressed(page, 'tool-object')) === 'true', 'paint: B selects the object brush');
  await drag(page, kRing);
  await settled(page);
  const ring = await countOf(page, 1);
  check(ring > 0, `paint: a stroke selects ${ring} Gaussians`);
  check(!(await page.locator('#hint').isVisible()), 'paint: the first stroke hides the hint');
  await page.locator('#objects input[type=color]').fill(kBlue);
  await settled(page);
  check(difference(plain[0], await colourAt(page, kRing[1])) > kTinted, 'paint: the selection is tinted in the chosen colour');
  await page.locator('#paint').focus();
  await pressAndSettle(page, ' ');
  check(difference(plain[0], await colourAt(page, kRing[1])) < kSame, 'paint: Space hides the tint');
  await pressAndSettle(page, ' ');
  check(difference(plain[1], await colourAt(page, kWall)) < kSame, 'paint: the wall is not tinted');
  await snap(page, '1600-light-marked');

  await page.keyboard.press('x');
  await page.keyboard.press('x');
  check((await pressed(page, 'tool-background')) === 'true', 'correct: X selects the background brush, also when pressed twice');
  for (const stroke of kBesideRing) {
    await drag(page, stroke);
    await settled(page);
  }
  check((await countOf(page, 1)) === ring, 'correct: background strokes outside the object do not change the selection');
  check(difference(plain[1], await colourAt(page, kWall)) < kSame, 'correct: the wall is not tinted');
  await drag(page, kAcrossRing);
  await settled(page);
  const corrected = await countOf(page, 1);
  check(corrected < ring && corrected > 0, `correct: a background stroke across the object reduces the selection to ${corrected} Gaussians`);
  await pressAndSettle(page, 'Control+z');
  check((await countOf(page, 1)) === ring, 'undo: restores the selection before the correction');
  for (const key of ['Control+Shift+z', 'Control+z', 'Control+y']) await pressAndSettle(page, key);
  check((await countOf(page, 1)) === corrected, 'redo: restores the corrected selection');
  await pressAndSettle(page, 'Control+z');
  const whole = await colourAt(page, kWall);
  await pressAndSettle(page, 'f');
  check(difference(whole, await colourAt(page, kWall)) > 1, 'focus: F moves the camera to the selection');
  await goToView(page);
}

async function secondObject(page) {
  await page.locator('#object-add').click();
  await page.locator('#objects li').nth(1).waitFor();
  await page.locator('#objects li:nth-child(2) input[type=text]').fill('box');
  await page.locator('#objects li:nth-child(2) input[type=text]').press('Enter');
  await settled(page);
  await page.locator('#paint').focus();
  await page.keyboard.press('b');
  await drag(page, kBox);
  await settled(page);
  const counts = [await countOf(page, 1), await countOf(page, 2)];
  check(counts.every((count) => count > 0), `second object: ${counts.join(' and ')} Gaussians`);
  const swatches = page.locator('#objects input[type=color]');
  const colours = await swatches.evaluateAll((inputs) => inputs.map(({ value }) => value));
  check(new Set(colours).size === 2, `second object: has another colour, ${colours.join(' and ')}`);
  await snap(page, '1600-light-two-objects');
}

// Corrects the second object by hand, and undoes all of it.
async function byHand(page) {
  const before = await countOf(page, 2), steps = await undosOf(page);
  const outline = pixels([40, 40], [280, 40], [280, 220], [40, 220], [42, 42]);
  const after = async () => { await settled(page); return countOf(page, 2); };
  await page.locator('#paint').focus();
  await page.keyboard.press('l');
  check((await pressed(page, 'tool-lasso')) === 'true' && (await page.locator('#by-hand').isVisible()), 'by hand: L selects the lasso');
  await page.getByText('Visible only', { exact: true }).click();
  await page.locator('#paint').focus();
  await drag(page, outline);
  const visible = await after();
  await snap(page, '1600-light-visible-only');
  await page.getByText('Visible only', { exact: true }).click();
  await page.locator('#paint').focus();
  await pressAndSettle(page, 'Control+z');
  await drag(page, outline);
  const lasso = await after();
  check(lasso > before, `by hand: a lasso adds ${lasso - before} Gaussians`);
  check(visible > before && visible < lasso, `by hand: of what is visible only it adds ${visible - before}`);
  await snap(page, '1600-light-lasso');
  await page.getByText('Take', { exact: true }).click();
  await page.locator('#paint').focus();
  await page.keyboard.press('r');
  await drag(page, pixels([30, 30], [165, 225]));
  const box = await after();
  check(box < lasso, `by hand: a box takes ${lasso - box} Gaussians`);
  await page.getByText('Add', { exact: true }).click();
  await page.locator('#paint').focus();
  await page.keyboard.press('o');
  await drag(page, pixels([120, 140], [150, 140]));
  const ball = await after();
  check(ball > box, `by hand: a ball adds ${ball - box} Gaussians`);
  await page.locator('[data-edit=grow]').click();
  const grown = await after();
  await page.locator('[data-edit=shrink]').click();
  check(grown > ball && (await after()) < grown, 'by hand: Grow adds neighbours and Shrink takes some');
  const shown = await colourAt(page, kBox[1]);
  await page.locator('#hide').click();
  await settled(page);
  check((await pressed(page, 'hide')) === 'true' && difference(shown, await colourAt(page, kBox[1])) > kTinted, 'by hand: Hide hides the object');
  await page.locator('#hide').click();
  await page.locator('#lock').click();
  await settled(page);
  await page.locator('[data-edit=invert]').click();
  await page.locator('#trouble').filter({ hasText: 'is locked' }).waitFor();
  check(true, 'by hand: a locked object does not change, and the page says why');
  await page.locator('#trouble-close').click();
  await page.locator('#paint').focus();
  while ((await undosOf(page)) > steps) await pressAndSettle(page, 'Control+z');
  check((await countOf(page, 2)) === before, 'by hand: Undo undoes every edit');
  await page.keyboard.press('Escape');
  errors.length = 0;  // the refused request of the locked object
}

async function secondTab(page) {
  const other = await page.context().newPage();
  await other.goto(new URL(page.url()).origin);
  await settled(other);
  await page.locator('#object-add').click();
  await page.locator('#objects li').nth(2).waitFor();
  await other.evaluate(() => dispatchEvent(new Event('focus')));
  await other.locator('#objects li').nth(2).waitFor();
  check(true, 'second tab: shows the change of the first once it is looked at');
  check(await other.locator('#hint').isHidden(), 'second tab: does not show the hint of a first session');
  await other.close();
  await page.locator('#undo').click();
  await page.locator('#objects li').nth(2).waitFor({ state: 'detached' });
  await page.locator('#objects li:nth-child(2) input[type=radio]').check();
  await settled(page);
}

async function turnsUpright(page) {
  await page.locator('#upwards').selectOption('+x');
  await settled(page);
  const at = pixels([60, 60], [160, 120], [250, 200]);
  const now = await Promise.all(at.map((place) => colourAt(page, place)));
  await page.locator('#paint').focus();
  for (const key of ['ArrowLeft', 'ArrowRight', 'ArrowLeft', 'ArrowRight']) await pressAndSettle(page, key);
  const later = await Promise.all(at.map((place) => colourAt(page, place)));
  check(now.every((colour, k) => difference(colour, later[k]) < kTinted), 'up axis: turns the camera at once');
  await page.locator('#upwards').selectOption('auto');
  await goToView(page);
}

async function slider(page) {
  await page.locator('#objects li:nth-child(1) input[type=radio]').check();
  await settled(page);
  const both = [await colourAt(page, kWall), await colourAt(page, kRing[1])];
  await page.locator('#paint').focus();
  await pressAndSettle(page, '1');
  const alone = [await colourAt(page, kWall), await colourAt(page, kRing[1])];
  check(difference(both[0], alone[0]) > kTinted, 'slider: object only shows no wall');
  await snap(page, '1600-light-object');
  await pressAndSettle(page, '3');
  check(difference(alone[1], await colourAt(page, kRing[1])) > kTinted, 'slider: background only shows no ring');
  check(difference(both[0], await colourAt(page, kWall)) < kSame, 'slider: background only shows the wall');
  await snap(page, '1600-light-background');
  await pressAndSettle(page, 'g');
  await snap(page, '1600-light-boundary');
  await pressAndSettle(page, '2');
  check(difference(both[0], await colourAt(page, kWall)) < kSame, 'slider: both shows the first picture again');
}

async function cancel(page) {
  await page.locator('#refine').click();
  await page.locator('#job-cancel').click();
  await page.locator('#job').waitFor({ state: 'hidden' });
  const { job, objects } = await stateOf(page);
  check(job.state === 'cancelled' && objects.every(({ refined }) => !refined), 'refine: Cancel ends the job, and no object is refined');
  check(await page.locator('#refine').isEnabled(), 'refine: can be started again after Cancel');
}

async function refine(page) {
  await page.getByText('Quick', { exact: true }).click();
  await page.locator('#refine').click();
  await page.locator('#before, #trouble').filter({ visible: true }).first().waitFor();
  check(await page.locator('#trouble').isHidden(), 'refine: succeeds');
  await settled(page);
  const box = await page.locator('#before').boundingBox();
  await page.mouse.move(box.x + 20, box.y + 10);
  await page.mouse.down();
  await settled(page);
  check((await pressed(page, 'before')) === 'true', 'refine: holding the button shows the labels before Refine');
  await page.mouse.up();
  await settled(page);
  check((await pressed(page, 'before')) === 'false', 'refine: releasing the button shows the refined labels');
}

// Object 1 is not that of cut/: pixels under its strokes that Refine left out are kept.
// Object 1 stands at the edge of the floor after Refine: nothing is filled there.
const kExported = ['object-1/object.ply', 'object-1/background.ply', 'object-1/labelled.ply',
  'object-2/object.ply', 'object-2/background.ply', 'object-2/background-filled.ply', 'object-2/labelled.ply', 'object-2/strokes.json', 'background.ply'];
const hasClock = (name) => name.includes('/report');
const isMadeByCommands = (name) => name.endsWith('.ply') || name.includes('/cut/');

async function exportAndRepeat(page) {
  await page.locator('#fill').check();
  await page.locator('#export').click();
  await page.locator('#exported').waitFor();
  const { files } = (await stateOf(page)).export;
  const folder = path.resolve(work, await page.locator('#folder').textContent());
  await page.locator('#commands-box summary').click();
  const commands = await page.locator('#commands').textContent();
  await page.context().grantPermissions(['clipboard-read', 'clipboard-write']);
  await page.locator('#copy').click();
  await page.locator('#copy').filter({ hasText: 'Copied' }).waitFor();
  check((await page.evaluate(() => navigator.clipboard.readText())) === commands, 'export: Copy copies the commands');
  await page.locator('#commands-box').scrollIntoViewIfNeeded();
  await snap(page, '1600-light-exported');
  const format = page.locator('#format');
  check(await format.evaluate((select) => select.scrollWidth <= select.clientWidth + 1 && select.clientWidth >= 120), 'export: the format box is not clipped');
  const names = [];
  page.on('download', (download) => names.push(download.suggestedFilename()));
  await page.locator('#download').click();
  for (let k = 0; k < 100 && names.length < 7; ++k) await new Promise((resolve) => setTimeout(resolve, 50));
  check(['object', 'background', 'background-filled'].every((part) => names.some((name) => name.endsWith(`${part}.ply`))),
    `export: Download saves objects, backgrounds and fillings: ${names.join(' ')}`);
  const written = filesOf(folder);
  check(kExported.every((name) => files.includes(name)), `export: lists ${files.length} files, including all expected files`);
  check(files.every((name) => written.has(name)), 'export: every listed file exists');

  // Deletes only files that the commands write. The first command writes the session's files to another folder.
  for (const name of files) if (isMadeByCommands(name)) fs.rmSync(path.join(folder, name));
  runCommands(commands, work);
  const repeated = filesOf(folder), again = filesOf(`${folder}-again`);
  const differs = (name, found) => !found?.equals(written.get(name));
  const differing = files.filter((name) => differs(name, repeated.get(name)));
  check(differing.length === 0, ["export: the page's commands reproduce the same bytes", ...differing].join(' '));
  const replayed = [...again.keys()].filter((name) => written.has(name) && !hasClock(name));
  const other = replayed.filter((name) => differs(name, again.get(name)));
  check(replayed.some((name) => name.includes('/masks/')) && other.length === 0,
    ['export: a replay of the session writes the same bytes', ...other].join(' '));
}

// Selects a view in the page's list, which narrow windows hide.
async function goToView(page) {
  await page.locator('#views').evaluate((select, view) => {
    select.selectedIndex = [...select.options].findIndex(({ text }) => text === view);
    select.dispatchEvent(new Event('change'));
  }, kView);
  await settled(page);
}

const undosOf = async (page) => (await stateOf(page)).undo;

async function byFinger(url) {
  const { page, close } = await visit(url, { width: 390, height: 844, touch: true });
  await goToView(page);
  await snap(page, '390-light-first');
  await page.locator('#tool-object').tap();
  const before = await undosOf(page), wall = await colourAt(page, [0.15, 0.16]);
  await touch(page, [pixels([140, 100], [130, 90], [110, 70]), pixels([180, 140], [190, 150], [210, 170])]);
  await settled(page);
  check((await undosOf(page)) === before, 'touch: two fingers do not paint');
  check(difference(wall, await colourAt(page, [0.15, 0.16])) > 1, 'touch: two fingers zoom');
  await touch(page, [pixels([150, 110], [152, 115], [156, 120])]);
  await settled(page);
  check((await undosOf(page)) === before + 1, 'touch: one finger paints');
  await page.locator('#undo').tap();
  await settled(page);
  check((await undosOf(page)) === before, 'touch: undo removes the stroke');
  await page.locator('#panel-toggle').tap();
  check(await page.locator('#panel').isVisible(), 'touch: the panel opens');
  await snap(page, '390-light-panel');
  await close();
}

async function byKey(url) {
  const { page, close } = await visit(url, { width: 800, height: 600, scheme: 'dark' });
  await page.keyboard.press('Tab');
  const focused = await page.evaluate(() => document.activeElement.id);
  check(focused === 'paint', 'keys: Tab reaches the picture first');
  const at = await colourAt(page, [0, 0.5]);
  for (let k = 0; k < 8; ++k) await page.keyboard.press('ArrowLeft');
  await settled(page);
  check(difference(at, await colourAt(page, [0, 0.5])) > 1, 'keys: arrows turn the model');
  await page.keyboard.press('b');
  await page.keyboard.press('ArrowUp');
  const before = await undosOf(page);
  await pressAndSettle(page, 'Enter');
  check((await undosOf(page)) === before + 1, 'keys: Enter paints at the brush');
  await pressAndSettle(page, 'Control+z');
  check((await undosOf(page)) === before, 'keys: Ctrl Z undoes the stroke');
  await page.keyboard.press('?');
  check(await page.locator('#keys').isVisible(), 'keys: ? opens the list of keys');
  await snap(page, '800-dark-keys');
  await page.keyboard.press('Escape');
  await close();
}

async function looks(url) {
  for (const [width, height] of [[390, 844], [800, 600], [1600, 900]])
    for (const scheme of ['light', 'dark']) {
      const { page, close } = await visit(url, { width, height, scheme, touch: width < 700 });
      await goToView(page);
      await page.locator('#tool-background').click();
      await settled(page);
      await snap(page, `${width}-${scheme}`);
      let faults = await looksOf(page);
      if (width < 700) {
        await page.locator('#panel-toggle').click();
        faults = faults.concat(await looksOf(page));
        await snap(page, `${width}-${scheme}-panel`);
      }
      check(faults.length === 0, `looks: ${width} px, ${scheme}${faults.map((fault) => `\n       ${fault}`).join('')}`);
      await close();
    }
}

async function withoutServer(page, studio) {
  const code = await studio.stop();
  check(code === 143 || code === 0 || code === 'SIGTERM', `end: ngs-studio ends on SIGTERM, ${code}`);
  errors.length = 0;
  await page.locator('#fit').click();
  await page.locator('#trouble .remedy:not(:empty)').waitFor();
  check((await page.locator('#trouble').textContent()).includes('start it again'), 'end: the page shows the remedy');
  await snap(page, '1600-light-gone');
}

process.on('uncaughtException', (error) => {
  console.log(`FAIL ${error.stack}`);
  process.exit(1);
});

const studio = await startStudio(path.relative(work, path.join(values.folder, 'scene.json')), work, 'ring-studio');
let { url } = studio;
if (values.page) {
  const native = await visit(url, { width: 800, height: 600 });
  const state = await stateOf(native.page);
  await native.close();
  await studio.stop();
  views = state.views;
  url = pathToFileURL(path.resolve(values.page)).href;
}
const { page, close } = await visit(url, { width: 1600, height: 900 });
await openAndTurn(page);
await paintAndCorrect(page);
await secondObject(page);
await byHand(page);
if (!values.page) await secondTab(page);
await turnsUpright(page);
await slider(page);
if (!values.page) {
  await cancel(page);
  await refine(page);
  await exportAndRepeat(page);
}
await byFinger(url);
await byKey(url);
await looks(url);
check(errors.length === 0, `no error on the page's console${errors.map((error) => `\n       ${error}`).join('')}`);
if (!values.page) await withoutServer(page, studio);
await close();
console.log(`${passed} checks passed, ${failed} failed, 0 skipped`);
process.exit(failed ? 1 : 0);
