// Refine and Export: jobs of the server, their progress and results.
import { gaussiansText } from './objects.js';
import { fileOf, get, inTurn, post } from './server.js';

const kPollMs = 400;

export class Jobs {
  // `find(id)` gives an element; `on` has state(state) and failed(error).
  constructor(find, on) {
    Object.assign(this, { find, on, running: false });
    find('refine').addEventListener('click', () => this.start('/api/refine', { quality: this.quality }));
    find('export').addEventListener('click', () => this.start('/api/export',
      { format: find('format').value, fill: find('fill').checked, mesh: find('mesh').checked }));
    find('keep').addEventListener('click', () => this.keep());
    find('download').addEventListener('click', () => this.download().catch(on.failed));
    find('job-cancel').addEventListener('click', () => post('/api/cancel').catch(on.failed));
    find('copy').addEventListener('click', () => this.copy());
    this.holdToCompare(find('before'));
  }

  // Keeps what Refine dropped, or drops it again.
  keep() {
    const { id, keeps_dropped: kept } = this.active;
    return this.start('/api/keep', { object: id, keep: !kept });
  }

  showDropped(object) {
    this.active = object;
    this.find('dropped').hidden = !object?.dropped;
    if (!object?.dropped) return;
    const [text, button] = this.find('dropped').children;
    text.textContent = object.keeps_dropped ? `Kept: ${gaussiansText(object.dropped)} that Refine would drop.`
      : `Refine drops ${gaussiansText(object.dropped)} of your selection (pink).`;
    button.textContent = object.keeps_dropped ? 'Drop it' : 'Keep it';
  }

  get quality() { return document.querySelector('[name=quality]:checked').value; }

  async start(path, body) {
    try {
      this.on.state(await inTurn(() => post(path, body)));
    } catch (error) {
      this.on.failed(error);
    }
  }

  // Called with every state: shows the running job and polls it until its end.
  show(state) {
    const { job } = state, running = job?.state === 'running';
    this.find('job').hidden = !running;
    for (const kind of ['refine', 'export']) this.find(kind).hidden = running && job.kind === kind;
    if (running) this.find(job.kind).after(this.find('job'));  // in place of the button, so that the layout does not move
    const marked = state.objects.some(({ gaussians }) => gaussians > 0);
    this.find('refine').disabled = this.find('export').disabled = running || !marked;
    this.find('download').hidden = running || !state.export;
    this.find('before').hidden = !state.objects.some(({ id, refined }) => refined && id === state.active);
    this.showDropped(state.objects.find(({ id }) => id === state.active));
    this.find('refine-note').hidden = !job?.note;
    this.find('refine-note').textContent = job?.note ?? '';
    this.showExport(state);
    if (running) this.showProgress(job);
    if (running && !this.running) this.watch();
  }

  showProgress({ kind, stage, done, remaining_s: remaining }) {
    const left = remaining === null || remaining === undefined ? '' : `, ${duration(remaining)} left`;
    this.find('job-bar').value = done;
    const work = kind === 'export' ? 'Writing' : stage || 'Refining';
    this.find('job-text').textContent = `${work[0].toUpperCase()}${work.slice(1)}: ${Math.round(100 * done)} %${left}`;
  }

  async watch() {
    this.running = true;
    for (;;) {
      await new Promise((resolve) => setTimeout(resolve, kPollMs));
      try {
        const job = await get('/api/job');
        if (job?.state === 'running') { this.showProgress(job); continue; }
        this.running = false;
        this.on.state(await get('/api/state'), job);
        if (job?.kind === 'export') this.find('commands-box').scrollIntoView({ block: 'nearest' });
        if (job?.error) this.on.failed(job.error);
      } catch (error) {
        this.running = false;
        this.on.failed(error);
      }
      return;
    }
  }

  showExport({ export: written, commands }) {
    this.find('exported').hidden = !written;
    this.find('commands').textContent = (commands ?? []).join('\n');
    this.find('commands-box').hidden = !commands?.length;
    if (!written) return;
    this.written = written;
    this.find('folder').textContent = written.path;
    this.find('files').replaceChildren(...inShort(written.files).map((file) =>
      Object.assign(document.createElement('li'), { textContent: file })));
  }

  // Saves the splats of the last export from the browser.
  async download() {
    const splats = this.written.files.filter((file) => file.endsWith('/mesh.glb') || file === 'visit.jsonl' ||
      (file.endsWith(`.${this.written.format}`) && !file.endsWith('labelled.ply')));
    const several = new Set(splats.map((file) => file.slice(file.lastIndexOf('/') + 1))).size < splats.length;
    for (const file of splats) {
      const address = URL.createObjectURL(await fileOf(file));
      const name = several ? file.replaceAll('/', '-') : file.slice(file.lastIndexOf('/') + 1);
      Object.assign(document.createElement('a'), { href: address, download: name }).click();
      setTimeout(() => URL.revokeObjectURL(address), 60000);
    }
  }

  async copy() {
    const text = this.find('commands').textContent, button = this.find('copy');
    try {
      await navigator.clipboard.writeText(text);
    } catch {  // no permission: select the text for copying by hand
      getSelection().selectAllChildren(this.find('commands'));
    }
    button.textContent = getSelection().toString() === text ? 'Selected: copy it' : 'Copied';
    setTimeout(() => { button.textContent = 'Copy'; }, 1500);
  }

  // While the button is held, by pointer or key, frames show the labels before Refine.
  holdToCompare(button) {
    const show = async (before) => {
      if ((button.getAttribute('aria-pressed') === 'true') === before) return;
      button.setAttribute('aria-pressed', before);
      await this.start('/api/before', { show: before });
    };
    for (const name of ['pointerdown', 'keydown'])
      button.addEventListener(name, ({ key = ' ' }) => (key === ' ' || key === 'Enter') && show(true));
    for (const name of ['pointerup', 'pointercancel', 'pointerleave', 'keyup', 'blur'])
      button.addEventListener(name, () => show(false));
    button.addEventListener('contextmenu', (event) => event.preventDefault());  // a long touch
  }
}

// File names; more than two pictures in a folder become one line.
function inShort(files) {
  const folders = new Map();
  for (const file of files.filter((name) => name.endsWith('.png'))) {
    const folder = file.slice(0, file.lastIndexOf('/') + 1);
    folders.set(folder, [...(folders.get(folder) ?? []), file]);
  }
  const many = new Map([...folders].filter(([, names]) => names.length > 2));
  const short = files.filter((file) => !many.has(file.slice(0, file.lastIndexOf('/') + 1)));
  return [...short, ...[...many].map(([folder, names]) => `${folder} (${names.length} pictures)`)];
}

// A duration for display.
function duration(seconds) {
  if (seconds < 55) return `${Math.max(1, Math.round(seconds))} s`;
  return seconds < 3300 ? `${Math.round(seconds / 60)} min` : `${(seconds / 3600).toFixed(1)} h`;
}
