// A PLY as a .ksplat, by the viewer whose format that is:
//
//   ksplat.mjs FROM.ply TO.ksplat LEVEL MODULES
//
// LEVEL is that of its compression, 0 to 2; MODULES the folder node_modules that holds it.
import fs from 'node:fs';

globalThis.window = globalThis; // it was written for browsers
const [from, to, level, modules] = process.argv.slice(2);
const viewer = await import(`${modules}/@mkkellogg/gaussian-splats-3d/build/gaussian-splats-3d.module.js`);
const { buffer } = new Uint8Array(fs.readFileSync(from));
const splats = await viewer.PlyLoader.loadFromFileData(buffer, 0, Number(level), true, 2);
fs.writeFileSync(to, Buffer.from(splats.bufferData));
