import {clientOfPage} from '../../web/assets/page.mjs';

/** The module of Fairing for the whole page; it loads when it is first asked for. */
export const Computing = {
  client() {
    this.started ??= clientOfPage();
    return this.started;
  },

  async call(request) {
    return (await this.client()).call(request);
  },

  /** The number of a mesh that the page has made; it stays in the module until `drop`. */
  async add(positions, faces) {
    return (await this.client()).add(Float64Array.from(positions), faces);
  },

  async drop(mesh) {
    if (mesh !== undefined) await (await this.client()).drop(mesh);
  },

  /**
   * Calls `use` with the mesh that a verb makes of another one, and with its positions, then drops
   * it.
   */
  async made(request, use = (mesh, positions) => positions) {
    const {value, arrays} = await this.call(request);
    try {
      return await use(value.mesh, arrays.positions);
    } finally {
      await this.drop(value.mesh);
    }
  },

  /**
   * Mean and Gaussian curvature of a mesh by cotangents and angle defects; vertices on the boundary
   * have none.
   */
  async curvature(mesh) {
    await this.call({verb: 'curvature', method: 'cotangent', mesh});
    const field = async (name) => (await this.call({verb: 'field', mesh, name})).arrays.values;
    const [mean, gaussian, defined, boundary] = await Promise.all(['mean', 'gaussian', 'defined', 'boundary'].map(field));
    const inside = (x, v) => (defined[v] && !boundary[v] ? x : NaN);
    return {mean: mean.map(inside), gaussian: gaussian.map(inside)};
  },

  /** Scores of a mesh against another one with the same faces. */
  async matching(mesh, reference) {
    return (await this.call({verb: 'compare', mesh, reference, matching: true})).value;
  },
};
