import {element, readable} from '../../figure/viewer/dom.mjs';

/**
 * Points of plots: the one under the pointer shows its values and moves the sliders of the view
 * of the same experiment. Arrow keys go from point to point.
 */
export class PlotPoints {
  constructor(svg, views) {
    this.svg = svg;
    this.views = views;
    this.links = JSON.parse(svg.dataset.links ?? '[]');
    // Each plot of the figure has its points in coordinates of its own.
    this.all = [...svg.querySelectorAll('metadata')].flatMap((data) => {
      const {title, x, y, series} = JSON.parse(data.textContent);
      return series.flatMap(({name, points}) => points.map(([px, py, vx, vy]) => (
        {group: data.parentNode, title, x, y, name, place: [px, py], values: [vx, vy]})));
    });
    if (!this.all.length) return;
    this.tip = element('output', {class: 'tip', 'aria-live': 'polite', hidden: true});
    svg.after(this.tip);
    svg.addEventListener('pointermove', (e) => this.near(e.clientX, e.clientY));
    svg.addEventListener('pointerleave', () => this.leave());
    svg.addEventListener('click', () => this.follow());
    svg.addEventListener('blur', () => this.leave());
    svg.addEventListener('keydown', (e) => {
      const by = {ArrowRight: 1, ArrowLeft: -1}[e.key];
      if (by) this.show(this.all[(this.all.indexOf(this.at) + by + this.all.length) % this.all.length]);
      else if (e.key === 'Enter') this.follow();
      else return;
      e.preventDefault();
    });
  }

  /** Where a point is in the window. */
  seen({group, place}) {
    const at = this.svg.createSVGPoint();
    [at.x, at.y] = place;
    return at.matrixTransform(group.getScreenCTM());
  }

  near(x, y) {
    let [best, found] = [18, null];
    for (const point of this.all) {
      const at = this.seen(point);
      const far = Math.hypot(at.x - x, at.y - y);
      if (far < best) [best, found] = [far, point];
    }
    if (found) this.show(found);
    else this.leave();
  }

  leave() {
    this.at = null;
    this.mark?.remove();
    if (this.tip) this.tip.hidden = true;
  }

  show(point) {
    if (point === this.at) return;
    this.leave();
    this.at = point;
    this.mark = document.createElementNS('http://www.w3.org/2000/svg', 'circle');
    for (const [key, value] of Object.entries({cx: point.place[0], cy: point.place[1], r: 7, class: 'pointed'})) this.mark.setAttribute(key, value);
    point.group.append(this.mark);
    const [x, y] = point.values.map((v) => readable(v, 4));
    const view = this.view(point);
    this.tip.textContent = `${[point.title, point.name].filter(Boolean).join(', ')}: ${point.x.replace(/ in .*/, '')} ${x}, ${y}${view ? '. The view shows it; click to go there.' : ''}`;
    const [at, box] = [this.seen(point), this.svg.parentElement.getBoundingClientRect()];
    this.tip.style.left = `${Math.min(at.x - box.left + 12, Math.max(0, box.width - 220))}px`;
    this.tip.style.top = `${at.y - box.top + 12}px`;
    this.tip.hidden = false;
    this.move(point, view);
  }

  /** Shows the last point of a line, that of the finest mesh or of the worst case. */
  recall(name) {
    const line = this.all.filter((point) => point.name === name);
    const last = line.filter(({group}) => group === line[0].group).at(-1);
    if (last) this.show(last);
  }

  /** The view of a point, with the link that leads to it. */
  view(point) {
    const link = this.links.find(({plot, series}) => (!plot || plot === point.title) && (!series || series === point.name));
    const view = link && this.views.get(`${this.svg.dataset.section}-${link.view}`);
    return view ? {view, link} : null;
  }

  /**
   * The stops nearest to the point; a slider that has the name of its series as a stop goes there,
   * too.
   */
  async move(point, found) {
    if (!found) return;
    const {view, link} = found;
    await view.open();
    if (this.at !== point) return;
    const stops = view.description.sliders.map(({name, stops: all}, i) => {
      if (name === link.slider) return nearest(all.map(parseFloat), point.values[0]);
      return all.includes(point.name) ? all.indexOf(point.name) : view.state.stops[i];
    });
    view.live?.forget();
    view.change({stops});
  }

  follow() {
    const found = this.at && this.view(this.at);
    found?.view.figure.scrollIntoView({block: 'center'});
  }
}

/** The place of the number nearest to `x` in size. */
function nearest(numbers, x) {
  const far = (t) => Math.abs(Math.log(t) - Math.log(x));
  return numbers.reduce((best, t, i) => (far(t) < far(numbers[best]) ? i : best), 0);
}
