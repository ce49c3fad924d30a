// Runs the module: opens a file, answers requests one after another. The code of the module, ngsModule(), is before this.
const folder = '/work', input = '/input', largestFile = 2 ** 31;
// Threads only where the page was served with the two headers that isolate it (docs/install.md). Without these the module's
// memory is shared too, by the one thread that has it, although the browser hides the name of its type.
const threads = globalThis.crossOriginIsolated ? Math.min(navigator.hardwareConcurrency, 16) : 1;
globalThis.SharedArrayBuffer ??= new WebAssembly.Memory({ initial: 0, maximum: 0, shared: true }).buffer.constructor;
let module;

function reply(number, status) {
  const headers = JSON.parse(module.UTF8ToString(module._ngs_head()));  // first: it finds the memory where it has grown
  const start = module._ngs_body(), end = start + module._ngs_body_bytes();
  const body = module.HEAPU8.slice(start, end).buffer;
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

function instantiated({ wasm, code, thread }) {
  return new Promise((resolve, reject) => {
    const settings = { threads, mainScriptUrlOrBlob: code, locateFile: () => thread, print: () => {}, printErr: () => {} };
    settings.instantiateWasm = (imports, made) => {
      WebAssembly.instantiate(wasm, imports).then(({ instance, module: compiled }) => {
        made(instance, compiled);
        if (threads === 1) settings.removeRunDependency('wasm-instantiate');  // it waits until a thread has the module
      }).catch(reject);
      return {};
    };
    ngsModule(settings).then(resolve, reject);
  });
}

async function start(parts) {
  module = await instantiated(parts);
  module._omp_set_num_threads(threads);
  growInPlace(module.FS.filesystems.MEMFS);
  module.FS.mkdir(input);
  module.FS.mkdir(folder);
  module.FS.chdir(folder);
}

let started;
onmessage = async ({ data }) => {
  if (data.wasm) return void (started = start(data));
  try {
    await started;
    await work(data);
  } catch (error) {
    postMessage({ number: data.number, failed: String(error?.message ?? error) });
  }
};
