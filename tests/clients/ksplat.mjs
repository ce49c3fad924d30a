// Converts a PLY to .ksplat with the viewer that defines the format:
//
//   ksplat.mjs FROM.ply TO.ksplat LEVEL MODULES
//
// LEVEL: compression, 0 to 2. MODULES: the node_modules folder with the viewer.
import fs from 'node:fs';

globalThis.window = globalThis; // the viewer expects a browser
const [from, to, level, modules] = process.argv.slice(2);
const viewer = await import(`${modules}/@mkkellogg/gaussian-splats-3d/build/gaussian-splats-3d.module.js`);
const { buffer } = new Uint8Array(fs.readFileSync(from));
const splats = await viewer.PlyLoader.loadFromFileData(buffer, 0, Number(level), true, 2);
fs.writeFileSync(to, Buffer.from(splats.bufferData));
