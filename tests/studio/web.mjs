// Tests the studio as one page without a server. See web.sh; --folder DIR has web/ring.ply.
import { execFileSync, spawnSync } from 'node:child_process';
import fs from 'node:fs';
import http from 'node:http';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { parseArgs } from 'node:util';

import { drag, openBrowser, settled } from './browser.mjs';
import { looksOf } from './looks.mjs';

const text = { type: 'string' };
const { values } = parseArgs({ options: { modules: text, chromium: text, folder: text, page: text } });
const work = path.join(values.folder, 'web'), pictures = path.join(values.folder, 'pictures');
const splat = path.join(work, 'ring.ply');
const kStroke = [[-0.1, 0.5], [0.1, 0.55]];
const kExported = ['object-1/object.ply', 'object-1/background.ply'];
const errors = [], loaded = [];
let failed = 0, served, address = pathToFileURL(path.resolve(values.page)).href;

function check(good, what) {
  failed += good ? 0 : 1;
  console.log(`${good ? 'ok  ' : 'FAIL'} ${what}`);
}

async function open(look) {
  const { page, close } = await openBrowser({ ...values, folder: work, errors }, look);
  page.on('request', (request) => { if (!/^(blob|data):/.test(request.url())) loaded.push(request.url()); });
  await page.goto(address);
  return { page, close };
}

// From now on the page comes from a server that isolates it, so that it has threads.
async function serve() {
  served = http.createServer((_, response) => response.writeHead(200, {
    'Content-Type': 'text/html', 'Cross-Origin-Opener-Policy': 'same-origin', 'Cross-Origin-Embedder-Policy': 'require-corp',
  }).end(fs.readFileSync(values.page)));
  await new Promise((resolve) => { served.listen(0, '127.0.0.1', resolve); });
  address = `http://127.0.0.1:${served.address().port}/`;
}

const fileOf = async (page, file) => Buffer.from(await page.evaluate(async (name) => {
  const response = await globalThis.ngsCarrier('/api/download', { method: 'POST', body: JSON.stringify({ file: name }) });
  const bytes = new Uint8Array(await response.arrayBuffer());
  return btoa(Array.from(bytes, (byte) => String.fromCharCode(byte)).join(''));
}, file), 'base64');

// Splats that the tool refuses, by name.
function hostile() {
  const bytes = fs.readFileSync(splat), end = bytes.indexOf('end_header\n') + 11;
  const head = bytes.subarray(0, end).toString(), rows = bytes.subarray(end);
  const with_head = (changed) => Buffer.concat([Buffer.from(changed), rows]);
  return {
    'short.ply': bytes.subarray(0, bytes.length / 2),
    'many.ply': with_head(head.replace(/element vertex \d+/, 'element vertex 4000000000')),
    'endless.ply': with_head(head.replace(/element vertex \d+/, 'element vertex 99999999999999999999')),
    'opacity.ply': with_head(head.replace('property float opacity\n', 'property float opaque\n')),
    'empty.ply': Buffer.alloc(0),
  };
}

async function refusals() {
  const { page, close } = await open({ width: 800, height: 600 });
  for (const [name, bytes] of Object.entries(hostile())) {
    fs.writeFileSync(path.join(work, name), bytes);
    const tool = spawnSync('ngs-studio', [name, '-o', 'refused', '--no-browser'], { cwd: work, encoding: 'utf8', timeout: 20000 });
    await page.locator('#open-file').setInputFiles(path.join(work, name));
    await page.waitForFunction((start) => document.getElementById('open-status').textContent.startsWith(start), `${name}: `);
    const said = await page.locator('#open-status').textContent();
    check(tool.status === 3 && said.split('\n').every((line) => tool.stderr.includes(line)), `refused as by the tool: ${said.replace('\n', '; ')}`);
  }
  await close();
}

// Other formats, written by the tool: read, or refused with a remedy.
async function formats() {
  for (const name of ['ring.compressed.ply', 'ring.splat', 'ring.spz', 'ring.sog']) {
    execFileSync('ngs-extract', ['ring.ply', '--keep-sphere', '0,0,0,1e18', '--allow-empty', '--object-ply', name, '-w', '-q'], { cwd: work });
    const { page, close } = await open({ width: 800, height: 600 });
    await page.locator('#open-file').setInputFiles(path.join(work, name));
    if (name === 'ring.sog') {
      await page.waitForFunction((start) => document.getElementById('open-status').textContent.startsWith(start), `${name}: `);
      const said = await page.locator('#open-status').textContent();
      check(/not read or written in a browser\nconvert it to \.ply/.test(said), `refused: ${said.replace('\n', '; ')}`);
    } else {
      await settled(page);
      check(await page.locator('#open').count() === 0, `open: ${name}`);
    }
    await close();
  }
}

async function strokeAndExport() {
  const { page, close } = await open({ width: 1280, height: 800 });
  check(await page.evaluate(() => globalThis.crossOriginIsolated) === Boolean(served), served ? 'served: with threads' : 'from the disk: one thread');
  let begin = Date.now();
  const took = () => { const s = (Date.now() - begin) / 1000; begin = Date.now(); return `${s.toFixed(1)} s`; };
  await page.locator('#open-file').setInputFiles(splat);
  await settled(page);
  check(true, `open: the first picture after ${took()}`);
  await page.locator('#paint').focus();
  await page.keyboard.press('b');
  begin = Date.now();
  await drag(page, kStroke);
  await settled(page);
  const count = await page.locator('#objects li:nth-child(1) .count').textContent();
  check(/\d/.test(count), `stroke: selects ${count} Gaussians, ${took()}`);
  await page.screenshot({ path: path.join(pictures, 'web-1280.png') });
  begin = Date.now();
  await page.locator('[data-edit=grow]').click();  // of a selection by hand, the native studio too exports what it shows
  await settled(page);
  const grown = await page.locator('#objects li:nth-child(1) .count').textContent();
  check(grown !== count, `grow: selects ${grown} Gaussians, ${took()}`);
  await page.locator('#fill').uncheck();
  begin = Date.now();
  await page.locator('#export').click();
  await page.locator('#download').waitFor();
  check(await page.locator('#trouble').isHidden(), `export: written, ${took()}`);
  const exported = Object.fromEntries(await Promise.all(kExported.map(async (name) => [name, await fileOf(page, name)])));
  const [saved] = await Promise.all([page.waitForEvent('download', (file) => file.suggestedFilename() === 'visit.jsonl'),
    page.locator('#download').click()]);
  await saved.saveAs(path.join(work, 'visit.jsonl'));
  fs.rmSync(path.join(work, 'ring-studio'), { recursive: true, force: true });
  const [command] = (await page.locator('#commands').textContent()).split('\n');
  execFileSync('bash', ['-c', command], { cwd: work, stdio: 'ignore' });
  for (const name of kExported) {
    fs.writeFileSync(path.join(work, path.basename(name)), exported[name]);
    check(exported[name].equals(fs.readFileSync(path.join(work, 'ring-studio', name))), `export: ${name} has the bytes of the installed studio, by ${command}`);
  }
  await close();
}

async function looks() {
  for (const [width, scheme] of [[1280, 'light'], [1280, 'dark'], [390, 'light'], [390, 'dark']]) {
    const { page, close } = await open({ width, height: 844, scheme });
    const faults = await looksOf(page);
    await page.screenshot({ path: path.join(pictures, `web-open-${width}-${scheme}.png`) });
    check(faults.length === 0, `looks: ${width} px, ${scheme} ${faults.join(' ')}`);
    await close();
  }
}

await refusals();
await formats();
await strokeAndExport();
await looks();
const opened = [address];
await serve();
await strokeAndExport();
opened.push(address, `${address}favicon.ico`);
check(loaded.every((url) => opened.includes(url)), `no request leaves the page: ${new Set(loaded).size} addresses`);
served.close();
check(errors.length === 0, `no error in the console ${errors.join('; ')}`);
process.exit(failed > 0 ? 1 : 0);
