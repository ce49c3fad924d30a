// Differences between two models, read independently of the tools (binary PLY of floats, and .glb and .usda converted to a PLY's axes):
//
//   formats.mjs A B POSITION SCALE OPACITY COLOUR SH AXES [MODULES]
//
// Rows are matched by the nearest position. Prints the largest difference of each attribute: position, ln scale, opacity as
// a probability, f_dc, f_rest (of the common degree), axes of the ellipsoids (columns of their rotation matrices up to the
// sign). Exit code 1 if one exceeds its limit.
// MODULES: the folder of three, whose parser reads .usda.
import fs from 'node:fs';

function readPly(path) {
  const data = fs.readFileSync(path), end = data.indexOf('end_header\n') + 11;
  const lines = data.subarray(0, end).toString('latin1').split('\n');
  const rows = Number(lines.find((line) => line.startsWith('element vertex')).split(' ')[2]);
  const names = lines.filter((line) => line.startsWith('property float ')).map((line) => line.split(' ')[2]);
  const at = Object.fromEntries(names.map((name, k) => [name, k]));
  const value = (row, name) => data.readFloatLE(end + (row * names.length + at[name]) * 4);
  const rest = names.filter((name) => name.startsWith('f_rest_')).length / 3;
  return Array.from({ length: rows }, (_, i) => ({
    position: ['x', 'y', 'z'].map((name) => value(i, name)),
    scale: [0, 1, 2].map((k) => value(i, `scale_${k}`)),
    opacity: 1 / (1 + Math.exp(-value(i, 'opacity'))),
    colour: [0, 1, 2].map((k) => value(i, `f_dc_${k}`)),
    sh: Array.from({ length: rest }, (_, k) => [0, 1, 2].map((c) => value(i, `f_rest_${c * rest + k}`))),
    rotation: [0, 1, 2, 3].map((k) => value(i, `rot_${k}`)),
  }));
}

function readGlb(path) {
  const data = fs.readFileSync(path), length = data.readUInt32LE(12), binary = 28 + length;
  const gltf = JSON.parse(data.subarray(20, 20 + length)), attributes = gltf.meshes[0].primitives[0].attributes;
  const read = (name, i, width) => {
    const accessor = gltf.accessors[attributes[name]], view = gltf.bufferViews[accessor.bufferView];
    return Array.from({ length: width }, (_, k) => data.readFloatLE(binary + view.byteOffset + (i * width + k) * 4));
  };
  const splat = 'KHR_gaussian_splatting:';
  // x left, y up: x and y change their sign, and with them the coefficients that are odd in one of them
  const signs = [-1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1];
  const names = [1, 2, 3].flatMap((d) => Array.from({ length: 2 * d + 1 }, (_, n) => `${splat}SH_DEGREE_${d}_COEF_${n}`));
  return Array.from({ length: gltf.accessors[0].count }, (_, i) => {
    const [x, y, z] = read('POSITION', i, 3), q = read(`${splat}ROTATION`, i, 4);
    return {
      position: [-x, -y, z],
      scale: read(`${splat}SCALE`, i, 3).map(Math.log),
      opacity: read(`${splat}OPACITY`, i, 1)[0],
      colour: read(`${splat}SH_DEGREE_0_COEF_0`, i, 3),
      sh: names.filter((name) => name in attributes).map((name, k) => read(name, i, 3).map((v) => v * signs[k])),
      rotation: [q[3], -q[0], -q[1], q[2]],
    };
  });
}

async function readUsda(path, modules) {
  const { USDAParser } = await import(`${modules}/three/examples/jsm/loaders/usd/USDAParser.js`);
  const tree = new USDAParser().parseText(fs.readFileSync(path, 'utf8'));
  const prim = tree['def ParticleField3DGaussianSplat "Splat"'];
  const read = (name) => JSON.parse(prim[name].replaceAll('(', '[').replaceAll(')', ']'));
  const positions = read('point3f[] positions'), rotations = read('quatf[] orientations'), scales = read('float3[] scales');
  const opacities = read('float[] opacities'), degree = Number(prim['uniform int radiance:sphericalHarmonicsDegree']);
  const sh = read('float3[] radiance:sphericalHarmonicsCoefficients'), each = (degree + 1) ** 2;
  // y up, z back: y and z change their sign, and with them the coefficients that are odd in one of them
  const signs = [-1, -1, 1, -1, 1, 1, -1, 1, -1, 1, -1, -1, 1, -1, 1];
  return positions.map(([x, y, z], i) => ({
    position: [x, -y, -z],
    scale: scales[i].map(Math.log),
    opacity: opacities[i],
    colour: sh[i * each],
    sh: sh.slice(i * each + 1, (i + 1) * each).map((v, k) => v.map((c) => c * signs[k])),
    rotation: [rotations[i][0], rotations[i][1], -rotations[i][2], -rotations[i][3]],
  }));
}

function axes(rotation) {
  const length = Math.hypot(...rotation), [w, x, y, z] = rotation.map((v) => v / length);
  return [[1 - 2 * (y * y + z * z), 2 * (x * y + w * z), 2 * (x * z - w * y)],
    [2 * (x * y - w * z), 1 - 2 * (x * x + z * z), 2 * (y * z + w * x)],
    [2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)]];
}

const most = (a, b) => Math.max(0, ...a.map((v, k) => Math.abs(v - b[k])));
function differences(a, b) {
  const first = axes(a.rotation), second = axes(b.rotation), degree = Math.min(a.sh.length, b.sh.length);
  return [most(a.position, b.position), most(a.scale, b.scale), Math.abs(a.opacity - b.opacity), most(a.colour, b.colour),
    Math.max(0, ...a.sh.slice(0, degree).map((v, k) => most(v, b.sh[k]))),
    Math.max(...first.map((v, k) => Math.min(most(v, second[k]), most(v, second[k].map((x) => -x)))))];
}

const [pathA, pathB, ...limits] = process.argv.slice(2);
const modules = limits.splice(6)[0];
const read = (path) =>
  path.endsWith('.usda') ? readUsda(path, modules) : path.endsWith('.glb') ? readGlb(path) : readPly(path);
const a = await read(pathA), b = await read(pathB);
if (a.length !== b.length) { console.log(`${a.length} rows, expected ${b.length}`); process.exit(1); }
const found = [0, 0, 0, 0, 0, 0];
for (const row of a) {
  const nearest = b.reduce((best, other) => {
    const distance = Math.hypot(...row.position.map((v, k) => v - other.position[k]));
    return distance < best.distance ? { distance, other } : best;
  }, { distance: Infinity });
  differences(row, nearest.other).forEach((v, k) => { found[k] = Math.max(found[k], v); });
}
const names = ['position', 'ln scale', 'opacity', 'f_dc', 'f_rest', 'axes'];
console.log(names.map((name, k) => `${name} ${found[k].toPrecision(2)}`).join(', '));
process.exit(found.every((v, k) => v <= Number(limits[k])) ? 0 : 1);
