/**
 * On a telephone the plots of a figure go below one another, and a line says so where there is more
 * to the side.
 */
export class Stack {
  static MARGIN = 16;

  /** Keeps every figure as wide as its screen wants it. */
  static watch() {
    const narrow = matchMedia('(max-width: 40rem)');
    const all = [...document.querySelectorAll('svg.figure')].map((svg) => new Stack(svg));
    const boxes = [...document.querySelectorAll('figure.picture')];
    const fit = () => {
      all.forEach((figure) => figure.fit(narrow.matches));
      for (const box of boxes) {
        // The outermost pixels are empty.
        const hidden = box.scrollWidth - box.clientWidth - Stack.MARGIN / 2;
        box.classList.toggle('scrolls', narrow.matches && hidden > 0);
      }
    };
    narrow.addEventListener('change', fit);
    addEventListener('resize', fit);
    // A figure in a closed fold has no size.
    for (const fold of document.querySelectorAll('main details')) fold.addEventListener('toggle', fit);
    fit();
  }

  constructor(svg) {
    this.svg = svg;
    this.plots = [...svg.children].filter((g) => g.tagName === 'g' && g.querySelector(':scope > metadata'));
    this.letters = [...svg.children].filter((e) => e.tagName === 'text');
    this.ground = svg.querySelector(':scope > rect');
    this.beside = ['viewBox', 'width', 'height'].map((name) => [name, svg.getAttribute(name)]);
    this.places = this.plots.map((g) => g.getAttribute('transform'));
    this.stacked = false;
  }

  fit(narrow) {
    if (this.plots.length > 1) {
      if (narrow !== this.stacked) this.arrange(narrow);
    } else {
      this.svg.style.width = narrow ? Stack.readable(this.beside[1][1]) : '';
    }
  }

  /** Words stay readable: three quarters of their size at least. */
  static readable(width) {
    return `max(100%, ${0.75 * width}px)`;
  }

  arrange(narrow) {
    const boxes = this.plots.map((g) => g.getBBox());
    if (boxes.some(({width}) => !width)) return;
    this.stacked = narrow;
    for (const letter of this.letters) letter.style.display = narrow ? 'none' : '';
    this.svg.classList.toggle('stacked', narrow);
    if (!narrow) {
      for (const [name, value] of this.beside) this.svg.setAttribute(name, value);
      this.plots.forEach((g, i) => g.setAttribute('transform', this.places[i]));
      this.svg.style.width = '';
      return;
    }
    const margin = Stack.MARGIN;
    const width = Math.max(...boxes.map((box) => box.width)) + 2 * margin;
    let y = margin;
    this.plots.forEach((g, i) => {
      const {x, y: top, height} = boxes[i];
      g.setAttribute('transform', `translate(${margin - x} ${y - top})`);
      y += height + margin;
    });
    for (const [name, value] of [['viewBox', `0 0 ${width} ${y}`], ['width', width], ['height', y]]) this.svg.setAttribute(name, value);
    // The ground is drawn as large as it may have to be.
    this.ground?.setAttribute('width', Math.max(width, Number(this.beside[1][1])));
    this.ground?.setAttribute('height', Math.max(y, Number(this.beside[2][1])));
    this.svg.style.width = Stack.readable(width);
  }
}
