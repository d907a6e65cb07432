import {Client} from './client.mjs';
import {unzipped} from '../../figure/viewer/bytes.mjs';

/** Lets the browser draw and answer in between. */
export const pause = () => new Promise((done) => setTimeout(done));

/**
 * A client of the module that the page carries: the element `module` holds its bytes, compressed by
 * gzip, in base64, the element `worker` the script of a worker. Works in pages from disk too.
 */
export async function clientOfPage() {
  const textOf = (id) => document.getElementById(id).textContent;
  await pause();
  const module = await WebAssembly.compile(await unzipped(textOf('module')));
  const source = URL.createObjectURL(new Blob([textOf('worker')], {type: 'text/javascript'}));
  return new Client(module, () => new Worker(source));
}
