import {bytesOfDigits} from '../../web/assets/page.mjs';

/**
 * Reading of the data that the page carries.
 *
 * Each view has one block: digits to the base 85 of a zlib stream of arrays, one after another, in the order in which the view's description asks for them. Numbers
 * are stored as differences to their predecessor, zigzag-coded, and split into
 * planes of bytes, which compress well. The writer is `views/pack.rs`.
 */
export class Block {
  static async unpack(text) {
    const packed = bytesOfDigits(text);
    const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream('deflate'));
    return new Block(new Uint8Array(await new Response(stream).arrayBuffer()));
  }

  constructor(bytes) {
    this.bytes = bytes;
    this.at = 0;
  }

  raw(count) {
    const from = this.at;
    this.at += count;
    if (this.at > this.bytes.length) throw new Error('the data of the view end too early');
    return this.bytes.subarray(from, this.at);
  }

  /** 32-bit integers, as differences. */
  integers(count) {
    const planes = this.raw(4 * count);
    const out = new Uint32Array(count);
    let last = 0;
    for (let i = 0; i < count; i++) {
      const code =
        planes[i] | (planes[count + i] << 8) | (planes[2 * count + i] << 16) |
        (planes[3 * count + i] << 24);
      last = (last + ((code >>> 1) ^ -(code & 1))) | 0;
      out[i] = last;
    }
    return out;
  }

  /** 16-bit integers with several components, as differences; interleaved. */
  shorts(count, components) {
    const out = new Uint16Array(count * components);
    for (let c = 0; c < components; c++) {
      const planes = this.raw(2 * count);
      let last = 0;
      for (let i = 0; i < count; i++) {
        const code = planes[i] | (planes[count + i] << 8);
        last = (last + ((code >> 1) ^ -(code & 1))) & 0xffff;
        out[i * components + c] = last;
      }
    }
    return out;
  }

  /** Double precision, bit by bit, as exclusive-or with the predecessor. */
  doubles(count, components) {
    const out = new Float64Array(count * components);
    const words = new Uint32Array(2);
    const value = new Float64Array(words.buffer);
    for (let c = 0; c < components; c++) {
      const planes = this.raw(8 * count);
      words.fill(0);
      for (let i = 0; i < count; i++) {
        for (let half = 0; half < 2; half++) {
          let word = 0;
          for (let b = 0; b < 4; b++) word |= planes[(4 * half + b) * count + i] << (8 * b);
          words[half] ^= word;
        }
        out[i * components + c] = value[0];
      }
    }
    return out;
  }
}

/** The panels of a view, decoded. Positions are in mesh units. */
export function decodeView(description, block) {
  const faceLists = description.faceLists.map((count) => block.integers(3 * count));
  const panels = [];
  for (const panel of description.panels) panels.push(decodePanel(panel));
  block.truth = decodeTruth(description.truth, panels, block);
  return panels;

  function decodePanel(panel) {
    const n = panel.vertices;
    let before = null;
    const decoded = [];
    for (const {low, size, follows, same, panel: other} of panel.stops) {
      if (same !== undefined) {
        decoded.push(other === undefined ? decoded[same] : panels[other].stops[same]);
        continue;
      }
      const q = block.shorts(n, 3);
      if (follows) for (let i = 0; i < q.length; i++) q[i] = (q[i] + before[i]) & 0xffff;
      before = q;
      decoded.push(positionsIn({low, size}, q));
    }
    const occlusion = block.raw(n);
    const read = (field) => Float32Array.from(block.shorts(n, 1), (q) => dequantised(q, field));
    const fields = panel.fields.map((field) => ({
      ...field,
      stops: Array.from({length: field.stops}, () => read(field)),
      exact: field.exact ? read(field) : null,
    }));
    const live = panel.live ? block.doubles(n, 3) : null;
    const modes = panel.modes ? decodeModes(panel.modes, n, block) : null;
    return {...panel, faces: faceLists[panel.faces], stops: decoded, occlusion, fields, live, modes};
  }
}

/** True positions: those of a panel, or of their own. */
function decodeTruth(truth, panels, block) {
  if (!truth) return null;
  if (truth.panel !== undefined) return panels[truth.panel].stops[truth.stop];
  return positionsIn(truth, block.shorts(truth.vertices, 3));
}

/** Places in a box, in 65535ths. */
function positionsIn({low, size}, q) {
  return Float64Array.from(q, (x, i) => low[i % 3] + (size[i % 3] * x) / 65535);
}

/** Each mode has 65535 steps from minus its largest size to plus. */
function decodeModes({values, coefficients, sizes}, n, block) {
  const vectors = sizes.map((size) => Float32Array.from(block.shorts(n, 1), (q) => size * (q / 32767 - 1)));
  return {values, coefficients, vectors};
}

/** See `quantise` in `views/pack.rs`; 65535 marks an undefined value. */
function dequantised(q, {scale, low, high}) {
  if (q === 65535) return NaN;
  return scale * Math.sinh(low + ((high - low) * q) / 65534);
}
