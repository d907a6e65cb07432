/**
 * Steps as programs that do the same. `meshes` are those from the first to the last, each with the
 * `request` that made it and with what was `asked` of it: fields and scores. A request has `verb`,
 * `method`, and the `values` that differ from the defaults, as texts by the names of parameters.
 * `input` is the name of the file with the first mesh.
 */

/** Defaults of the laboratory that differ from those of programs. */
const TOLD = {
  noise: {sigma: '0.3'},
  reconstruct: {k: '50'},
  spectrum: {k: '50'},
  compare: {'hausdorff-tolerance': '0.001'},
};

/** The name of a file without its endings. */
export function stem(name) {
  return name.replace(/\.\w+(\.gz)?$/, '');
}

/** The numbers of vertices in a text such as 3,10-19. */
function vertices(text) {
  return text.split(',').flatMap((part) => {
    const [first, last = first] = part.split('-').map(Number);
    return Array.from({length: last - first + 1}, (_, i) => first + i);
  });
}

/** The values of a request, with the defaults that differ from those of programs. */
function told({verb, values}) {
  return {...TOLD[verb], ...values};
}

/** The file of mesh number `i` with its fields, in Rust and Python; the last one is the result. */
function fileOf(input, meshes, i) {
  return `${stem(input)}-${i + 1 < meshes.length ? i : 'fairing'}.ply`;
}

/** As commands of the program, each with a file of its own. */
export function shell(input, meshes) {
  const word = (text) => (/^[\w./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);
  const file = (i) => (i ? `${stem(input)}-${i}.ply` : input);
  const options = (request) => Object.entries(told(request)).flatMap(([name, x]) => [name === 'k' ? '-k' : `--${name}`, word(x)]);
  const named = ({verb, method}) => {
    const option = {smooth: '--method', denoise: '--method', noise: '--kind', curvature: '--estimator'}[verb];
    return option ? [option, method] : [];
  };
  const does = (request, from, to) => ['fairing', request.verb, word(from), '-o', word(to), ...named(request), ...options(request)].join(' ');
  const beside = (i, name) => `${stem(file(i))}-${name}`;
  const uniform = ({values}) => values.operator === 'uniform';
  const lines = {
    curvature: (request, i) => does(request, file(i), beside(i, 'curvature.ply')),
    distance: ({values: {sources, operator}}, i) => {
      if (operator && operator !== 'non-negative') return `# No command measures distances with the Laplacian ${operator}: see the programs in Rust and Python.`;
      return `fairing geodesic ${word(file(i))} -o ${word(beside(i, 'distance.ply'))} --from ${vertices(sources).join()}`;
    },
    spectrum: (request, i) => {
      if (uniform(request)) return '# No command computes modes of uniform weights: see the programs in Rust and Python.';
      return does(request, file(i), beside(i, 'modes.npz'));
    },
    // The file has all modes.
    mode: () => null,
    compare: (request, i) => ['fairing compare', word(file(i)), word(input), ...options(request)].join(' '),
  };
  const made = (request, i) => {
    if (request.verb !== 'reconstruct' || !uniform(request)) return does(request, file(i - 1), file(i));
    return `echo 'no command computes modes of uniform weights: see the programs in Rust and Python' >&2; exit 1`;
  };
  const all = meshes.flatMap(({request, asked}, i) => [
    i ? made(request, i) : null,
    ...asked.map((one) => lines[one.verb](one, i)),
  ]);
  return `${all.filter(Boolean).join('\n')}\n`;
}

const float = (x) => (Number.isInteger(Number(x)) ? Number(x).toFixed(1) : String(Number(x)));

/** An algorithm of a family with its values, in Rust. */
function inRust(type, {method, values}) {
  const text = (x) => JSON.stringify(x);
  const pairs = Object.entries(values).map(([name, x]) => `(${text(name)}, ${text(x)})`);
  return pairs.length ? `${type}::with(${text(method)}, &[${pairs.join(', ')}])?` : `${type}::by_name(${text(method)})?`;
}

/** The Laplacian and its modes in Rust. */
function modesInRust(request) {
  const {k, operator = 'auto', boundary} = told(request);
  const options = boundary === 'dirichlet' ? 'fairing::spectral::SpectrumOptions::dirichlet(&mesh)' : 'Default::default()';
  return [
    `let mass = fairing::operators::MassKind::${operator === 'uniform' ? 'Degree' : 'Barycentric'};`,
    `let laplacian = fairing::operators::Laplacian::new(&mesh, ${JSON.stringify(operator)}.parse()?, mass)?;`,
    `let modes = fairing::spectral::spectrum(&laplacian, ${k}, &${options})?;`,
  ];
}

/** The lines in Rust that make `mesh` of the one before it, by verb. */
const MADE_IN_RUST = {
  smooth: (request) => [`let mesh = ${inRust('fairing::smoothing::Method', request)}.run(&mesh, None)?.mesh;`],
  denoise: (request) => [`let mesh = ${inRust('fairing::denoising::Denoiser', request)}.denoise(&mesh)?;`],
  noise: (request) => {
    const {sigma, unit = 'edge', fraction, length, seed = '1'} = told(request);
    const level = {edge: 'EdgeLengths', model: 'Model', diagonal: 'Diagonals'}[unit];
    const parts = Object.entries({fraction, length}).filter(([, x]) => x !== undefined);
    const kind = parts.map(([name, x]) => `let kind = kind.with_${name}(${float(x)}).ok_or("this noise has no ${name}")?;`);
    return [
      `let kind: fairing::evaluation::NoiseKind = ${JSON.stringify(request.method)}.parse()?;`,
      ...kind,
      `let level = fairing::evaluation::NoiseLevel::${level}(${float(sigma)});`,
      `let mesh = fairing::evaluation::add_noise(&mesh, kind, level, ${seed})?;`,
    ];
  },
  reconstruct: (request) => [
    ...modesInRust(request),
    `let mesh = fairing::spectral::reconstruct(&mesh, &modes, ${told(request).k})?.mesh;`,
  ],
  repair: ({values: {components, holes, tolerance, ...lengths}}) => {
    const counts = Object.entries({smallest_component: components, holes}).filter(([, x]) => x !== undefined);
    const fields = [...counts, ...Object.entries(lengths).map(([name, x]) => [name, float(x)])];
    if (tolerance > 0) fields.push(['tolerance', `fairing::mesh::Tolerance::EdgeLengths(${float(tolerance)})`]);
    const given = [...fields.map((pair) => pair.join(': ')), '..Default::default()'].join(', ');
    const options = `let options = fairing::mesh::RepairOptions { ${given} };`;
    if (!holes) return [options, 'let mesh = fairing::mesh::repair(&mesh, &options)?.mesh;'];
    return [
      options,
      'let repaired = fairing::mesh::repair(&mesh, &options)?;',
      'let mesh = match repaired.patch_vertices() {',
      '    patch if patch.is_empty() => repaired.mesh,',
      '    patch => {',
      '        let region = fairing::smoothing::FairRegion::new(patch);',
      '        fairing::smoothing::fair_region(&repaired.mesh, &region)?.mesh',
      '    }',
      '};',
    ];
  },
};

/** The lines in Rust that add to `fields` of `mesh`, by verb. */
const FIELDS_IN_RUST = {
  curvature: (request) => [
    `let found = ${inRust('fairing::operators::curvature::Estimator', request)}.estimate(&mesh)?;`,
    'let defined = found.status.iter().map(|s| f64::from(u8::from(s.is_defined()))).collect();',
    'let fields = fields.with_scalar("defined", defined);',
    'let fields = fields.with_scalar("mean", found.mean).with_scalar("gaussian", found.gaussian);',
    'let fields = fields.with_scalar("kappa1", found.kappa1).with_scalar("kappa2", found.kappa2);',
    'let fields = match found.accuracy {',
    '    Some(a) => fields.with_scalar("mean_error", a.mean_error).with_scalar("gaussian_error", a.gaussian_error).with_scalar("scale", a.scale),',
    '    None => fields,',
    '};',
  ],
  distance: ({values: {sources, operator = 'non-negative'}}) => [
    'let mass = fairing::operators::MassKind::Barycentric;',
    `let laplacian = fairing::operators::Laplacian::new(&mesh, ${JSON.stringify(operator)}.parse()?, mass)?;`,
    'let geodesics = fairing::spectral::HeatGeodesics::with(&mesh, &laplacian, None)?;',
    `let found = geodesics.distance(&[${vertices(sources).join(', ')}])?;`,
    '// Components without a source have no distance.',
    'let distance = found.into_iter().map(|d| d.unwrap_or(-1.0)).collect();',
    'let fields = fields.with_scalar("distance", distance);',
  ],
  spectrum: modesInRust,
  mode: ({values: {mode}}) => [`let fields = fields.with_scalar("mode", modes.modes.column(${mode}).to_vec());`],
};

/** As a program in Rust with the crate `fairing`. */
export function rust(input, meshes) {
  const path = (file) => JSON.stringify(file);
  const compared = (request) => {
    const options = Object.entries(told(request)).map(([name, x]) => `${name.replaceAll('-', '_')}: ${float(x)}`);
    return [
      `let original = fairing::mesh::io::read(${path(input)})?.mesh;`,
      `let options = fairing::evaluation::ScoreOptions { ${options.join(', ')}, ..Default::default() };`,
      'println!("{}", fairing::evaluation::Scores::new(&mesh, &original, &options)?);',
    ];
  };
  const written = (asked, i) => {
    const fields = asked.filter(({verb}) => FIELDS_IN_RUST[verb]);
    const file = path(fileOf(input, meshes, i));
    if (!fields.length) return i + 1 < meshes.length ? [] : [`fairing::mesh::io::write(${file}, &mesh)?;`];
    return [
      'let fields = fairing::mesh::io::VertexFields::default();',
      ...fields.flatMap((request) => FIELDS_IN_RUST[request.verb](request)),
      `fairing::mesh::io::write_with_fields(${file}, &mesh, &fields, &Default::default())?;`,
    ];
  };
  const body = meshes.flatMap(({request, asked}, i) => [
    ...(i ? MADE_IN_RUST[request.verb](request) : [`let mesh = fairing::mesh::io::read(${path(input)})?.mesh;`]),
    ...asked.filter(({verb}) => verb === 'compare').flatMap(compared),
    ...written(asked, i),
  ]);
  return `fn main() -> Result<(), Box<dyn std::error::Error>> {\n${[...body, 'Ok(())'].map((line) => `    ${line}\n`).join('')}}\n`;
}

/** As a program in Python with the package `pyfairing`. */
export function python(input, meshes) {
  const value = (x) => (/^-?[\d.]+(e[+-]?\d+)?$/i.test(x) ? x : JSON.stringify(x));
  const soft = (x) => {
    const [vertex, weight, ...target] = x.split(':');
    return `(${[vertex, weight, ...(target.length ? [`[${target.join(', ')}]`] : [])].join(', ')})`;
  };
  const lists = {soft: (x) => x.split(',').map(soft), pin: vertices, vertices};
  const key = (name) => ({lambda: 'lam', components: 'smallest_component'}[name] ?? name.replaceAll('-', '_'));
  const pair = ([name, x]) => `${key(name)}=${lists[name] ? `[${lists[name](x).join(', ')}]` : value(x)}`;
  const pairs = (values) => Object.entries(values).map(pair);
  const modes = (request) => {
    const {k, operator = 'auto', boundary} = told(request);
    const given = [k, JSON.stringify(operator), ...(operator === 'uniform' ? ['"degree"'] : []), ...(boundary ? pairs({boundary}) : [])];
    return `mesh.spectrum(${given.join(', ')})`;
  };
  const made = (request) => {
    const {verb, method, values} = request;
    if (verb === 'reconstruct') return `${modes(request)}.reconstruct()`;
    const first = verb === 'smooth' || verb === 'denoise' ? [`"${method}"`] : [];
    const given = verb === 'noise' ? {...told(request), kind: method} : values;
    return `mesh.${verb}(${[...first, ...pairs(given)].join(', ')})`;
  };
  const fields = {
    curvature: ({method, values}) => [`fields |= mesh.curvature(${[`"${method}"`, ...pairs(values)].join(', ')}).fields()`],
    distance: ({values: {sources, operator}}) => {
      const given = [`[${vertices(sources).join(', ')}]`, ...(operator ? [JSON.stringify(operator)] : [])];
      return [
        '# Components without a source have no distance.',
        `fields["distance"] = np.nan_to_num(mesh.geodesic_distance(${given.join(', ')}), posinf=-1.0)`,
      ];
    },
    spectrum: (request) => [`modes = ${modes(request)}.modes`],
    mode: ({values: {mode}}) => [`fields["mode"] = modes[:, ${mode}]`],
  };
  const compared = (request) => `print(pf.compare(${['mesh', `pf.read(${JSON.stringify(input)})`, ...pairs(told(request))].join(', ')}))`;
  const written = (asked, i) => {
    const own = asked.filter(({verb}) => fields[verb]);
    const file = JSON.stringify(fileOf(input, meshes, i));
    if (!own.length) return i + 1 < meshes.length ? [] : [`mesh.write(${file})`];
    return ['fields = {}', ...own.flatMap((request) => fields[request.verb](request)), `mesh.with_fields(fields).write(${file})`];
  };
  const lines = meshes.flatMap(({request, asked}, i) => [
    i ? `mesh = ${made(request)}` : `mesh = pf.read(${JSON.stringify(input)})`,
    ...asked.filter(({verb}) => verb === 'compare').map(compared),
    ...written(asked, i),
  ]);
  const isMeasured = meshes.some(({asked}) => asked.some(({verb}) => verb === 'distance'));
  const imports = [...(isMeasured ? ['import numpy as np'] : []), 'import pyfairing as pf', ''];
  return [...imports, ...lines].map((line) => `${line}\n`).join('');
}

/** The part of an address after `#` for steps on a sample. */
export function link(sample, meshes) {
  const requests = meshes.flatMap(({request, asked}, i) => (i ? [request, ...asked] : asked));
  const written = ({verb, method, values}) => [verb, method, ...Object.entries(values).flat()].join('~');
  return new URLSearchParams([['sample', sample], ...requests.map((request) => ['step', written(request)])]).toString();
}

/** The sample and the steps of such a part, or null if it names no sample. */
export function linked(text) {
  const given = new URLSearchParams(text);
  const steps = given.getAll('step').map((step) => {
    const [verb, method, ...rest] = step.split('~');
    return {verb, method, values: Object.fromEntries(rest.flatMap((name, i) => (i % 2 ? [] : [[name, rest[i + 1] ?? '']])))};
  });
  return given.has('sample') ? {sample: given.get('sample'), steps} : null;
}
