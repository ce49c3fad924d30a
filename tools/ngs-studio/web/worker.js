// Runs the module: opens a file, answers requests one after another. The code of the module, ngsModule(), is before this.
const folder = '/work', input = '/input', largestFile = 2 ** 31;
let module;

function reply(number, status) {
  const start = module._ngs_body(), end = start + module._ngs_body_bytes();
  const body = module.HEAPU8.slice(start, end).buffer;
  const headers = JSON.parse(module.UTF8ToString(module._ngs_head()));
  postMessage({ number, status, headers, body }, [body]);
}

const call = (name, ...words) => module.ccall(name, 'number', words.map(() => 'string'), words);

// A name without folders, as the module's files are in one.
const plain = (name) => name.replace(/[/\\]/g, '_');

// Large files of the module grow in place. Its own way copies a file ten times, faster than the garbage is collected.
function growInPlace(files) {
  const copied = files.expandFileStorage;
  files.expandFileStorage = (node, bytes) => {
    if (bytes < 2 ** 20 || bytes > largestFile) return copied(node, bytes);
    if (!node.contents?.buffer.resizable) {
      const grown = new Uint8Array(new ArrayBuffer(bytes, { maxByteLength: largestFile }));
      if (node.contents) grown.set(node.contents.subarray(0, node.usedBytes));
      node.contents = grown;
    }
    return node.contents.length < bytes && node.contents.buffer.resize(bytes);
  };
}

// The file, without the compression of gzip, if it has that; its first two bytes stay, as readers know it by them
// (gzip_web.cpp). A damaged stream stays as it is: readers refuse it.
async function inflated(file) {
  const head = new Uint8Array(await file.slice(0, 2).arrayBuffer());
  if (head[0] !== 0x1f || head[1] !== 0x8b) return file;
  const parts = [head], stream = file.stream().pipeThrough(new DecompressionStream('gzip')).getReader();
  try {
    for (let bytes = 0, next = await stream.read(); !next.done; next = await stream.read()) {
      parts.push(next.value);
      if ((bytes += next.value.length) > largestFile) return file;
    }
  } catch {
    return file;
  }
  return new Blob(parts);
}

// The file is mounted, not copied into the module.
async function open(file) {
  const name = plain(file.name), { FS } = module;
  if (FS.analyzePath(name).exists) FS.unlink(name);
  if (FS.analyzePath(input).object.mount.mountpoint === input) FS.unmount(input);
  FS.mount(FS.filesystems.WORKERFS, { blobs: [{ name, data: await inflated(file) }] }, input);
  FS.symlink(`${input}/${name}`, name);
  return call('ngs_open', name);
}

async function work({ number, file, method, path, body }) {
  reply(number, file ? await open(file) : call('ngs_answer', method, path, body));
}

const started = new Promise((resolve) => {
  onmessage = async ({ data }) => {
    if (data.wasm) {
      module = await ngsModule({ wasmBinary: data.wasm, print: () => {}, printErr: () => {} });
      growInPlace(module.FS.filesystems.MEMFS);
      module.FS.mkdir(input);
      module.FS.mkdir(folder);
      module.FS.chdir(folder);
      return resolve();
    }
    await started;
    try {
      await work(data);
    } catch (error) {
      postMessage({ number: data.number, failed: String(error?.message ?? error) });
    }
  };
});
