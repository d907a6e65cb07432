import {Camera} from './camera.mjs';
import {lookupOf, rangeOf} from './colors.mjs';
import {element, readable} from './dom.mjs';
import {ballOf, normals, shape} from './geometry.mjs';
import {Picture, Pictures} from './pictures.mjs';

/** Switches of the display and their labels. */
const SWITCHES = {lines: 'isolines', wire: 'edges', flat: 'flat'};

/**
 * Meshes side by side under one camera, in `root`, with `controls` of the display. A mesh is
 * `{title, arrays, fields}`: positions, faces and perhaps normals, and a map of values by the names
 * of fields.
 */
export class Viewer extends Pictures {
  /**
   * `onPick` takes a picked vertex, `labelled` returns name and unit of a field; values are written
   * with `digits`.
   */
  constructor(maps, {onPick = () => {}, camera = new Camera(25, 15), labelled = (field) => [field, ''], digits = 3} = {}) {
    super();
    Object.assign(this, {maps, onPick, camera, labelled, digits});
    this.state = {field: null, wire: false, lines: false, flat: false, picked: -1};
    this.root = element('div', {class: 'panels'});
    this.controls = this.display();
  }

  display() {
    const field = element('select', {'data-part': 'field'});
    field.addEventListener('input', () => this.change({field: field.value || null}));
    this.field = field;
    this.switches = Object.keys(SWITCHES).map((key) => {
      const box = element('input', {type: 'checkbox', 'data-part': key});
      box.addEventListener('input', () => this.change({[key]: box.checked}));
      return box;
    });
    const boxes = this.switches.map((box) => element('label', {}, box, ` ${SWITCHES[box.dataset.part]}`));
    this.colored = [element('label', {}, 'colour by ', field), boxes[0]];
    const reset = element('button', {type: 'button', 'data-part': 'reset'}, 'reset the view');
    reset.addEventListener('click', () => this.reset());
    return element('div', {class: 'controls', role: 'group', 'aria-label': 'display'}, this.colored[0], ...boxes, reset);
  }

  reset() {
    this.camera.reset();
    this.redraw();
  }

  get picked() {
    return this.state.picked;
  }

  /** Shows these meshes; the camera looks at `ball`, which is that of the first one. */
  show(meshes, ball = meshes.length ? ballOf([this.positions(meshes[0])]) : null) {
    this.ball = ball;
    this.fit.disconnect();
    this.shown = [];
    for (const mesh of meshes) {
      mesh.drawn ??= {faces: mesh.arrays.faces, vertices: mesh.arrays.positions.length / 3};
      this.add(this.picture(mesh));
    }
    this.root.replaceChildren(...this.shown.map(({panel}) => panel));
    const names = this.names();
    if (!names.includes(this.state.field)) this.state.field = null;
    const option = (name) => element('option', {value: name}, this.labelled(name)[0]);
    this.field.replaceChildren(...names.map(option), element('option', {value: ''}, 'nothing'));
    for (const part of this.colored) part.hidden = !names.length;
    this.settle();
  }

  picture(mesh) {
    const picture = Object.assign(new Picture(mesh.title, `${mesh.title}.`), {mesh});
    const {vertices, faces} = mesh.drawn;
    picture.facts.append(element('span', {class: 'fact'}, `${vertices} vertices, ${faces.length / 3} faces`));
    picture.facts.hidden = false;
    return picture;
  }

  choose(picked) {
    this.change({picked});
    this.onPick(picked);
  }

  change(what) {
    Object.assign(this.state, what);
    this.settle();
  }

  scene({mesh, values = null}) {
    const {lookup, range, state: {wire, lines, flat}} = this;
    return {mesh: mesh.drawn, shape: this.shape(mesh), values, lookup, range, wire, lines, flat};
  }

  /** Names of all fields that meshes can be coloured by. */
  names() {
    return [...new Set(this.shown.flatMap(({mesh}) => [...mesh.fields.keys()]))];
  }

  /** Where the vertices of a mesh are. */
  positions({arrays}) {
    return arrays.positions;
  }

  /** Values of the chosen field at the vertices of a mesh; null if it has none. */
  values({fields}) {
    return fields.get(this.state.field) ?? null;
  }

  /** The values at the ends of the colours. */
  ends() {
    return rangeOf(this.shown.map(({values}) => values).filter(Boolean));
  }

  /** Position and values of a vertex in each mesh that is seen. */
  describe(vertex) {
    const seen = this.shown.filter(({mesh, panel}) => !panel.hidden && vertex < mesh.drawn.vertices);
    const parts = seen.map(({mesh}) => {
      const place = [...this.positions(mesh).subarray(3 * vertex, 3 * vertex + 3)];
      const words = place.map((x) => readable(x, this.digits + 1)).join(', ');
      return [`${mesh.title}: (${words})`, ...this.valuesAt(mesh, vertex)].join('; ');
    });
    return `Vertex ${vertex}. ${parts.join('. ')}.`;
  }

  valuesAt({fields}, vertex) {
    return [...fields].map(([name, values]) => `${this.labelled(name)[0]} ${readable(values[vertex], this.digits)}`);
  }

  /** Points and normals of a mesh, scaled to the ball of the camera. */
  shape(mesh) {
    const {ball} = this;
    const {drawn} = mesh;
    const positions = this.positions(mesh);
    if (drawn.ball !== ball || drawn.positions !== positions) {
      const directions = mesh.arrays?.normals ?? normals(positions, drawn.faces);
      Object.assign(drawn, {ball, positions, shape: shape(positions, directions, ball)});
    }
    return drawn.shape;
  }

  /** Brings colours, colour bars and controls into line with the state, and draws. */
  settle() {
    const {state} = this;
    this.field.value = state.field ?? '';
    for (const box of this.switches) box.checked = state[box.dataset.part];
    for (const picture of this.shown) picture.values = picture.panel.hidden ? null : this.values(picture.mesh);
    this.range = this.ends();
    this.lookup = lookupOf(this.maps[this.range[0] < 0 && this.range[1] > 0 ? 'coolwarm' : 'viridis']);
    const {range, lookup} = this;
    const [name, unit] = this.labelled(state.field);
    for (const picture of this.shown) {
      const {values} = picture;
      picture.explain(values && {values, range, lookup, name, unit});
    }
    this.draw();
  }
}
