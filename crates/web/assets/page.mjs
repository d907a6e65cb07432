import {Client} from './client.mjs';

/**
 * The bytes of a text of digits to the base 85, as `crates/report/src/base85.rs` writes it.
 */
export function bytesOfDigits(text) {
  const bytes = new Uint8Array(Math.floor((4 * text.length) / 5));
  for (let at = 0, i = 0; at < bytes.length; at += 4, i += 5) {
    let number = 0;
    for (let k = 0; k < 5; k++) {
      const code = i + k < text.length ? text.charCodeAt(i + k) : 124;
      number = 85 * number + (code === 125 ? 20 : code - 40);
    }
    for (let k = 0; k < 4 && at + k < bytes.length; k++) bytes[at + k] = number >>> (24 - 8 * k);
  }
  return bytes;
}

/** Lets the browser draw and answer in between. */
export const pause = () => new Promise((done) => setTimeout(done));

/**
 * A client of the module that the page carries: the element `module` holds its bytes, compressed by
 * gzip, in digits, the element `worker` the script of a worker. Works in pages from disk too.
 */
export async function clientOfPage() {
  const textOf = (id) => document.getElementById(id).textContent;
  await pause();
  const packed = new Blob([bytesOfDigits(textOf('module'))]).stream().pipeThrough(new DecompressionStream('gzip'));
  const module = await WebAssembly.compile(await new Response(packed).arrayBuffer());
  const source = URL.createObjectURL(new Blob([textOf('worker')], {type: 'text/javascript'}));
  return new Client(module, () => new Worker(source));
}
