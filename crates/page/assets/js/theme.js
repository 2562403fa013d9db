// Colours, as the styles have them, and the switch between light and dark.

const root = document.documentElement;
const prefersDark = matchMedia("(prefers-color-scheme: dark)");
const repaint = new Set();

function colour(name) {
  return getComputedStyle(root).getPropertyValue("--" + name).trim();
}

// The same colour, with another opacity. The styles write colours as #rrggbb.
function faded(name, opacity) {
  const digits = colour(name).slice(1);
  const part = (at) => parseInt(digits.slice(at, at + 2), 16);
  return `rgba(${part(0)}, ${part(2)}, ${part(4)}, ${opacity})`;
}

function isDark() {
  return root.dataset.theme ? root.dataset.theme === "dark" : prefersDark.matches;
}

function startTheme(button) {
  const label = () => { button.textContent = isDark() ? "Light" : "Dark"; };
  const changed = () => { label(); repaint.forEach((paint) => paint()); };
  button.hidden = false;
  label();
  button.addEventListener("click", () => { root.dataset.theme = isDark() ? "light" : "dark"; changed(); });
  prefersDark.addEventListener("change", changed);
}
