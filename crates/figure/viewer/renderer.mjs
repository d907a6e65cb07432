/**
 * Draws meshes. One hidden WebGL2 context serves all canvases of the page,
 * because browsers allow only a few contexts: each picture is drawn here and
 * copied to the plain canvas in which it is seen.
 */

const WIDTH = 2048; // of data textures, in texels
const COARSE = 4500; // faces of a mesh while it moves, about

const VERTEX = `#version 300 es
precision highp float; precision highp int; precision highp usampler2D;
uniform usampler2D tIndex;
uniform highp sampler2D tPosition, tNormal, tValue;
uniform mat4 uView, uProjection;
uniform bool uExpanded;
out vec3 vPosition, vNormal, vSide;
out float vValue, vDefined;
flat out int vFace;
ivec2 at(int i) { return ivec2(i & ${WIDTH - 1}, i / ${WIDTH}); }
void main() {
int corner = gl_VertexID % 3;
int v = uExpanded ? int(texelFetch(tIndex, at(gl_VertexID), 0).r) : gl_VertexID;
vec4 p = texelFetch(tPosition, at(v), 0);
vec4 seen = uView * vec4(p.xyz, 1.0);
vPosition = seen.xyz;
vNormal = mat3(uView) * texelFetch(tNormal, at(v), 0).xyz;
vec2 value = texelFetch(tValue, at(v), 0).rg;
vValue = value.x;
vDefined = value.y;
vSide = vec3(corner == 0, corner == 1, corner == 2);
vFace = gl_VertexID / 3;
gl_Position = uProjection * seen;
}`;

const SHADE = `#version 300 es
precision highp float; precision highp int;
in vec3 vPosition, vNormal, vSide;
in float vValue, vDefined;
flat in int vFace;
out vec4 color;
uniform sampler2D tMap;
uniform vec2 uRange;
uniform bool uFlat, uColored, uLines;
uniform float uWire, uPixel;
// Both are within one step of 8 bits of the powers, but for what is nearly black; powers take
// half of the time of a picture in software.
vec3 linear(vec3 c) { return c * (0.0602285 + c * (0.3476008 + c * (0.9503896 - 0.3640633 * c))); }
vec3 srgb(vec3 c) {
c = clamp(c, 0.0, 1.0);
vec3 root = sqrt(c);
return max(0.8273321 * root + 0.3035418 * sqrt(root) - 0.0780923 * c - 0.0530938, 0.0);
}
float power40(float x) {
float x2 = x * x, x4 = x2 * x2, x8 = x4 * x4, x16 = x8 * x8;
return x16 * x16 * x8;
}
void main() {
vec3 eye = normalize(vPosition);
vec3 face = normalize(cross(dFdx(vPosition), dFdy(vPosition)));
if (dot(face, eye) > 0.0) face = -face;
vec3 n = face;
if (!uFlat && dot(vNormal, vNormal) > 1e-8) {
  n = normalize(vNormal) * (gl_FrontFacing ? 1.0 : -1.0);
  float away = dot(n, eye);
  if (away > 0.0) n = normalize(n - eye * away + face * 1e-3);
}
float span = max(uRange.y - uRange.x, 1e-30);
float t = (vValue - uRange.x) / span;
vec3 base = vec3(0.84, 0.815, 0.776);
if (uColored) {
  // A face with an undefined corner is grey as a whole.
  base = vDefined < 0.999 ? vec3(0.588) : texture(tMap, vec2(clamp(t, 0.0, 1.0), 0.5)).rgb;
}
base = linear(base);
if (!gl_FrontFacing) base = mix(base, linear(vec3(0.376, 0.431, 0.549)), 0.333);
if (uColored && uLines && vDefined > 0.999) {
  float x = t * 12.0;
  float d = abs(fract(x + 0.5) - 0.5) / max(fwidth(x), 1e-6);
  base *= mix(0.25, 1.0, smoothstep(0.5, 1.3, d));
}
vec3 key = normalize(vec3(-0.5, 0.75, 0.8)), fill = normalize(vec3(0.9, 0.1, 0.6));
float light = 0.84 * max(dot(n, key), 0.0)
  + 0.20 * max(dot(n, fill), 0.0)
  + mix(0.13, 0.32, 0.5 + 0.5 * n.y);
vec3 lit = base * light
  + 0.06 * power40(max(dot(n, normalize(key - eye)), 0.0));
if (uWire > 0.0) {
  // Distances to the three sides and heights of the face, in pixels.
  vec3 slope = max(fwidth(vSide), vec3(1e-6));
  vec3 far = vSide / slope;
  float near = min(min(far.x, far.y), far.z);
  float height = 1.0 / max(max(slope.x, slope.y), slope.z) / uPixel;
  float fade = clamp((height - 2.0) / 6.0, 0.0, 1.0);
  float line = 1.0 - smoothstep(0.5 * uWire - 0.5, 0.5 * uWire + 0.5, near);
  lit = mix(lit, vec3(0.008, 0.009, 0.012), line * fade * 0.7);
}
color = vec4(srgb(lit), 1.0);
}`;

const NUMBER = `#version 300 es
precision highp float; precision highp int;
flat in int vFace;
out vec4 color;
void main() {
int id = vFace + 1;
color = vec4(id & 255, (id >> 8) & 255, (id >> 16) & 255, 255) / 255.0;
}`;

const canvas = document.createElement('canvas');
const gl = canvas.getContext('webgl2', {antialias: true, preserveDrawingBuffer: true});

let programs = null;
let quick = null; // the buffer of pictures that move
let generation = 0; // counts lost contexts: what was uploaded before is gone
canvas.addEventListener('webglcontextlost', (e) => {
  e.preventDefault();
  programs = null;
});
canvas.addEventListener('webglcontextrestored', () => {
  generation += 1;
  document.dispatchEvent(new Event('fairing-redraw'));
});

function program(fragment) {
  const made = gl.createProgram();
  for (const [kind, source] of [[gl.VERTEX_SHADER, VERTEX], [gl.FRAGMENT_SHADER, fragment]]) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS) && !gl.isContextLost()) {
      throw new Error(gl.getShaderInfoLog(shader));
    }
    gl.attachShader(made, shader);
  }
  gl.linkProgram(made);
  const places = new Map();
  const place = (name) => {
    if (!places.has(name)) places.set(name, gl.getUniformLocation(made, name));
    return places.get(name);
  };
  return {made, place};
}

function prepare() {
  if (programs) return;
  programs = {shade: program(SHADE), number: program(NUMBER)};
  gl.bindVertexArray(gl.createVertexArray());
}

/** One unsigned integer, or two or four floating-point numbers, a texel. */
function texture(values, components) {
  const count = values.length / components;
  const rows = Math.max(1, Math.ceil(count / WIDTH));
  const padded = new values.constructor(WIDTH * rows * components);
  padded.set(values);
  const made = fresh();
  const [inner, format, type] = {
    1: [gl.R32UI, gl.RED_INTEGER, gl.UNSIGNED_INT],
    2: [gl.RG32F, gl.RG, gl.FLOAT],
    4: [gl.RGBA32F, gl.RGBA, gl.FLOAT],
  }[components];
  gl.texImage2D(gl.TEXTURE_2D, 0, inner, WIDTH, rows, 0, format, type, padded);
  sampling(gl.NEAREST);
  return made;
}

/** A texture to be filled, on a unit that drawing does not use. */
function fresh() {
  const made = gl.createTexture();
  gl.activeTexture(gl.TEXTURE7);
  gl.bindTexture(gl.TEXTURE_2D, made);
  return made;
}

function sampling(filter) {
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MIN_FILTER, filter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_MAG_FILTER, filter);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_S, gl.CLAMP_TO_EDGE);
  gl.texParameteri(gl.TEXTURE_2D, gl.TEXTURE_WRAP_T, gl.CLAMP_TO_EDGE);
}

/** Values that were uploaded once stay until they or the context change. */
function resident(owner, name, source, upload) {
  owner.gpu ??= {};
  const kept = owner.gpu[name];
  if (kept && kept.source === source && kept.generation === generation) return kept.made;
  if (kept && kept.generation === generation) {
    if (kept.made instanceof WebGLTexture) gl.deleteTexture(kept.made);
    else gl.deleteBuffer(kept.made);
  }
  const made = upload();
  owner.gpu[name] = {source, generation, made};
  return made;
}

function run(shader, scene, width, height, expanded) {
  const {mesh, shape, values, camera} = scene;
  gl.useProgram(shader.made);
  const bind = (unit, name, made) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, made);
    gl.uniform1i(shader.place(name), unit);
  };
  const index = resident(mesh, 'index', mesh.faces, () => texture(mesh.faces, 1));
  const position = resident(mesh, 'position', shape.points, () => texture(shape.points, 4));
  const normal = resident(mesh, 'normal', shape.normals, () => texture(shape.normals, 4));
  mesh.zeros ??= new Float32Array(mesh.vertices);
  const source = values ?? mesh.zeros;
  const value = resident(mesh, 'value', source, () => {
    const pairs = new Float32Array(2 * source.length);
    for (let v = 0; v < source.length; v++) {
      if (!Number.isFinite(source[v])) continue;
      pairs[2 * v] = source[v];
      pairs[2 * v + 1] = 1;
    }
    return texture(pairs, 2);
  });
  bind(0, 'tIndex', index);
  bind(1, 'tPosition', position);
  bind(2, 'tNormal', normal);
  bind(3, 'tValue', value);
  gl.uniformMatrix4fv(shader.place('uView'), false, camera.view());
  gl.uniformMatrix4fv(shader.place('uProjection'), false, camera.projection(width / height));
  gl.uniform1i(shader.place('uExpanded'), expanded ? 1 : 0);
  if (expanded) {
    gl.drawArrays(gl.TRIANGLES, 0, mesh.faces.length);
    return;
  }
  const faces = scene.coarse ? coarse(mesh, shape.points) : mesh.faces;
  const elements = resident(mesh, scene.coarse ? 'coarse' : 'elements', faces, () => {
    const made = gl.createBuffer();
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, made);
    gl.bufferData(gl.ELEMENT_ARRAY_BUFFER, faces, gl.STATIC_DRAW);
    return made;
  });
  gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, elements);
  gl.drawElements(gl.TRIANGLES, faces.length, gl.UNSIGNED_INT, 0);
}

/** Faces between one vertex of each cell of a grid, for pictures that move; made once a mesh. */
function coarse(mesh, points) {
  if (mesh.faces.length <= 3 * COARSE) return mesh.faces;
  mesh.coarseFaces ??= (() => {
    // Noise fills more cells than a surface does: they grow until few enough faces are left.
    for (let cells = Math.sqrt(COARSE / 16); ; cells *= 0.8) {
      const kept = between(mesh, points, cells);
      if (kept.length <= 4 * COARSE) return kept;
    }
  })();
  return mesh.coarseFaces;
}

/** Faces between one vertex of each cell; `cells` of them along the radius of the view. */
function between(mesh, points, cells) {
  const known = new Map();
  const stand = new Uint32Array(mesh.vertices);
  for (let v = 0; v < mesh.vertices; v++) {
    const i = Math.floor((points[4 * v] + 2) * cells);
    const j = Math.floor((points[4 * v + 1] + 2) * cells);
    const k = Math.floor((points[4 * v + 2] + 2) * cells);
    const cell = (i * 4096 + j) * 4096 + k;
    const first = known.get(cell);
    if (first === undefined) known.set(cell, v);
    stand[v] = first ?? v;
  }
  const kept = [];
  for (let f = 0; f < mesh.faces.length; f += 3) {
    const a = stand[mesh.faces[f]];
    const b = stand[mesh.faces[f + 1]];
    const c = stand[mesh.faces[f + 2]];
    if (a !== b && b !== c && c !== a) kept.push(a, b, c);
  }
  return Uint32Array.from(kept);
}

/**
 * Draws into a buffer without smoothing of edges, which is read back in one
 * small piece: several times faster in software than copying the canvas.
 */
function quickly(width, height) {
  if (quick?.generation !== generation || quick.width !== width || quick.height !== height) {
    if (quick?.generation === generation) {
      gl.deleteFramebuffer(quick.buffer);
      quick.parts.forEach((part) => gl.deleteRenderbuffer(part));
    }
    const buffer = gl.createFramebuffer();
    gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
    const parts = [[gl.RGBA8, gl.COLOR_ATTACHMENT0], [gl.DEPTH_COMPONENT16, gl.DEPTH_ATTACHMENT]].map(([kind, place]) => {
      const made = gl.createRenderbuffer();
      gl.bindRenderbuffer(gl.RENDERBUFFER, made);
      gl.renderbufferStorage(gl.RENDERBUFFER, kind, width, height);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, place, gl.RENDERBUFFER, made);
      return made;
    });
    const small = document.createElement('canvas');
    [small.width, small.height] = [width, height];
    quick = {buffer, parts, width, height, generation, small, image: new ImageData(width, height)};
  }
  gl.bindFramebuffer(gl.FRAMEBUFFER, quick.buffer);
}

function clear(width, height, grow = true) {
  if (grow && canvas.width < width) canvas.width = width;
  if (grow && canvas.height < height) canvas.height = height;
  gl.viewport(0, 0, width, height);
  gl.enable(gl.SCISSOR_TEST);
  gl.scissor(0, 0, width, height);
  gl.enable(gl.DEPTH_TEST);
  gl.clearColor(0, 0, 0, 0);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
}

/**
 * Draws a scene to fill a plain canvas. `scene`: `mesh` (faces, vertices),
 * `shape` (points, normals), `values` or null, `camera`,
 * `lookup` (colours as RGB bytes), `range`, and the switches `flat`, `wire`
 * and `lines`.
 */
function draw(target, scene) {
  const {width, height} = target.canvas;
  if (!width || !height || gl.isContextLost()) return;
  prepare();
  clear(width, height);
  paint(scene, width, height);
  target.clearRect(0, 0, width, height);
  target.drawImage(canvas, 0, canvas.height - height, width, height, 0, 0, width, height);
}

/**
 * The same for pictures that move: all of a view at once, at a part of the
 * resolution and with fewer faces, side by side in one buffer that is read
 * back in one piece.
 */
function drawMoving(pictures, part) {
  if (gl.isContextLost()) return;
  let across = 0;
  const places = pictures.map(({target, scene}) => {
    const [width, height] = [target.canvas.width, target.canvas.height].map((size) => Math.round(part * size));
    across += width;
    return {target, width, height, left: across - width, scene: {...scene, coarse: true, pixel: part * scene.pixel, wire: false}};
  }).filter(({width, height}) => width && height);
  if (!places.length) return;
  const tallest = Math.max(...places.map(({height}) => height));
  prepare();
  quickly(across, tallest);
  clear(across, tallest, false);
  for (const {scene, left, width, height} of places) {
    gl.viewport(left, 0, width, height);
    gl.scissor(left, 0, width, height);
    paint(scene, width, height);
  }
  const {small, image} = quick;
  gl.readPixels(0, 0, across, tallest, gl.RGBA, gl.UNSIGNED_BYTE, new Uint8Array(image.data.buffer));
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  small.getContext('2d').putImageData(image, 0, 0);
  for (const {target, left, width, height} of places) {
    // The first row is the lowest.
    const {width: w, height: h} = target.canvas;
    target.clearRect(0, 0, w, h);
    target.save();
    target.scale(1, -1);
    target.drawImage(small, left, 0, width, height, 0, -h, w, h);
    target.restore();
  }
}

/** Draws a scene into the buffer and viewport that are set. */
function paint(scene, width, height) {
  const shader = programs.shade;
  gl.useProgram(shader.made);
  const map = resident(scene.mesh, 'map', scene.lookup, () => {
    const made = fresh();
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
    const size = scene.lookup.length / 3;
    gl.texImage2D(
      gl.TEXTURE_2D, 0, gl.RGB8, size, 1, 0, gl.RGB, gl.UNSIGNED_BYTE, scene.lookup);
    sampling(gl.LINEAR);
    return made;
  });
  gl.activeTexture(gl.TEXTURE4);
  gl.bindTexture(gl.TEXTURE_2D, map);
  gl.uniform1i(shader.place('tMap'), 4);
  gl.uniform2f(shader.place('uRange'), scene.range[0], scene.range[1]);
  gl.uniform1i(shader.place('uColored'), scene.values ? 1 : 0);
  gl.uniform1i(shader.place('uFlat'), scene.flat ? 1 : 0);
  gl.uniform1i(shader.place('uLines'), scene.lines ? 1 : 0);
  gl.uniform1f(shader.place('uWire'), scene.wire ? scene.pixel : 0);
  gl.uniform1f(shader.place('uPixel'), scene.pixel);
  run(shader, scene, width, height, scene.wire);
}

/** The face seen at a pixel, counted from the top left; −1 for none. */
function faceAt(scene, width, height, x, y) {
  if (gl.isContextLost()) return -1;
  prepare();
  clear(width, height);
  gl.scissor(x, height - 1 - y, 1, 1);
  // Without smoothing at the edges, which would mix numbers: a buffer of
  // its own has none.
  const buffer = gl.createFramebuffer();
  const seen = gl.createRenderbuffer();
  const depth = gl.createRenderbuffer();
  gl.bindFramebuffer(gl.FRAMEBUFFER, buffer);
  gl.bindRenderbuffer(gl.RENDERBUFFER, seen);
  gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA8, width, height);
  gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, seen);
  gl.bindRenderbuffer(gl.RENDERBUFFER, depth);
  gl.renderbufferStorage(gl.RENDERBUFFER, gl.DEPTH_COMPONENT24, width, height);
  gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.DEPTH_ATTACHMENT, gl.RENDERBUFFER, depth);
  gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
  run(programs.number, scene, width, height, true);
  const [r, g, b] = readPixel(x, height - 1 - y);
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  gl.deleteRenderbuffer(seen);
  gl.deleteRenderbuffer(depth);
  gl.deleteFramebuffer(buffer);
  return (r | (g << 8) | (b << 16)) - 1;
}

function readPixel(x, y) {
  const pixel = new Uint8Array(4);
  gl.readPixels(x, y, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, pixel);
  return pixel;
}

/** Null where there is no WebGL 2. */
export const Renderer = gl && {draw, drawMoving, faceAt};
