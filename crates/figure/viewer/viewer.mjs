import {Camera} from './camera.mjs';
import {lookupOf, rangeOf} from './colors.mjs';
import {element} from './dom.mjs';
import {ballOf, shape} from './geometry.mjs';
import {Picture, Pictures} from './pictures.mjs';

/**
 * Meshes side by side under one camera. A mesh is `{title, arrays, fields}`: positions, faces and
 * normals, and a map of values by the names of fields.
 */
export class Viewer extends Pictures {
  /**
   * `root` holds the panels, `chosen` is told of a picked vertex, `labelled` gives name and unit of
   * a field.
   */
  constructor(root, maps, chosen, {camera = new Camera(25, 15), labelled = (field) => [field, '']} = {}) {
    super();
    Object.assign(this, {root, maps, chosen, camera, labelled});
    this.picked = -1;
    this.state = {field: null, wire: false, lines: false, flat: false};
  }

  /** Lets the controls of a page say how meshes are shown. */
  follow({field, reset, ...parts}) {
    field.addEventListener('input', () => this.change({field: field.value || null}));
    for (const key of ['lines', 'wire', 'flat']) {
      parts[key].addEventListener('input', () => this.change({[key]: parts[key].checked}));
    }
    reset.addEventListener('click', () => {
      this.camera.reset();
      this.redraw();
    });
  }

  /** Shows these meshes; the first one decides where the camera looks. */
  show(meshes) {
    const [first] = meshes;
    if (first) this.ball = ballOf(first.arrays.positions);
    this.fit.disconnect();
    this.shown = [];
    for (const mesh of meshes) this.add(this.picture(mesh));
    this.root.replaceChildren(...this.shown.map(({panel}) => panel));
    this.settle();
  }

  picture(mesh) {
    const {positions, faces} = mesh.arrays;
    const picture = Object.assign(new Picture(mesh.title, mesh.title), {mesh});
    const counts = `${positions.length / 3} vertices, ${faces.length / 3} faces`;
    picture.facts.append(element('span', {class: 'fact'}, counts));
    picture.facts.hidden = false;
    mesh.drawn ??= {faces, vertices: positions.length / 3};
    return picture;
  }

  choose(vertex) {
    this.picked = vertex;
    this.chosen(vertex);
    this.redraw();
  }

  change(what) {
    Object.assign(this.state, what);
    if ('field' in what) this.settle();
    else this.redraw();
  }

  scene({mesh}) {
    const {field, ...switches} = this.state;
    const {lookup, range} = this;
    const values = mesh.fields.get(field) ?? null;
    return {mesh: mesh.drawn, shape: this.shape(mesh), values, lookup, range, ...switches};
  }

  /** Points and normals of a mesh, scaled to the ball of the first one. */
  shape({drawn, arrays: {positions, normals}}) {
    if (drawn.ball !== this.ball) {
      drawn.ball = this.ball;
      drawn.shape = shape(positions, normals, this.ball);
    }
    return drawn.shape;
  }

  /** Brings colours and colour bars into line with the state, and draws. */
  settle() {
    const {field} = this.state;
    const lists = this.shown.map(({mesh}) => mesh.fields.get(field)).filter(Boolean);
    this.range = rangeOf(lists);
    this.lookup = lookupOf(this.maps[this.range[0] < 0 && this.range[1] > 0 ? 'coolwarm' : 'viridis']);
    const {range, lookup} = this;
    const [name, unit] = this.labelled(field);
    for (const picture of this.shown) {
      const values = picture.mesh.fields.get(field);
      picture.explain(values && {values, range, lookup, name, unit});
    }
    this.redraw();
  }
}
