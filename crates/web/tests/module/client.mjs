// node client.mjs MODULE: the client with workers that are threads of Node.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {Worker} from 'node:worker_threads';
import {gunzipSync} from 'node:zlib';
import {Client} from '../../assets/client.mjs';

// What a browser gives to the script of a worker.
const script = JSON.stringify(new URL('../../assets/worker.mjs', import.meta.url).href);
const source = `
const {parentPort} = require('node:worker_threads');
globalThis.self = {postMessage: (message, parts) => parentPort.postMessage(message, parts)};
const early = [];
parentPort.on('message', (data) => (self.onmessage ? self.onmessage({data}) : early.push(data)));
import(${script}).then(() => early.forEach((data) => self.onmessage({data})));
`;
let alive = null;
function start() {
  const thread = new Worker(source, {eval: true});
  alive = {postMessage: (message) => thread.postMessage(message), terminate: () => thread.terminate()};
  thread.on('message', (data) => alive.onmessage({data}));
  thread.on('error', (error) => alive.onerror({message: error.message}));
  return alive;
}

const file = readFileSync(process.argv[2]);
const client = new Client(new WebAssembly.Module(gunzipSync(file)), start);
const {value} = await client.call({verb: 'sample', name: 'bumpy-sphere'});
const {positions} = await client.mesh(value.mesh);
await client.call({verb: 'curvature', mesh: value.mesh, method: 'cotangent'});
const mean = await client.field(value.mesh, 'mean');

// Requests are answered in order; an error is one of its own request only.
const [good, bad, later] = await Promise.allSettled([
  client.call({verb: 'smooth', mesh: value.mesh}),
  client.call({verb: 'smooth', mesh: 99}),
  client.call({verb: 'smooth', mesh: value.mesh}),
]);
assert.equal(bad.reason.message, 'there is no mesh 99');
assert.deepEqual(good.value.arrays.positions, later.value.arrays.positions);

// Long work says how far it is, and ends where it is cancelled; the mesh and its fields survive.
const stages = new Set();
const long = client.call({verb: 'smooth', mesh: value.mesh, method: 'conformal', values: {iterations: 1000}}, {
  onProgress: (stage) => {
    stages.add(stage);
    client.cancel();
  },
});
await assert.rejects(long, (error) => error.isCancelled && error.message === 'cancelled');
assert.ok(stages.size > 0);
assert.deepEqual(await client.field(value.mesh, 'mean'), mean);
const again = await client.call({verb: 'smooth', mesh: value.mesh});
assert.deepEqual(again.arrays.positions, good.value.arrays.positions);

// So they do after a defect, of which the page hears the words.
const broken = client.call({verb: 'smooth', mesh: value.mesh, method: 'conformal', values: {iterations: 1000}});
alive.onerror({message: 'a defect'});
await assert.rejects(broken, /the worker failed: a defect/);
const {arrays} = await client.call({verb: 'mesh', mesh: value.mesh});
assert.deepEqual(arrays.positions, positions);

// A mesh of the page is kept as those of files are.
const own = await client.add(positions, arrays.faces);
const lost = client.call({verb: 'smooth', mesh: own, method: 'conformal', values: {iterations: 1000}});
client.cancel();
await assert.rejects(lost, (error) => error.isCancelled);
assert.deepEqual((await client.call({verb: 'smooth', mesh: own})).arrays.positions, good.value.arrays.positions);
await client.drop(own);

await client.drop(value.mesh);
await assert.rejects(client.call({verb: 'info', mesh: value.mesh}), /there is no mesh/);
alive.terminate();
