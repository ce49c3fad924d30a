// Requests to ngs-studio. A refusal of the server becomes a StudioError, which says what was found and what to do.
export class StudioError extends Error {
  constructor({ object, found, expected, remedy }) {
    super([object, found].filter(Boolean).join(': '));
    Object.assign(this, { object, found, expected, remedy });
  }
}

const kGone = {
  object: 'ngs-studio', found: 'no answer', expected: 'the server on this machine',
  remedy: 'start it again with the same command and open the address that it prints; nothing is lost',
};

async function request(path, options) {
  let response;
  try {
    response = await fetch(path, { ...options, credentials: 'same-origin', cache: 'no-store' });
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
    object: 'this page', found: 'no right to speak to ngs-studio', expected: 'the address that ngs-studio printed',
    remedy: 'open the address that ngs-studio printed, with the token in it',
  };
  return { object: 'ngs-studio', found: `status ${status}`, expected: 'an answer', remedy: 'reload the page' };
}

const posted = (body, signal) => ({
  method: 'POST', headers: { 'Content-Type': 'application/json' }, body: JSON.stringify(body), signal,
});

export const get = async (path) => (await request(path)).json();
export const post = async (path, body = {}) => (await request(path, posted(body))).json();

// A picture, how long the server took for it, and which state of the labels it shows.
export async function frame(body, signal) {
  const response = await request('/api/frame', posted(body, signal));
  const bitmap = await createImageBitmap(await response.blob());
  const header = (name) => Number(response.headers.get(name) ?? 0);
  return { bitmap, ms: header('X-Ngs-Ms'), version: header('X-Ngs-Version') };
}

// Writes go one after another, in the order in which they were asked for.
let last = Promise.resolve();
export function inTurn(work) {
  const mine = last.then(work);
  last = mine.catch(() => {});
  return mine;
}
