// Pictures of cut objects on their 3D pages: a row per run, with splat, mesh, and mesh and colliders.
//
//   node tests/clients/meshes.mjs NODE_MODULES OUT.jpg RUN...
//
// NODE_MODULES has playwright-core, as installed by tests/studio/run.sh. RUN: a folder of ngs cut --mesh --collider KIND.
import fs from 'node:fs';
import os from 'node:os';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const kSide = 330, kLayers = ['', ',mesh', ',collider'];
const [modules, out, ...runs] = process.argv.slice(2);
const { chromium } = await import(pathToFileURL(path.resolve(modules, 'playwright-core/index.mjs')));
const browser = await chromium.launch({ executablePath: process.env.NGS_CHROMIUM ?? '/usr/bin/chromium',
  args: ['--no-sandbox', '--enable-unsafe-swiftshader', '--allow-file-access-from-files'] });
const page = await browser.newPage({ viewport: { width: kSide * kLayers.length, height: kSide * runs.length } });
const frames = runs.flatMap((run) => kLayers.map((layer) => `<iframe width=${kSide} height=${kSide} style="border:0;float:left"
  src="${pathToFileURL(path.resolve(run, 'object.html'))}#bare${layer}"></iframe>`));
const folder = fs.mkdtempSync(path.join(os.tmpdir(), 'meshes-')), address = path.join(folder, 'page.html');
fs.writeFileSync(address, `<body style="margin:0">${frames.join('')}`);
await page.goto(String(pathToFileURL(address)));
for (const frame of page.frames().slice(1))
  await frame.waitForFunction(() => document.body.dataset.drawn || document.body.dataset.failed);
await page.screenshot({ path: out, type: 'jpeg', quality: 78 });
await browser.close();
fs.rmSync(folder, { recursive: true });
