// node client.mjs MODULE: the client with workers that are threads of Node.
import assert from 'node:assert/strict';
import {readFileSync} from 'node:fs';
import {Worker} from 'node:worker_threads';
import {gunzipSync} from 'node:zlib';
import {Client} from '../../assets/client.mjs';

// What a browser gives to the script of a worker. The next request with `breaks` panics while it
// shows its progress, and one with `fills` finds no memory left.
const script = JSON.stringify(new URL('../../assets/worker.mjs', import.meta.url).href);
const source = `
const {parentPort} = require('node:worker_threads');
let [exports, breaks] = [null, false];
const Plain = WebAssembly.Instance;
WebAssembly.Instance = function (...given) {
  const made = new Plain(...given);
  exports = made.exports;
  return made;
};
globalThis.self = {postMessage: (message, parts) => {
  // The module is at work: to be asked for anything is a defect of the page, of which it complains.
  if (breaks && message.stage) exports.input(1);
  parentPort.postMessage(message, parts);
}};
const early = [];
parentPort.on('message', (data) => {
  breaks = Boolean(data.request?.breaks);
  if (data.request?.fills) exports.memory.grow(65536 - exports.memory.buffer.byteLength / 65536);
  if (self.onmessage) self.onmessage({data});
  else early.push(data);
});
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
assert.deepEqual(again.value.dropped, ['mean']);

// Meshes also survive a panic or a failed allocation, which the page receives as a message.
const heavy = {verb: 'smooth', mesh: value.mesh, method: 'conformal', values: {iterations: 1000}};
const broken = client.call(heavy);
alive.onerror({message: 'a defect'});
await assert.rejects(broken, /the worker failed: a defect/);
await assert.rejects(client.call({...heavy, breaks: true}), /a defect of Fairing, please report it: [^]*already (mutably )?borrowed/);
assert.deepEqual(await client.field(value.mesh, 'mean'), mean);
await assert.rejects(client.call({...heavy, fills: true}), /it needs more memory than a page can have \(4096 MB in use\)/);
assert.deepEqual(await client.field(value.mesh, 'mean'), mean);
const {arrays} = await client.call({verb: 'mesh', mesh: value.mesh});
assert.deepEqual(arrays.positions, positions);

// Fields of every kind come along.
const header = `ply
format ascii 1.0
element vertex 3
property double x
property double y
property double z
property double nx
property double ny
property double nz
property uchar red
property uchar green
property uchar blue
property double height
element face 1
property list uchar int vertex_indices
property list uchar float texcoord
property double part
property uchar red
property uchar green
property uchar blue
end_header
`;
const rows = '0 0 0 0 0 1 1 2 3 0.5\n1 0 0 0 0 1 4 5 6 0.25\n0 1 0 0 0 1 7 8 9 2\n3 0 1 2 6 0 0 1 0 0 1 7 9 8 7\n';
const rich = (await client.call({verb: 'read', name: 'a.ply'}, {bytes: new TextEncoder().encode(header + rows)})).value.mesh;
await client.mesh(rich);
await client.field(rich, 'height');
await client.call({verb: 'curvature', mesh: rich, method: 'jet3'});
await client.keepOthers(rich);
const stored = async () => {
  const {value: {stl}} = await client.call({verb: 'losses', mesh: rich});
  const {value, arrays: {bytes}} = await client.call({verb: 'others', mesh: rich});
  return [stl, bytes, value.fields];
};
const [left, kept, list] = await stored();
assert.deepEqual(list.filter(([, , computed]) => computed).map(([, name]) => name), ['direction1', 'direction2']);
for (const name of ['height', 'normal', 'colours', 'part of faces', 'texture coordinates of corners']) assert.ok(left.includes(name), `${left}`);
const gone = client.call(heavy);
client.cancel();
await assert.rejects(gone, (error) => error.isCancelled);
const [leftThen, keptThen, listThen] = await stored();
assert.deepEqual(listThen, list);
assert.deepEqual(keptThen, kept);
assert.ok(leftThen.includes('height') && leftThen.includes('texture coordinates of corners'), `${leftThen}`);
await client.drop(rich);

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
