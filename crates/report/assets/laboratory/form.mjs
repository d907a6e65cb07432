import {element} from '../../../figure/viewer/dom.mjs';

/**
 * The form of a task: its methods and their parameters, from the tables of the module. `changed` is
 * called when a value was set by hand.
 */
export class Form {
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
    const {about} = this.chosen;
    rows.push(element('p', {class: 'hint'}, `${about[0].toUpperCase()}${about.slice(1)}.`));
    this.inputs.clear();
    for (const parameter of this.chosen.parameters) rows.push(this.row(parameter));
    this.place.replaceChildren(...rows);
  }

  row(parameter) {
    const {name, about, unit, range, required} = parameter;
    const input = inputOf(parameter);
    this.inputs.set(name, input);
    const slider = sliderOf(parameter, input);
    input.addEventListener('change', () => this.changed());
    slider?.addEventListener('input', () => this.changed());
    const numeric = ['number', 'count'].includes(parameter.kind);
    const title = [about, unit && `in ${unit}`, numeric && range !== 'finite' && range].filter(Boolean).join('; ');
    const words = element('span', {}, name, unit ? element('small', {}, ` ${unit}`) : '', required ? ' *' : '');
    const row = element('label', {class: 'row', title}, words, input);
    return slider ? element('div', {title}, row, slider) : row;
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
    // A default may have a name that is not offered elsewhere.
    const isOffered = choices.some(({name}) => name === usual);
    for (const {name, about} of isOffered ? choices : [{name: usual, about: 'the default'}, ...choices]) {
      select.append(element('option', {value: name, title: about, selected: name === usual}, name));
    }
    return select;
  }
  if (kind !== 'number' && kind !== 'count') return element('input', {type: 'text', value: usual});
  return element('input', {type: 'number', value: usual, placeholder: 'automatic', min: low, max: high, step: kind === 'count' ? 1 : 'any'});
}

/**
 * A slider that moves with a number, over its range or up to four times the default; null for
 * seeds, for tolerances and where it would jump.
 */
function sliderOf({name, kind, low, high, range, default: usual}, input) {
  const [from, start] = [low ?? 0, Number(usual)];
  const to = high ?? 4 * start;
  const isNumber = (kind === 'number' && (start === 0 || start >= 1e-3)) || (kind === 'count' && name !== 'seed');
  if (!isNumber || usual === '' || from >= to || to - from > 200 * Math.max(start, 1)) return null;
  const step = kind === 'count' ? 1 : (to - from) / 200;
  const [min, max] = [/positive|above/.test(range) ? from + step : from, /below/.test(range) ? to - step : to];
  const slider = element('input', {type: 'range', 'aria-label': `${name}, slider`, min, max, step, value: start});
  slider.addEventListener('input', () => {
    input.value = String(Number(Number(slider.value).toPrecision(3)));
  });
  input.addEventListener('change', () => {
    slider.value = input.value;
  });
  return slider;
}
