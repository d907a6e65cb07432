/**
 * The form of a task: its methods and their parameters, from the tables of the module. `changed` is called when a value
 * was set by hand.
 */
export class Panel {
  constructor(task, changed) {
    this.task = task;
    this.changed = changed;
    this.method = task.default;
    this.inputs = new Map();
    this.place = element('div', {class: 'form'});
    this.build();
  }

  get chosen() {
    return this.task.methods.find(({name}) => name === this.method);
  }

  build() {
    const {methods} = this.task;
    const rows = [];
    if (methods.length > 1) {
      const select = element('select', {'aria-label': 'method'});
      for (const {name} of methods) select.append(element('option', {value: name, selected: name === this.method}, name));
      select.addEventListener('input', () => {
        this.method = select.value;
        this.build();
        this.changed();
      });
      rows.push(element('label', {class: 'row'}, element('span', {}, 'method'), select));
    }
    rows.push(element('p', {class: 'hint'}, `${this.chosen.about}.`));
    this.inputs.clear();
    for (const parameter of this.chosen.parameters) rows.push(this.row(parameter));
    this.place.replaceChildren(...rows);
  }

  row(parameter) {
    const {name, about, unit, range, required} = parameter;
    const input = inputOf(parameter);
    this.inputs.set(name, input);
    input.addEventListener('change', () => this.changed());
    const numeric = ['number', 'count'].includes(parameter.kind);
    const title = [about, unit && `in ${unit}`, numeric && range !== 'finite' && range].filter(Boolean).join('; ');
    const words = element('span', {}, name, unit ? element('small', {}, ` ${unit}`) : '', required ? ' *' : '');
    return element('label', {class: 'row', title}, words, input);
  }

  /** The values that differ from the defaults. */
  values() {
    const given = {};
    for (const {name, default: usual} of this.chosen.parameters) {
      const text = this.inputs.get(name).value.trim();
      if (text !== '' && text !== usual) given[name] = text;
    }
    return given;
  }

  /** Puts a vertex into the first parameter that takes vertices; returns whether there is one. */
  take(vertex) {
    const parameter = this.chosen.parameters.find(({kind}) => kind === 'vertices');
    if (!parameter) return false;
    this.inputs.get(parameter.name).value = String(vertex);
    return true;
  }
}

function inputOf({kind, choices, default: usual, low, high}) {
  if (kind === 'choice') {
    const select = element('select', {});
    for (const {name, about} of choices) {
      select.append(element('option', {value: name, title: about, selected: name === usual}, name));
    }
    return select;
  }
  if (kind !== 'number' && kind !== 'count') return element('input', {type: 'text', value: usual});
  return element('input', {type: 'number', value: usual, placeholder: 'automatic', min: low, max: high, step: kind === 'count' ? 1 : 'any'});
}
