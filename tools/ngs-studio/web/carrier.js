// Instead of the server of ngs-studio: a module in a worker, to which the page's requests go. The module is in the page, so
// nothing is loaded, and no file leaves the machine.
(() => {
  const find = (id) => document.getElementById(id);
  const waiting = new Map();  // requests by number
  let last = 0, opened;
  const open = new Promise((resolve) => { opened = resolve; });

  async function unpacked(part) {
    const bytes = Uint8Array.from(atob(find(`module-${part}`).textContent), (c) => c.charCodeAt(0));
    const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream('gzip'));
    return new Response(stream).arrayBuffer();
  }

  const parsed = new Promise((resolve) => { document.addEventListener('DOMContentLoaded', resolve); });

  const worker = (async () => {
    await parsed;
    const [code, worker, thread, wasm] = await Promise.all(['code', 'worker', 'thread', 'wasm'].map(unpacked));
    const script = (...parts) => URL.createObjectURL(new Blob(parts, { type: 'text/javascript' }));
    const made = new Worker(script(code, worker));
    made.onmessage = ({ data }) => {
      const { resolve, reject } = waiting.get(data.number);
      waiting.delete(data.number);
      if (data.failed) reject(new TypeError(data.failed));
      else resolve(new Response(data.body, { status: data.status, headers: data.headers }));
    };
    made.postMessage({ wasm, code: script(code), thread: script(thread) }, [wasm]);
    return made;
  })();

  async function ask(request) {
    const to = await worker;
    return new Promise((resolve, reject) => {
      waiting.set(last += 1, { resolve, reject });
      to.postMessage({ ...request, number: last });
    });
  }

  // As fetch(). Requests wait until a splat is open.
  globalThis.ngsCarrier = async (path, { method = 'GET', body = '', signal } = {}) => {
    await open;
    const aborted = new Promise((_, reject) => {
      signal?.addEventListener('abort', () => reject(new DOMException('aborted', 'AbortError')));
    });
    return Promise.race([ask({ path, method, body }), aborted]);
  };

  function say(text) { find('open-status').textContent = text; }

  async function openFile(file) {
    say(`Reading ${file.name} …`);
    const response = await ask({ file });
    if (response.ok) {
      find('open').remove();
      return opened();
    }
    const { error } = await response.json();
    const found = [error.found, error.expected && `expected ${error.expected}`].filter(Boolean).join(', ');
    return say([`${error.object}: ${found}`, error.remedy].filter(Boolean).join('\n'));
  }

  parsed.then(() => {
    const take = (files) => { if (files.length > 0) openFile(files[0]).catch((error) => say(String(error))); };
    find('open-file').addEventListener('change', ({ target }) => take(target.files));
    for (const name of ['dragenter', 'dragover', 'drop'])
      document.addEventListener(name, (event) => event.preventDefault());
    document.addEventListener('drop', ({ dataTransfer }) => { if (find('open')) take(dataTransfer.files); });
  });
})();
