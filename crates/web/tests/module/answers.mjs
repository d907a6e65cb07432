// node answers.mjs MODULE REQUESTS: answers each line of a file, a line each.
import {readFileSync} from 'node:fs';
import {gunzipSync} from 'node:zlib';
import {Engine} from '../../assets/engine.mjs';

const [path, requests] = process.argv.slice(2);
const file = readFileSync(path);
const engine = new Engine(new WebAssembly.Module(path.endsWith('.gz') ? gunzipSync(file) : file));
const base64 = (array) => Buffer.from(array.buffer, array.byteOffset, array.byteLength).toString('base64');
for (const line of readFileSync(requests, 'utf8').trimEnd().split('\n')) {
  const {request, bytes} = JSON.parse(line);
  let answer;
  try {
    const {value, arrays} = engine.call(request, Buffer.from(bytes, 'base64'));
    answer = {value, arrays: Object.fromEntries(Object.entries(arrays).map(([name, array]) => [name, base64(array)]))};
  } catch (error) {
    answer = {error: error.message, isBroken: error.isBroken === true};
  }
  console.log(JSON.stringify({...answer, size: engine.size}));
}
