// Starts everything. Printing shows all: charts of every panel, open tables, light colours.

function start() {
  startTheme();
  for (const table of document.querySelectorAll("table.sortable")) makeSortable(table);
  for (const svg of document.querySelectorAll("svg.swatch[data-label]")) {
    const family = data[svg.dataset.sweep].families.find((one) =>
      one.lines.some((line) => line.label === svg.dataset.label),
    );
    const index = family?.lines.findIndex((line) => line.label === svg.dataset.label);
    if (family) drawSwatch(svg, family.lines[index], index === family.reference);
    else svg.remove();
  }
  document.querySelectorAll(".explorer").forEach((root, number) => {
    const sweep = data[root.dataset.sweep];
    startExplorer(root, sweep, sweep.families[root.dataset.family], number);
  });
  for (const figure of document.querySelectorAll(".film")) {
    startFilm(figure, data[figure.dataset.sweep].animations[figure.dataset.film]);
  }
  document.getElementById("go")?.addEventListener("change", (event) => {
    document.getElementById(event.target.value).scrollIntoView();
  });
  window.addEventListener("beforeprint", () => print(true));
  window.addEventListener("afterprint", () => print(false));
}

function print(on) {
  printing = on;
  for (const details of document.querySelectorAll("details")) {
    if (on && !details.open) details.dataset.closed = "";
    if (on) details.open = true;
    else if ("closed" in details.dataset) {
      details.open = false;
      delete details.dataset.closed;
    }
  }
  document.dispatchEvent(new CustomEvent("printing"));
}

start();
