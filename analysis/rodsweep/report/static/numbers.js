// How numbers are written, and how the flat arrays of estimates are read. All scripts of the page share one scope.

let printing = false; // everything is shown, in light colours

const data = JSON.parse(document.getElementById("data").textContent);

const units = {
  ratio: (value) => value.toFixed(2),
  times: (value) => `${significant(value, 3)}×`,
  us: (value) => `${significant(value, 3)} µs`,
  count: (value) => significant(value, 3),
  part: (value) => significant(value, 2),
};

/** What stands behind a measure's title on an axis. */
const unitSigns = { ratio: " (–)", times: " (×)", us: " (µs)", count: "", part: " (–)" };

function significant(value, digits) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size < 1e-3 || size >= 1e5) return value.toExponential(digits - 1).replace("e+", "e");
  return value.toFixed(Math.max(0, digits - 1 - Math.floor(Math.log10(size))));
}

function valueText(estimate, unit) {
  return estimate === null || estimate.value === null ? "–" : units[unit](estimate.value);
}

function intervalText(estimate, unit) {
  return estimate === null || estimate.low === null
    ? ""
    : `[${units[unit](estimate.low)}, ${units[unit](estimate.high)}]`;
}

/** The estimate of a measure in a panel; newton: "first" or "all", where the measure has a choice. */
function estimateAt(family, measure, panel, point, line, tolerance, newton) {
  const width = linesOf(measure, panel);
  if (line >= width) return null;
  const n = Math.max(0, measure.newton.indexOf(newton));
  const t = measure.tolerances > 1 ? tolerance : 0;
  const at = ((n * panel.x.length + point) * width + line) * measure.tolerances + t;
  const [value, low, high, count] = panel.values[measure.name];
  return value[at] !== null
    ? { value: value[at], low: low[at], high: high[at], count: Array.isArray(count) ? count[at] : count }
    : null;
}

/** How many lines a measure has: the direct solve, the last of them, has no iterations. */
function linesOf(measure, panel) {
  return panel.values[measure.name][0].length / (measure.newton.length * panel.x.length * measure.tolerances);
}

/** An element with attributes, properties that begin with "on", and children. */
function element(tag, attributes = {}, ...children) {
  const made = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) {
    if (name.startsWith("on")) made.addEventListener(name.slice(2), value);
    else if (value === true) made.setAttribute(name, "");
    else if (value !== false && value !== null && value !== undefined) made.setAttribute(name, value);
  }
  made.append(...children.filter((child) => child !== null && child !== undefined));
  return made;
}

function svgElement(tag, attributes = {}) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

const colourOf = (line) => `light-dark(${line.light}, ${line.dark})`;

/** Draws a line as it is in the charts into an svg of 30 x 12 pixels: colour, dash and marker. */
function drawSwatch(svg, line, isReference = false) {
  svg.replaceChildren(
    svgElement("line", {
      x1: 0,
      x2: 30,
      y1: 6,
      y2: 6,
      "stroke-width": 2,
      "stroke-dasharray": line.dash,
      style: `stroke: ${colourOf(line)}`,
    }),
  );
  if (isReference) return;
  svg.append(
    svgElement("path", {
      d: d3.symbol(symbolOf(line), 36)(),
      transform: "translate(15,6)",
      style: isStroked(line)
        ? `fill: none; stroke: ${colourOf(line)}; stroke-width: 1.6`
        : `fill: ${colourOf(line)}`,
    }),
  );
}

function swatchOf(line) {
  const size = { width: 30, height: 12, viewBox: "0 0 30 12" };
  const swatch = svgElement("svg", { class: "swatch", "aria-hidden": "true", ...size });
  drawSwatch(swatch, line);
  return swatch;
}

const symbolOf = (line) => d3[`symbol${line.symbol}`];
const isStroked = (line) => ["Asterisk", "Plus", "Times"].includes(line.symbol);
