/**
 * The module of Fairing: an instance with a memory of its own, and the meshes in it. Requests and
 * answers are those of `crates/web/src/memory.rs`. After an error with `isBroken` the instance must
 * not be used again.
 */
export class Engine {
  /** `onProgress` takes the name of a stage, the parts done and their number, 0 if unknown. */
  constructor(module, onProgress = () => {}) {
    let panic = null;
    let shown = -Infinity;
    const page = {
      progress: (address, length, done, of) => {
        const now = performance.now();
        if (done > 0 && now - shown < 50) return;
        shown = now;
        onProgress(this.#text(address, length), done, of);
      },
      panicked: (address, length) => {
        panic = this.#text(address, length);
      },
    };
    this.exports = new WebAssembly.Instance(module, {page}).exports;
    this.#panic = () => panic;
  }

  #panic;

  #text(address, length) {
    return new TextDecoder().decode(new Uint8Array(this.exports.memory.buffer, address, length));
  }

  /** Bytes of memory in use; they never become fewer. */
  get size() {
    return this.exports.memory.buffer.byteLength;
  }

  /**
   * Answers a request, with the bytes that belong to it. The arrays of the answer are views of the
   * memory of the module: they are gone with the next call.
   */
  call(request, bytes = new Uint8Array()) {
    const text = new TextEncoder().encode(JSON.stringify(request));
    let answer;
    try {
      const room = this.exports.input(text.length + bytes.length) >>> 0;
      const memory = new Uint8Array(this.exports.memory.buffer, room, text.length + bytes.length);
      memory.set(text);
      memory.set(bytes, text.length);
      const address = this.exports.call(text.length) >>> 0;
      answer = JSON.parse(this.#text(address, this.exports.answer_length()));
    } catch (error) {
      throw this.#broken(error);
    }
    if (answer.error !== undefined) throw new Error(answer.error);
    const kinds = {f64: Float64Array, u32: Uint32Array, u8: Uint8Array};
    const view = ([name, kind, address, length]) => [name, new kinds[kind](this.exports.memory.buffer, address, length)];
    return {value: answer.value, arrays: Object.fromEntries(answer.arrays.map(view))};
  }

  #broken(error) {
    const panic = this.#panic();
    const used = `${Math.round(this.size / 2 ** 20)} MB in use`;
    // An allocation that fails ends without a message; one beyond all addresses panics.
    const isMemory = panic ? panic.includes('capacity overflow') : /unreachable/i.test(error.message);
    let words = `a defect of Fairing, please report it: ${panic ?? error.message}`;
    if (isMemory) words = `the computation was ended: it needs more memory than a page can have (${used})`;
    return Object.assign(new Error(words), {isBroken: true});
  }
}
