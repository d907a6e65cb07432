/** Stores a value if there is one, and returns the stored one; null if nothing can be stored. */
function kept(name, value) {
  try {
    if (value !== undefined) localStorage.setItem(name, value);
    return localStorage.getItem(name);
  } catch {
    return null;
  }
}

/** Lets the button `theme` of a page switch between light and dark colours, and remembers which. */
export function followTheme() {
  const root = document.documentElement;
  const button = document.getElementById('theme');
  const dark = matchMedia('(prefers-color-scheme: dark)');
  const now = () => root.dataset.theme ?? (dark.matches ? 'dark' : 'light');
  const label = () => {
    button.textContent = now() === 'dark' ? 'light' : 'dark';
    button.setAttribute('aria-label', `switch to ${button.textContent} colours`);
  };
  button.hidden = false;
  button.addEventListener('click', () => {
    root.dataset.theme = now() === 'dark' ? 'light' : 'dark';
    kept('fairing-theme', root.dataset.theme);
    label();
  });
  const chosen = kept('fairing-theme');
  if (chosen === 'dark' || chosen === 'light') root.dataset.theme = chosen;
  dark.addEventListener('change', label);
  label();
}
