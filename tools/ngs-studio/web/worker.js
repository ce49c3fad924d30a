// Runs the module: opens a file, answers requests one after another. The code of the module, ngsModule(), is before this.
const folder = '/work';
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

function work({ number, open, bytes, method, path, body }) {
  if (!open) return reply(number, call('ngs_answer', method, path, body));
  module.FS.writeFile(plain(open), new Uint8Array(bytes), { canOwn: true });
  return reply(number, call('ngs_open', plain(open)));
}

const started = new Promise((resolve) => {
  onmessage = async ({ data }) => {
    if (data.wasm) {
      module = await ngsModule({ wasmBinary: data.wasm, print: () => {}, printErr: () => {} });
      module.FS.mkdir(folder);
      module.FS.chdir(folder);
      return resolve();
    }
    await started;
    try {
      work(data);
    } catch (error) {
      postMessage({ number: data.number, failed: String(error?.message ?? error) });
    }
  };
});
