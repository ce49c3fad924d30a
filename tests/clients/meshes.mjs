// What other programs say of meshes in .glb: errors of gltf-validator, then faces that three's GLTFLoader finds.
//
//   node tests/clients/meshes.mjs NODE_MODULES FILE.glb...
import fs from 'node:fs';
import path from 'node:path';
import { pathToFileURL } from 'node:url';

const [modules, ...files] = process.argv.slice(2);
const from = (name) => import(pathToFileURL(path.resolve(modules, name)));
const validator = (await from('gltf-validator/index.js')).default;
const { GLTFLoader } = await from('three/examples/jsm/loaders/GLTFLoader.js');
for (const file of files) {
  const bytes = new Uint8Array(fs.readFileSync(file));
  const { issues } = await validator.validateBytes(bytes);
  const { scene } = await new GLTFLoader().parseAsync(bytes.buffer, '');
  let faces = 0;
  scene.traverse((node) => { faces += node.isMesh ? node.geometry.index.count / 3 : 0; });
  console.log(`${path.basename(file)}: ${issues.numErrors} errors, ${faces} faces`);
}
