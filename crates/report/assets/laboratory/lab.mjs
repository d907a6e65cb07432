import {clientOfPage} from '../../../web/assets/page.mjs';
import {colorMaps} from '../../../figure/viewer/colors.mjs';
import {element, readable} from '../../../figure/viewer/dom.mjs';
import {Form} from './form.mjs';
import {followTheme} from '../theme.mjs';
import {link, linked, python, rust, shell, stem} from './programs.mjs';
import {Renderer} from '../../../figure/viewer/renderer.mjs';
import {Viewer} from '../../../figure/viewer/viewer.mjs';
import {CURVATURE, labelled, leftOut, measured, replacing, reported} from './words.mjs';

/**
 * Requests that only add fields to a mesh, and the field that they show; all others make a new one.
 */
const FIELDS = {curvature: 'mean', distance: 'distance', spectrum: 'mode', mode: 'mode'};
/** Milliseconds within which a task is run again without being asked for. */
const QUICK = 500;
const TITLES = {
  curvature: 'Curvature',
  smooth: 'Smooth',
  denoise: 'Denoise',
  spectrum: 'Modes',
  reconstruct: 'Reconstruct',
  distance: 'Distance',
  noise: 'Add noise',
  repair: 'Repair',
  compare: 'Compare',
};

/** The method of a request, if its task has several, and the values that were given, in words. */
function said({verb, method, values}) {
  const given = Object.entries(values).map(([name, x]) => `${name} ${x}`);
  return [method === verb ? '' : method, ...given].filter(Boolean).join(', ');
}

/** A request in the list of steps. */
function listed(request) {
  return [TITLES[request.verb], said(request)].filter(Boolean).join(': ');
}

/**
 * The laboratory. `steps` are the meshes from the original to the result, each with the request
 * that made it and, by verb, those that were `asked` of it since; pictures show the first and the
 * last.
 */
class Laboratory {
  constructor(client, tables, maps) {
    this.client = client;
    this.tables = tables;
    this.steps = [];
    this.undone = [];
    this.forms = {};
    this.task = 'curvature';
    this.viewer = new Viewer(maps, {onPick: (vertex) => this.picked(vertex), labelled: (field) => this.labelled(field)});
    document.querySelector('.seen').prepend(this.viewer.controls, this.viewer.root);
    this.part = Object.fromEntries([...document.querySelectorAll('[data-part]')].map((e) => [e.dataset.part, e]));
    this.build();
  }

  build() {
    const {part, tables} = this;
    for (const {name, about} of tables.samples) {
      const button = element('button', {type: 'button', title: about}, name);
      button.addEventListener('click', () => this.sample(name));
      part.samples.append(button, ' ');
    }
    part.file.addEventListener('change', () => {
      const [file] = part.file.files;
      // Otherwise a file that has changed could not be opened again.
      part.file.value = '';
      this.read(file);
    });
    document.addEventListener('dragover', (e) => e.preventDefault());
    document.addEventListener('drop', (e) => {
      e.preventDefault();
      this.read(e.dataTransfer.files[0]);
    });
    document.addEventListener('paste', (e) => {
      if (e.target.closest?.('input')) return;
      const [file] = e.clipboardData.files;
      if (file) this.read(file);
      else this.fetched(e.clipboardData.getData('text/plain').trim());
    });
    document.addEventListener('keydown', (e) => {
      if (!(e.ctrlKey || e.metaKey) || e.key.toLowerCase() !== 'z' || e.target.closest?.('input')) return;
      e.preventDefault();
      if (e.shiftKey) this.redo();
      else this.undo();
    });
    for (const [task, title] of Object.entries(TITLES)) {
      this.forms[task] = new Form(tables.tasks[task], () => this.again());
      const button = element('button', {type: 'button', 'data-task': task}, title);
      button.addEventListener('click', () => this.turnTo(task));
      part.tasks.append(button);
    }
    for (const {name, extensions: [value]} of tables.formats) part.format.append(element('option', {value, selected: value === 'ply'}, name));
    const formats = tables.formats.map(({name}) => name).join(', ').replace(/, ([^,]*)$/, ' or $1');
    part.readable.textContent = ` (${formats})`;
    part.file.accept = [...tables.formats.flatMap(({extensions}) => extensions), 'gz'].map((end) => `.${end}`).join();
    part.format.addEventListener('input', () => this.settle());
    part.run.addEventListener('click', () => this.run(false));
    part.add.addEventListener('click', () => this.run(true));
    part.cancel.addEventListener('click', () => this.client.cancel());
    part.undo.addEventListener('click', () => this.undo());
    part.download.addEventListener('click', () => this.download());
    part.redo.addEventListener('click', () => this.redo());
    part.copy.addEventListener('click', () => this.copy());
    part.mode.addEventListener('input', () => this.guarded(() => this.mode(Number(part.mode.value))));
    this.turnTo(this.task);
  }

  turnTo(task) {
    this.task = task;
    for (const button of this.part.tasks.children) button.setAttribute('aria-pressed', button.dataset.task === task);
    this.part.form.replaceChildren(this.forms[task].place);
    this.settle();
  }

  /** Does something with the module; shows how far it is, and its error if it fails. */
  async guarded(work) {
    if (this.busy) return;
    this.busy = true;
    this.say('');
    this.settle();
    const start = performance.now();
    try {
      await work();
      this.took = performance.now() - start;
    } catch (error) {
      this.took = Infinity;
      if (error.isCancelled) this.say('Cancelled. The meshes are as before.');
      else this.say(error.message, 'error');
    }
    this.busy = false;
    this.part.progress.hidden = true;
    this.settle();
    if (this.changed) this.again();
  }

  call(request, bytes) {
    const {progress} = this.part;
    const onProgress = (stage, done, of) => {
      progress.hidden = false;
      progress.textContent = of ? `${stage}: ${done} of ${of}` : stage;
    };
    return this.client.call(request, {bytes, onProgress});
  }

  say(text, kind = 'hint') {
    this.part.words.className = kind;
    this.part.words.textContent = text;
  }

  // Meshes.

  async read(file) {
    if (!file) return;
    const bytes = new Uint8Array(await file.arrayBuffer());
    await this.open({verb: 'read', name: file.name}, file.name, bytes);
  }

  sample(name) {
    return this.open({verb: 'sample', name}, name);
  }

  /** Opens a mesh at an address on the server of the page. */
  async fetched(text) {
    try {
      const url = new URL(text, location.href);
      if (url.protocol === 'file:' || url.origin !== location.origin) {
        throw new Error(`${text} is not on the server of this page, and the page requests nothing from elsewhere`);
      }
      const response = await fetch(url);
      if (!response.ok) throw new Error(`${url.pathname}: ${response.status} ${response.statusText}`);
      await this.read(new File([await response.blob()], url.pathname.split('/').at(-1)));
    } catch (error) {
      this.say(`This address cannot be opened: ${error.message}.`, 'error');
    }
  }

  /** Opens the sample of an address and takes its steps. */
  async follow({sample, steps}) {
    await this.sample(sample);
    for (const step of steps) {
      if (this.took === Infinity) return;
      await this.guarded(() => this.does(step));
    }
  }

  open(request, name, bytes) {
    if (this.busy) return this.say('A computation is running: wait for it, or cancel it, and open the mesh again.', 'error');
    return this.guarded(async () => {
      const {value} = await this.call(request, bytes);
      const old = this.steps;
      this.steps = [];
      for (const {mesh} of old) await this.client.drop(mesh);
      this.undone = [];
      await this.push(value, name, request);
      this.name = request.verb === 'sample' ? `${name}.ply` : name;
      this.viewer.state.picked = -1;
      const {unwelded, faces, report} = value;
      if (!faces) this.say('This file has points without faces: there is nothing to draw and no neighbour to compute with.');
      else if (unwelded) this.say('The faces do not share their corners, as in STL files: run Repair first.');
      else this.say(report?.text ?? '');
      if (unwelded) this.turnTo('repair');
      await this.describe(value.mesh);
    });
  }

  /** Adds a mesh to the steps, with its fields. */
  async push(value, title, request) {
    const arrays = await this.client.mesh(value.mesh);
    const step = {mesh: value.mesh, title, request, arrays, fields: new Map(), asked: new Map(), report: value.report};
    await this.receive(step, value);
    this.steps.push(step);
    this.show();
  }

  /**
   * Takes fields of a mesh over. Computed values that are not defined are no numbers here, and
   * grey; those of a file are as they are.
   */
  async receive(step, {fields: names, computed}) {
    const {mesh, fields} = step;
    step.computed = new Set(computed);
    for (const name of names) fields.set(name, await this.client.field(mesh, name));
    const replace = (name, isDefined) => {
      if (step.computed.has(name)) fields.set(name, fields.get(name).map((x, v) => (isDefined(x, v) ? x : NaN)));
    };
    const defined = fields.get('defined');
    for (const name of CURVATURE.slice(0, 7)) replace(name, (x, v) => defined[v] !== 0);
    // Components without a source have the distance −1.
    replace('distance', (x) => x !== -1);
    step.losses = await this.losses(step);
  }

  /** Name and unit of a field; those of files have their own names. */
  labelled(name) {
    return this.ends().some(({computed}) => computed.has(name)) ? labelled(name) : [name, ''];
  }

  /** The fields of a mesh that each format leaves out. */
  async losses({mesh}) {
    return (await this.call({verb: 'losses', mesh})).value;
  }

  async pop() {
    const {mesh} = this.steps.pop();
    await this.client.drop(mesh);
  }

  undo() {
    if (this.steps.length > 1) this.guarded(async () => {
      this.undone.push(this.last.request);
      await this.pop();
      this.show();
      await this.follows();
      await this.describe(this.last.mesh);
    });
  }

  /** Takes the step again that was undone last. */
  redo() {
    if (this.undone.length) this.guarded(async () => {
      await this.take(this.undone.at(-1));
      this.undone.pop();
    });
  }

  get last() {
    return this.steps.at(-1);
  }

  /** The meshes that are shown. */
  ends() {
    return this.steps.length > 1 ? [this.steps[0], this.last] : this.steps;
  }

  show() {
    this.viewer.show(this.ends());
  }

  async describe(mesh) {
    const {value} = await this.call({verb: 'info', mesh});
    const yes = (holds) => (holds ? 'yes' : 'no');
    const rows = {
      edges: value.edges,
      components: value.components,
      'boundary loops': value.boundary_loops,
      genus: value.genus ?? 'undefined',
      manifold: yes(value.manifold),
      closed: yes(value.closed),
      'degenerate faces': value.degenerate_faces.count,
      area: `${readable(value.area)} file units²`,
      volume: value.volume === null ? 'undefined' : `${readable(value.volume)} file units³`,
      'mean edge length': `${readable(value.mean_edge)} file units`,
    };
    this.part.info.replaceChildren(...Object.entries(rows).flatMap(([name, x]) => [element('dt', {}, name), element('dd', {}, String(x))]));
  }

  // Tasks.

  /** Runs the task again after a change, if it was quick; after the current run if there is one. */
  again() {
    this.changed = this.busy === true;
    if (!this.changed && this.last?.request.verb === this.task && this.took < QUICK) this.run(false);
  }

  /** Runs the task; it replaces the result of the same task unless it shall be added. */
  run(add) {
    if (!this.steps.length) return this.say('Open a mesh first.');
    const {task} = this;
    const form = this.forms[task];
    const request = {verb: task, method: form.method, values: form.values()};
    return this.guarded(async () => {
      const replaces = !add && this.steps.length > 1 && this.last.request.verb === task;
      await this.does(request, replaces ? this.steps.at(-2) : this.last);
      if (!FIELDS[task] && task !== 'compare') this.undone = [];
    });
  }

  /**
   * Does what a request asks for; where it makes a mesh, that takes the place of those after the
   * base.
   */
  does(request, base = this.last) {
    if (request.verb === 'compare') return this.compare(request);
    if (request.verb === 'mode') return this.mode(Number(request.values.mode));
    return FIELDS[request.verb] ? this.addFields(request) : this.take(request, base);
  }

  /** Adds the result of a request on a mesh to the steps, in place of those after the mesh. */
  async take(request, base = this.last) {
    const {value} = await this.call({...request, mesh: base.mesh});
    while (this.last !== base) await this.pop();
    await this.push(value, listed(request), request);
    const again = await this.follows();
    await this.describe(value.mesh);
    const gone = value.dropped.filter((name) => !again.includes(name));
    const words = gone.length ? `Removed, because they describe the earlier positions: ${gone.map((name) => labelled(name)[0]).join(', ')}.` : '';
    this.say([reported(value.report), words].filter(Boolean).join(' '));
  }

  /**
   * Computes the curvature that is shown for a new result, too, unless that takes long. Returns the
   * names of the fields.
   */
  async follows() {
    const {request, took} = this.curvature ?? {};
    const isShown = this.steps[0].asked.has('curvature') && CURVATURE.includes(this.viewer.state.field);
    if (!isShown || took > QUICK) return [];
    await this.setFields(request);
    this.show();
    return CURVATURE;
  }

  /**
   * Adds the fields of a request to the meshes that are shown and do not have them yet. Returns the
   * names of fields of the file that they replace.
   */
  async setFields(request) {
    const replaced = new Set();
    for (const step of this.ends()) {
      const {verb} = request;
      const isNew = JSON.stringify(step.asked.get(verb)) !== JSON.stringify(request);
      // The modes of a mesh may have been replaced by those of another request.
      if (!isNew && verb !== 'spectrum') continue;
      const start = performance.now();
      const {value, arrays} = await this.call({...request, mesh: step.mesh});
      step.asked.set(verb, request);
      if (verb === 'curvature') this.curvature = {request, took: performance.now() - start};
      if (verb === 'spectrum') step.values = arrays.values;
      else await this.receive(step, value);
      for (const name of value.replaced ?? []) replaced.add(name);
      await this.client.keepOthers(step.mesh);
    }
    return [...replaced];
  }

  async addFields(request) {
    const replaced = await this.setFields(request);
    if (request.verb === 'spectrum') return this.mode(Math.min(5, this.last.values.length - 1));
    this.reveal(FIELDS[request.verb]);
    return this.say(replacing(replaced));
  }

  /** Shows a mode of the spectra. */
  async mode(number) {
    const words = [];
    const replaced = [];
    if (!this.last.values) throw new Error('There are no modes of the result yet.');
    this.part.mode.max = this.last.values.length - 1;
    this.part.mode.value = number;
    for (const step of this.ends()) {
      if (!step.values || number >= step.values.length) continue;
      const {value} = await this.call({verb: 'mode', mesh: step.mesh, mode: number});
      step.asked.set('mode', {verb: 'mode', method: '', values: {mode: String(number)}});
      await this.receive(step, {...value, fields: ['mode']});
      replaced.push(...value.replaced);
      words.push(readable(step.values[number]));
    }
    this.reveal('mode');
    this.say([`Mode ${number}: eigenvalue ${words.join(' and ')}.`, replacing(replaced)].filter(Boolean).join(' '));
  }

  reveal(field) {
    this.viewer.state.field = field;
    this.show();
  }

  async compare(request) {
    if (this.steps.length < 2) throw new Error('There is no result to compare with the original yet.');
    const {value} = await this.call({...request, mesh: this.last.mesh, reference: this.steps[0].mesh});
    const rows = value.scores.flatMap(({label, unit, value: x, reason}) => (
      reason ? [] : [element('dt', {}, label), element('dd', {}, measured(x, unit))]));
    this.part.info.replaceChildren(...rows);
    this.last.asked.set('compare', request);
  }

  picked(vertex) {
    if (vertex < 0) return this.say('');
    this.forms[this.task].take(vertex);
    this.say(this.viewer.describe(vertex));
    if (this.task === 'distance') this.run(false);
  }

  // Export.

  /** The steps in a language, or as a link. */
  written(language) {
    const [{request: first}] = this.steps;
    const meshes = this.steps.map(({request, asked}) => ({request, asked: [...asked.values()]}));
    if (language === 'link') return `${location.href.split('#')[0]}#${link(first.name, meshes)}`;
    const program = {shell, rust, python}[language](this.name, meshes);
    const note = `${this.name} is the sample ${first.name}, which the laboratory offers as a download.`;
    return first.verb === 'sample' ? `${language === 'rust' ? '//' : '#'} ${note}\n${program}` : program;
  }

  async copy() {
    try {
      await navigator.clipboard.writeText(this.written(this.part.language.value));
      this.say('Copied.');
    } catch (error) {
      this.say(`The browser does not let the page copy: ${error.message}`, 'error');
    }
  }

  download() {
    return this.guarded(async () => {
      const extension = this.part.format.value;
      const {arrays} = await this.call({verb: 'write', mesh: this.last.mesh, format: extension});
      const result = this.steps.length > 1 ? '-fairing' : '';
      const anchor = element('a', {download: `${stem(this.name)}${result}.${extension}`});
      anchor.href = URL.createObjectURL(new Blob([arrays.bytes]));
      anchor.click();
      URL.revokeObjectURL(anchor.href);
    });
  }

  settle() {
    const {part, steps} = this;
    const none = steps.length === 0;
    part.work.hidden = none;
    part.cancel.hidden = !this.busy;
    for (const name of ['run', 'add', 'undo', 'download']) part[name].disabled = this.busy === true || none;
    part.undo.disabled ||= steps.length < 2;
    part.redo.disabled = this.busy === true || !this.undone.length;
    part.copy.disabled = steps.length < 2 && !steps[0]?.asked.size;
    part.language.querySelector('[value=link]').disabled = steps[0]?.request.verb !== 'sample';
    part.lost.textContent = leftOut(part.format.selectedOptions[0].text, this.last?.losses[part.format.value] ?? [], (name) => this.labelled(name));
    part.add.hidden = Boolean(FIELDS[this.task]) || this.task === 'compare' || steps.length < 2;
    part.modes.hidden = this.task !== 'spectrum' || !this.last?.values;
    part.steps.replaceChildren(...steps.map(({title, asked}, i) => {
      const line = element('li', {}, i ? title : `Opened: ${title}`);
      const fields = [...asked.values()].filter(({verb}) => verb !== 'mode');
      if (fields.length) line.append(element('ul', {}, ...fields.map((one) => element('li', {}, listed(one)))));
      return line;
    }));
    document.body.classList.toggle('busy', this.busy === true);
  }
}

async function start() {
  followTheme();
  if (!Renderer) throw new Error('This browser has no WebGL 2, without which nothing can be drawn.');
  const client = await clientOfPage();
  const {value: tables} = await client.call({verb: 'tables'});
  const laboratory = new Laboratory(client, tables, colorMaps());
  document.querySelector('[data-part="loading"]').remove();
  window.laboratory = laboratory;
  const given = linked(location.hash.slice(1));
  if (given) await laboratory.follow(given);
  document.documentElement.dataset.ready = '1';
}

start().catch((error) => {
  document.querySelector('[data-part="loading"]').textContent = error.message;
});
