// Light or dark: what the system prefers, until the reader chooses.

function startTheme() {
  const button = document.getElementById("theme");
  const preferred = window.matchMedia("(prefers-color-scheme: dark)");
  let chosen = null;

  function show() {
    const dark = chosen === null ? preferred.matches : chosen === "dark";
    document.documentElement.dataset.theme = dark ? "dark" : "light";
    button.textContent = dark ? "Light" : "Dark";
    button.setAttribute("aria-label", dark ? "Use light colours" : "Use dark colours");
    document.dispatchEvent(new CustomEvent("theme"));
  }
  button.addEventListener("click", () => {
    chosen = document.documentElement.dataset.theme === "dark" ? "light" : "dark";
    show();
  });
  preferred.addEventListener("change", show);
  show();
}

const isDark = () => document.documentElement.dataset.theme === "dark";
