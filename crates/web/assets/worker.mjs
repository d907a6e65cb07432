import {Engine} from './engine.mjs';

/**
 * The side of the worker: takes the compiled module first, then requests `{id, request, bytes}`,
 * and answers each with `{id, value, arrays}` or `{id, error, isBroken}`; meanwhile `{id, stage,
 * done, of}`. Arrays are copied once, as a whole, and transferred.
 */
let engine = null;
let current = 0;

self.onmessage = ({data}) => {
  if (data.module) {
    engine = new Engine(data.module, (stage, done, of) => self.postMessage({id: current, stage, done, of}));
    return;
  }
  current = data.id;
  try {
    const {value, arrays} = engine.call(data.request, data.bytes);
    const owned = Object.fromEntries(Object.entries(arrays).map(([name, view]) => [name, view.slice()]));
    const buffers = Object.values(owned).map((array) => array.buffer);
    self.postMessage({id: current, value, arrays: owned, size: engine.size}, buffers);
  } catch (error) {
    self.postMessage({id: current, error: error.message, isBroken: error.isBroken === true});
  }
};
