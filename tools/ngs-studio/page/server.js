// Requests to ngs-studio: over HTTP, or to the module that a page without a server carries (web/carrier.js). An error response becomes a StudioError with the cause and a remedy.
export class StudioError extends Error {
  constructor({ object, found, expected, remedy }) {
    super([object, found].filter(Boolean).join(': '));
    Object.assign(this, { object, found, expected, remedy });
  }
}

const kGone = {
  object: 'ngs-studio', found: 'no answer', expected: 'the server on this machine',
  remedy: 'start it again with the same command and open the printed address; nothing is lost',
};

async function request(path, options) {
  let response;
  try {
    response = await (globalThis.ngsCarrier ?? fetch)(path, { ...options, credentials: 'same-origin', cache: 'no-store' });
  } catch (error) {
    if (error.name === 'AbortError') throw error;
    throw Object.assign(new StudioError(kGone), { gone: true });
  }
  if (response.ok) return response;
  const { error } = await response.json().catch(() => ({}));
  throw new StudioError(error ?? refusalOf(response.status));
}

function refusalOf(status) {
  if (status === 403) return {
    object: 'this page', found: 'access denied', expected: 'the token of ngs-studio',
    remedy: 'open the address that ngs-studio printed, including the token',
  };
  return { object: 'ngs-studio', found: `status ${status}`, expected: 'an answer', remedy: 'reload the page' };
}

const posted = (body, signal) => ({
  method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(body), signal,
});

export const get = async (path) => (await request(path)).json();
export const post = async (path, body = {}) => (await request(path, posted(body))).json();

// A file of the last export.
export const fileOf = async (file) => (await request('/api/download', posted({ file }))).blob();

// A picture, the time that the server took for it, and the version of the labels shown.
export async function frame(body, signal) {
  const response = await request('/api/frame', posted(body, signal));
  const bitmap = await createImageBitmap(await response.blob());
  const header = (name) => Number(response.headers.get(name) ?? 0);
  return { bitmap, ms: header('X-Ngs-Ms'), version: header('X-Ngs-Version') };
}

// Runs writes one after another, in call order.
let last = Promise.resolve();
export function inTurn(work) {
  const mine = last.then(work);
  last = mine.catch(() => {});
  return mine;
}
