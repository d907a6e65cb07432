import {Camera} from '../../figure/viewer/camera.mjs';
import {colorMaps} from '../../figure/viewer/colors.mjs';
import {DenoisingPlayground} from './denoising.mjs';
import {DiffusionPlayground, OpeningPlayground} from './diffusion.mjs';
import {element, reveal} from '../../figure/viewer/dom.mjs';
import {EllipsoidPlayground} from './ellipsoid.mjs';
import {NoisePlayground} from './noise.mjs';
import {PlotPoints} from './points.mjs';
import {Renderer} from '../../figure/viewer/renderer.mjs';
import {Stack} from './stack.mjs';
import {followTheme} from './theme.mjs';
import {pause} from '../../web/assets/page.mjs';
import {View} from './view.mjs';

// Starts the page: opens views as they come near, keeps what is chosen in the address, and shows a
// figure in place of each view where there is no WebGL 2.

const PLAYGROUNDS = {
  denoising: DenoisingPlayground,
  diffusion: DiffusionPlayground,
  ellipsoid: EllipsoidPlayground,
  noise: NoisePlayground,
  opening: OpeningPlayground,
};

const views = new Map();
const plots = new Map();
const root = document.documentElement;

function playground(figure, maps) {
  const kind = PLAYGROUNDS[figure.dataset.play];
  if (!kind) throw new Error(`there is no playground ${figure.dataset.play}`);
  return new kind(figure, maps);
}

/** Without WebGL 2 or streams, the printed figure takes the view's place. */
function standIn(figure, why) {
  const picture = document.getElementById(figure.dataset.fallback)?.querySelector('img');
  const stage = figure.querySelector('.stage');
  const note = element('p', {class: 'hint'}, why);
  // A picture of its own is in the figure already, and shown once this is a still.
  const own = figure.querySelector('.paper');
  stage.replaceChildren(...(picture && !own ? [picture.cloneNode(), note] : [note]));
  figure.classList.add('still');
}

/** Opens what is folded around a figure, goes there, marks it alone and moves the focus to it. */
function mark(figure) {
  for (const other of document.querySelectorAll('figure.marked')) other.classList.remove('marked');
  reveal(figure);
  figure.classList.add('marked');
  figure.tabIndex = -1;
  figure.focus({preventScroll: true});
  figure.scrollIntoView({block: figure.offsetHeight < innerHeight ? 'center' : 'start'});
}

/** Large tables are kept as text until they are unfolded. */
function unfold(fold) {
  const text = fold.querySelector(':scope > noscript');
  if (!text) return;
  text.outerHTML = text.textContent;
  reachable(fold);
}

/** Makes boxes that scroll sideways reachable by keyboard. */
function reachable(part) {
  for (const box of part.querySelectorAll('.wide, pre, .formula, figure.picture')) {
    if (box.scrollWidth > box.clientWidth) box.tabIndex = 0;
  }
}

/**
 * The address holds `#view=state&view=state` or `#figure=line`; of other anchors figures are
 * marked, and what is folded is opened.
 */
function readAddress() {
  const hash = location.hash.slice(1);
  if (!hash.includes('=')) {
    const there = hash && document.getElementById(hash);
    if (!there) return;
    if (there.matches('figure.picture, figure.view, figure.play')) {
      mark(there);
      return;
    }
    const folded = there.closest('details:not([open])');
    reveal(there);
    if (folded) there.scrollIntoView();
    return;
  }
  let first = null;
  for (const [id, text] of new URLSearchParams(hash)) {
    if (plots.has(id)) {
      const plot = plots.get(id);
      mark(plot.svg.closest('figure'));
      plot.recall(text);
      continue;
    }
    const view = views.get(id);
    if (!view) continue;
    view.fromText(text);
    view.touched = true;
    first ??= view;
    open(view);
  }
  if (first) mark(first.figure);
}

let timer = null;
function writeAddress() {
  clearTimeout(timer);
  timer = setTimeout(() => {
    const parts = new URLSearchParams();
    for (const view of views.values()) if (view.touched) parts.set(view.id, view.toText());
    history.replaceState(null, '', `#${parts}`);
  }, 200);
}

/** Marks the section that is read in the contents. */
function follow() {
  const links = new Map([...document.querySelectorAll('nav a')].map((a) => [a.hash.slice(1), a]));
  const sections = [...links.keys()].map((id) => document.getElementById(id)).filter(Boolean);
  const mark = () => {
    const passed = sections.filter((s) => s.getBoundingClientRect().top < innerHeight / 3);
    const here = passed.at(-1)?.id;
    for (const [id, a] of links) {
      if (id === here) a.setAttribute('aria-current', 'true');
      else a.removeAttribute('aria-current');
    }
  };
  addEventListener('scroll', mark, {passive: true});
  mark();
}

async function open(view) {
  try {
    await view.open();
  } catch (error) {
    standIn(view.figure, `This view could not be opened: ${error.message}`);
    throw error;
  }
}

async function start() {
  followTheme();
  follow();
  await pause();
  const narrow = matchMedia('(max-width: 70rem)');
  const fold = () => { document.querySelector('nav details').open = !narrow.matches; };
  fold();
  narrow.addEventListener('change', fold);
  document.addEventListener('toggle', ({target}) => {
    if (!target.open) return;
    unfold(target);
    reachable(target);
  }, true);
  reachable(document);
  addEventListener('resize', () => reachable(document));
  await pause();
  const figures = [...document.querySelectorAll('figure.view')];
  const plays = [...document.querySelectorAll('figure.play')];
  const colors = colorMaps();
  const drawn = Renderer && typeof DecompressionStream !== 'undefined';
  for (const figure of figures) {
    if (drawn) views.set(figure.id, new View(figure, colors));
    else standIn(figure, 'This browser cannot draw the interactive view (it needs WebGL 2).');
  }
  // Without WebGL playgrounds have their plots and numbers.
  for (const figure of plays) views.set(figure.id, playground(figure, colors));
  for (const svg of document.querySelectorAll('svg.figure')) plots.set(svg.closest('figure').id, new PlotPoints(svg, views));
  Stack.watch();
  // The address of a link that was followed before does not change.
  document.addEventListener('click', ({target}) => {
    const link = target.closest?.('a.shown');
    if (link && link.hash === location.hash) readAddress();
  });
  document.addEventListener('fairing-state', ({detail}) => {
    detail.touched = true;
    writeAddress();
  });
  readAddress();
  addEventListener('hashchange', readAddress);
  const near = new IntersectionObserver((entries) => {
    for (const entry of entries) {
      if (!entry.isIntersecting) continue;
      near.unobserve(entry.target);
      open(views.get(entry.target.id));
    }
  }, {rootMargin: '600px'});
  for (const view of views.values()) near.observe(view.figure);
  // Paper has what is folded, but for tables of hundreds of rows.
  let opened = [];
  addEventListener('beforeprint', () => {
    opened = [...document.querySelectorAll('details:not([open], .rows)')];
    for (const fold of opened) {
      unfold(fold);
      fold.open = true;
    }
  });
  addEventListener('afterprint', () => {
    for (const fold of opened) fold.open = false;
  });
}

const started = start().then(() => {
  root.dataset.ready = '1';
});

/** Views by id and what draws them, for the console and for tests. */
window.fairing = {
  views,
  Camera,
  Renderer,
  /** Opens every view, playgrounds apart; resolves once all are drawn. */
  openAll: async () => {
    await started;
    for (const view of views.values()) if (view instanceof View) await open(view);
  },
};
