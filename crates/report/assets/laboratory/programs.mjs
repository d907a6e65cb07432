/**
 * Steps as programs that do the same. A step is a request without its mesh: `verb`, `method`, and the `values` that
 * differ from the defaults, as texts by the names of parameters. `input` is the name of the file with the first mesh.
 */

/** The name of a file without its endings. */
export function stem(name) {
  return name.replace(/\.\w+(\.gz)?$/, '');
}

/** As commands of the program, each with a file of its own. */
export function shell(input, steps) {
  const word = (text) => (/^[\w./-]+$/.test(text) ? text : `'${text.replaceAll("'", "'\\''")}'`);
  const file = (i) => (i < 0 ? input : `${stem(input)}-${i + 1}.ply`);
  const lines = steps.map(({verb, method, values}, i) => {
    const named = {smooth: '--method', denoise: '--method', noise: '--kind'}[verb];
    const given = {noise: {sigma: '0.3'}, reconstruct: {k: '50'}}[verb];
    const options = Object.entries({...given, ...values}).flatMap(([name, x]) => [name === 'k' ? '-k' : `--${name}`, word(x)]);
    return ['fairing', verb, word(file(i - 1)), '-o', word(file(i)), ...(named ? [named, method] : []), ...options].join(' ');
  });
  return `${lines.join('\n')}\n`;
}

/** As a program in Rust with the crate `fairing`. */
export function rust(input, steps) {
  const float = (x) => (Number.isInteger(Number(x)) ? Number(x).toFixed(1) : String(Number(x)));
  const text = (x) => JSON.stringify(x);
  const named = (type, method, values) => {
    const pairs = Object.entries(values).map(([name, x]) => `(${text(name)}, ${text(x)})`);
    return pairs.length ? `${type}::with(${text(method)}, &[${pairs.join(', ')}])?` : `${type}::by_name(${text(method)})?`;
  };
  const lines = {
    smooth: ({method, values}) => [`let mesh = ${named('fairing::smoothing::Method', method, values)}.run(&mesh, None)?.mesh;`],
    denoise: ({method, values}) => [`let mesh = ${named('fairing::denoising::Denoiser', method, values)}.denoise(&mesh)?;`],
    noise: ({method, values: {sigma = '0.3', unit = 'edge', fraction, length, seed = '1'}}) => {
      const level = {edge: 'EdgeLengths', model: 'Model', diagonal: 'Diagonals'}[unit];
      const parts = Object.entries({fraction, length}).filter(([, x]) => x !== undefined);
      const kind = parts.map(([name, x]) => `let kind = kind.with_${name}(${float(x)}).ok_or("this noise has no ${name}")?;`);
      return [
        `let kind: fairing::evaluation::NoiseKind = ${text(method)}.parse()?;`,
        ...kind,
        `let level = fairing::evaluation::NoiseLevel::${level}(${float(sigma)});`,
        `let mesh = fairing::evaluation::add_noise(&mesh, kind, level, ${seed})?;`,
      ];
    },
    reconstruct: ({values: {k = '50', operator = 'auto'}}) => [
      `let mass = fairing::operators::MassKind::${operator === 'uniform' ? 'Degree' : 'Barycentric'};`,
      `let laplacian = fairing::operators::Laplacian::new(&mesh, ${text(operator)}.parse()?, mass)?;`,
      `let modes = fairing::spectral::spectrum(&laplacian, ${k}, &Default::default())?;`,
      `let mesh = fairing::spectral::reconstruct(&mesh, &modes, ${k})?.mesh;`,
    ],
    repair: ({values: {components, holes, ...lengths}}) => {
      const counts = Object.entries({smallest_component: components, holes}).filter(([, x]) => x !== undefined);
      const fields = [...counts, ...Object.entries(lengths).map(([name, x]) => [name, float(x)])];
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
  const body = [
    `let mesh = fairing::mesh::io::read(${text(input)})?.mesh;`,
    ...steps.flatMap((step) => lines[step.verb](step)),
    `fairing::mesh::io::write(${text(`${stem(input)}-fairing.ply`)}, &mesh)?;`,
    'Ok(())',
  ];
  return `fn main() -> Result<(), Box<dyn std::error::Error>> {\n${body.map((line) => `    ${line}\n`).join('')}}\n`;
}

/** As a program in Python with the package `pyfairing`. */
export function python(input, steps) {
  const value = (x) => (/^-?[\d.]+(e[+-]?\d+)?$/i.test(x) ? x : JSON.stringify(x));
  const soft = (x) => {
    const [vertex, weight, ...target] = x.split(':');
    return `(${[vertex, weight, ...(target.length ? [`[${target.join(', ')}]`] : [])].join(', ')})`;
  };
  const lists = {soft: (x) => x.split(',').map(soft), pin: (x) => x.split(','), vertices: (x) => x.split(',')};
  const key = (name) => ({lambda: 'lam', components: 'smallest_component'}[name] ?? name.replaceAll('-', '_'));
  const pair = ([name, x]) => `${key(name)}=${lists[name] ? `[${lists[name](x).join(', ')}]` : value(x)}`;
  const call = ({verb, method, values}) => {
    if (verb === 'reconstruct') {
      const {k = '50', operator = 'auto'} = values;
      return `spectrum(${k}, "${operator}"${operator === 'uniform' ? ', "degree"' : ''}).reconstruct()`;
    }
    const given = verb === 'noise' ? {sigma: '0.3', ...values, kind: method} : values;
    const first = verb === 'smooth' || verb === 'denoise' ? [`"${method}"`] : [];
    return `${verb}(${[...first, ...Object.entries(given).map(pair)].join(', ')})`;
  };
  const lines = steps.map((step) => `mesh = mesh.${call(step)}\n`).join('');
  return `import pyfairing as pf\n\nmesh = pf.read(${JSON.stringify(input)})\n${lines}mesh.write(${JSON.stringify(`${stem(input)}-fairing.ply`)})\n`;
}

/** The part of an address after `#` for steps on a sample. */
export function link(sample, steps) {
  const written = ({verb, method, values}) => [verb, method, ...Object.entries(values).flat()].join('~');
  return new URLSearchParams([['sample', sample], ...steps.map((step) => ['step', written(step)])]).toString();
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
