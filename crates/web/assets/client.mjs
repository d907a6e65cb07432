/**
 * The side of the page: requests as promises, answered in their order by a worker that owns the
 * module.
 *
 * A busy worker receives no messages, so cancelling ends it; a new one takes over the meshes, of
 * which the page has copies. The same happens after a defect or where memory runs out: `call`
 * fails, and the next one succeeds.
 */
export class Client {
  #module;
  #start;
  #worker;
  #waiting = new Map(); // requests without an answer, by their number
  #last = 0;
  #held = new Map(); // copies of meshes, by their number

  /** `start` makes a worker that runs `worker.mjs`; `module` is the compiled module. */
  constructor(module, start) {
    this.#module = module;
    this.#start = start;
    this.#begin();
  }

  #begin() {
    this.#worker = this.#start();
    this.#worker.onmessage = ({data}) => this.#take(data);
    this.#worker.onerror = (event) => this.#restart(`the worker failed: ${event.message}`);
    this.#worker.postMessage({module: this.#module});
  }

  /**
   * Answers a request: `{value, arrays}`. `bytes` are those of a file, and are copied; `onProgress`
   * takes the name of a stage, the parts done and their number, 0 if unknown.
   */
  call(request, {bytes, onProgress} = {}) {
    return new Promise((resolve, reject) => {
      const id = ++this.#last;
      this.#waiting.set(id, {resolve, reject, onProgress});
      this.#worker.postMessage({id, request, bytes});
    });
  }

  /**
   * Positions, faces and normals of a mesh, of which the page keeps a copy with all fields until
   * `drop`.
   */
  async mesh(number) {
    const known = this.#held.get(number);
    if (known) return known;
    const {arrays} = await this.call({verb: 'mesh', mesh: number});
    const held = {...arrays, fields: new Map(), computed: new Set()};
    this.#held.set(number, held);
    await this.keepOthers(number);
    return held;
  }

  /**
   * Copies the fields of a mesh that are not scalars of vertices: once for a mesh, and after a
   * request that sets some.
   */
  async keepOthers(number) {
    const {value, arrays} = await this.call({verb: 'others', mesh: number});
    const held = this.#held.get(number);
    if (held) held.others = {list: value.fields, bytes: arrays.bytes};
  }

  /**
   * Gives a mesh that the page has made to the module, and keeps it until `drop`; the answer is its
   * number.
   */
  async add(positions, faces) {
    const held = {positions, faces, fields: new Map(), computed: new Set()};
    const {value} = await this.call(...adoption(held));
    this.#held.set(value.mesh, held);
    return value.mesh;
  }

  /** The values of a field of a mesh. */
  async field(number, name) {
    const {value, arrays} = await this.call({verb: 'field', mesh: number, name});
    const held = this.#held.get(number);
    held?.fields.set(name, arrays.values);
    if (value.computed) held?.computed.add(name);
    return arrays.values;
  }

  /** Forgets a mesh. */
  drop(number) {
    this.#held.delete(number);
    return this.call({verb: 'drop', mesh: number});
  }

  /**
   * Ends all requests without an answer: their promises fail with an error that has `isCancelled`.
   */
  cancel() {
    if (this.#waiting.size > 0) this.#restart('cancelled', true);
  }

  #take({id, stage, done, of, value, arrays, error, isBroken}) {
    const waiting = this.#waiting.get(id);
    if (!waiting) return;
    if (stage !== undefined) {
      waiting.onProgress?.(stage, done, of);
      return;
    }
    this.#waiting.delete(id);
    if (error === undefined) {
      waiting.resolve({value, arrays});
      return;
    }
    waiting.reject(new Error(error));
    if (isBroken) this.#restart('the request before this one failed');
  }

  #restart(words, isCancelled = false) {
    this.#worker.terminate();
    const ended = [...this.#waiting.values()];
    this.#waiting.clear();
    this.#begin();
    for (const [number, held] of this.#held) this.#hand(number, held);
    for (const {reject} of ended) reject(Object.assign(new Error(words), {isCancelled}));
  }

  /** Gives a mesh to a new worker. */
  #hand(number, held) {
    const [request, options] = adoption(held);
    this.call({...request, mesh: number}, options).catch(() => this.#held.delete(number));
  }
}

/** The request that hands a mesh with its fields over, and its bytes. */
function adoption({positions, faces, fields, computed, others = {list: [], bytes: new Uint8Array()}}) {
  const parts = [positions, faces, ...fields.values(), others.bytes];
  const bytes = new Uint8Array(parts.reduce((sum, part) => sum + part.byteLength, 0));
  let at = 0;
  for (const part of parts) {
    bytes.set(new Uint8Array(part.buffer, part.byteOffset, part.byteLength), at);
    at += part.byteLength;
  }
  const counts = {vertices: positions.length / 3, faces: faces.length / 3};
  const list = [...[...fields.keys()].map((name) => ['scalar', name, computed.has(name)]), ...others.list];
  return [{verb: 'adopt', ...counts, fields: list}, {bytes}];
}
