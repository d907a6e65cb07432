/** The most values from which a range is estimated. */
const SAMPLED = 200_000;

/**
 * The least and greatest of most values: the 2nd and 98th percentile, about zero where there are both signs. Of many
 * values every second or third one counts.
 */
export function rangeOf(lists) {
  const step = Math.ceil(lists.reduce((sum, {length}) => sum + length, 0) / SAMPLED);
  const sorted = new Float64Array(lists.reduce((sum, {length}) => sum + Math.ceil(length / step), 0));
  let count = 0;
  for (const values of lists) {
    for (let i = 0; i < values.length; i += step) if (Number.isFinite(values[i])) sorted[count++] = values[i];
  }
  if (!count) return [0, 1];
  sorted.subarray(0, count).sort();
  const at = (part) => sorted[Math.round(part * (count - 1))];
  let [low, high] = [at(0.02), at(0.98)];
  if (low < 0 && high > 0) {
    high = Math.max(-low, high);
    low = -high;
  }
  if (!(low < high)) [low, high] = [low - 0.5 * (Math.abs(low) || 1), high + 0.5 * (Math.abs(high) || 1)];
  return [low, high].map((x) => Number(x.toPrecision(3)));
}

/**
 * Meshes side by side under one camera, drawn by the renderer of the report. A mesh is `{title, arrays, fields}`:
 * positions, faces and normals, and a map of values by the names of fields.
 */
export class Viewer extends Drawn {
  /** `labelled` gives the name and the unit of a field in words. */
  constructor(place, maps, picked, labelled = (field) => [field, '']) {
    super();
    this.labelled = labelled;
    this.maps = maps;
    this.picked = picked;
    this.camera = new Camera(25, 15);
    this.state = {field: null, wire: false, lines: false, flat: false, vertex: -1};
    this.shown = [];
    this.place = place;
    this.fit = new ResizeObserver(() => this.resize());
  }

  /** Shows these meshes; the first one decides where the camera looks. */
  show(meshes) {
    const [first] = meshes;
    if (first) this.ball = ballOf(first.arrays.positions);
    this.fit.disconnect();
    this.shown = meshes.map((mesh) => this.panel(mesh));
    this.place.replaceChildren(...this.shown.map(({panel}) => panel));
    for (const {canvas} of this.shown) this.fit.observe(canvas);
    this.resize();
    this.settle();
  }

  panel(mesh) {
    const canvas = steeredCanvas(mesh.title);
    const bar = element('div', {class: 'bar'});
    const {positions, faces} = mesh.arrays;
    const facts = `${positions.length / 3} vertices, ${faces.length / 3} faces`;
    const words = element('p', {class: 'facts-line'}, element('span', {class: 'fact'}, facts));
    const panel = element('div', {class: 'panel'}, element('h4', {}, mesh.title), canvas, words, bar);
    mesh.drawn ??= drawn(mesh.arrays);
    const shown = {mesh, canvas, bar, panel, target: canvas.getContext('2d')};
    steer(canvas, this.camera, {
      moved: () => this.turnTo(),
      stepped: () => this.redraw(),
      rested: () => {},
      picked: (x, y) => this.pick(shown, x, y),
      next: (by) => {
        const count = mesh.drawn.vertices;
        this.choose((Math.max(this.state.vertex, by > 0 ? -1 : 0) + by + count) % count);
      },
    });
    return shown;
  }

  pick(shown, x, y) {
    this.choose(vertexAt(this.scene(shown), shown.canvas, (v) => this.seen(shown, v), x, y));
  }

  choose(vertex) {
    this.state.vertex = vertex;
    this.picked(vertex);
    this.redraw();
  }

  change(what) {
    Object.assign(this.state, what);
    if ('field' in what) this.settle();
    else this.redraw();
  }

  /** The scene of a panel, for the renderer. Positions are scaled to the ball of the first mesh. */
  scene({mesh}) {
    const {field, wire, lines, flat} = this.state;
    return {
      mesh: mesh.drawn,
      shape: this.shape(mesh),
      values: mesh.fields.get(field) ?? null,
      camera: this.camera,
      lookup: this.lookup,
      range: this.range,
      pixel: this.pixel,
      wire,
      lines,
      flat,
    };
  }

  shape({drawn, arrays}) {
    if (drawn.ball === this.ball) return drawn.shape;
    const {center, radius} = this.ball;
    const points = new Float32Array(4 * drawn.vertices);
    const normals = new Float32Array(4 * drawn.vertices);
    for (let v = 0; v < drawn.vertices; v++) {
      for (let k = 0; k < 3; k++) {
        points[4 * v + k] = (arrays.positions[3 * v + k] - center[k]) / radius;
        normals[4 * v + k] = arrays.normals[3 * v + k];
      }
      points[4 * v + 3] = 1;
    }
    drawn.ball = this.ball;
    drawn.shape = {points, normals};
    return drawn.shape;
  }

  seen({mesh, canvas}, v) {
    const point = this.shape(mesh).points.subarray(4 * v, 4 * v + 3);
    return this.camera.place(point, canvas.width, canvas.height);
  }

  /** Brings colours and colour bars into line with the state. */
  settle() {
    const {field} = this.state;
    const lists = this.shown.map(({mesh}) => mesh.fields.get(field)).filter(Boolean);
    this.range = rangeOf(lists);
    this.lookup = this.maps[this.range[0] < 0 && this.range[1] > 0 ? 'coolwarm' : 'viridis'];
    const lookup = stretched(this.lookup);
    for (const {mesh, bar, panel} of this.shown) {
      const values = mesh.fields.get(field);
      const across = panel.clientWidth || undefined;
      const [name, unit] = this.labelled(field);
      const made = values ? [colorBar({values, range: this.range, lookup, name, unit, across})] : [];
      bar.replaceChildren(...made);
    }
    this.redraw();
  }

  resize() {
    this.pixel = Math.min(window.devicePixelRatio || 1, 2);
    for (const {canvas} of this.shown) fitCanvas(canvas, this.pixel);
    this.redraw();
  }

  draw() {
    if (!this.lookup) return;
    if (this.moving) Renderer.drawMoving(this.shown.map((shown) => ({target: shown.target, scene: this.scene(shown)})), 0.5);
    for (const shown of this.shown) {
      if (!this.moving) Renderer.draw(shown.target, this.scene(shown));
      const {vertex} = this.state;
      if (vertex >= 0 && vertex < shown.mesh.drawn.vertices) ring(shown.target, this.seen(shown, vertex), this.pixel);
    }
  }
}

/** What the renderer keeps of a mesh. */
function drawn({positions, faces}) {
  const vertices = positions.length / 3;
  return {faces, vertices, zeros: new Float32Array(vertices)};
}

/** The ball about the middle of the box that holds all positions. */
function ballOf(positions) {
  const [low, high] = [[Infinity, Infinity, Infinity], [-Infinity, -Infinity, -Infinity]];
  for (let i = 0; i < positions.length; i += 3) {
    for (let k = 0; k < 3; k++) {
      const x = positions[i + k];
      if (x < low[k]) low[k] = x;
      if (x > high[k]) high[k] = x;
    }
  }
  const center = low.map((x, k) => 0.5 * (x + high[k]));
  const [x, y, z] = center;
  let square = 0;
  for (let i = 0; i < positions.length; i += 3) {
    const [dx, dy, dz] = [positions[i] - x, positions[i + 1] - y, positions[i + 2] - z];
    square = Math.max(square, dx * dx + dy * dy + dz * dz);
  }
  return {center, radius: Math.sqrt(square) || 1};
}

/** A colour map with the 1024 entries that a colour bar has. */
function stretched(map) {
  const colors = new Uint8Array(3 * 1024);
  for (let i = 0; i < 1024; i++) {
    const k = 3 * Math.round((i / 1023) * (map.length / 3 - 1));
    colors.set(map.subarray(k, k + 3), 3 * i);
  }
  return colors;
}
