// One panel's chart: a line per guess with its 95 % intervals, by Observable Plot. Colours are CSS, so themes need no
// drawing anew; every line is a group of its own, which the cursor brings to the front.

const chartHeight = 320;
const chartTop = 30; // room for the axis's label
const dodge = 9; // pixels that lines of one point are spread over, so that intervals do not hide each other
const categoryDodge = 0.5; // the same between words, of their distance

/** What a chart shows: [{line, index, points: [{k, x, value, low, high, count}]}] of the lines that are on. */
function seriesOf(family, measure, axis, panel, state) {
  const found = [];
  family.lines.forEach((line, index) => {
    if (!state.on.has(index)) return;
    const points = panel.x
      .map((x, k) => ({
        k,
        x: axis.categorical ? panel.text[k] : x,
        ...estimateAt(family, measure, panel, k, index, state.tolerance, state.newton),
      }))
      .filter((point) => point.value !== undefined && (!measure.log || point.value > 0));
    if (points.length) found.push({ line, index, points });
  });
  return found;
}

/** The range of all panels that are shown, so that they can be compared. */
function commonRange(measure, allSeries, reference) {
  const values = allSeries
    .flatMap((series) => series.points.flatMap((p) => [p.value, p.low ?? p.value, p.high ?? p.value]))
    .filter((value) => !measure.log || value > 0);
  if (reference) values.push(1);
  if (!values.length) return measure.log ? [0.1, 10] : [0, 1];
  const [low, high] = d3.extent(values);
  if (measure.log) return [low / 1.15, high * 1.15];
  return [Math.min(0, low * 1.06), high > 0 ? high * 1.06 : 1];
}

function drawChart(family, measure, axis, panel, series, range, width) {
  const relative = measure.unit === "ratio" || measure.unit === "times";
  const marks = [];
  if (relative) marks.push(Plot.ruleY([1], { stroke: "var(--ink)", strokeWidth: 1 }));
  const spread = axis.categorical ? (categoryDodge * (width - 96)) / panel.x.length : dodge;
  series.forEach(({ line, index, points }, rank) => {
    if (relative && index === family.reference) return;
    const dx = series.length > 1 ? spread * (rank / (series.length - 1) - 0.5) : 0;
    const colour = `var(--line-${index})`;
    const sure = points.filter((point) => point.low !== null);
    const stroked = isStroked(line);
    const common = { x: "x", dx, ariaDescription: `line-${index}` };
    marks.push(
      Plot.ruleX(sure, { ...common, y1: "low", y2: "high", stroke: colour, strokeWidth: 1.2, strokeOpacity: 0.7 }),
      ...(axis.categorical
        ? []
        : [
            Plot.line(points, {
              ...common,
              y: "value",
              stroke: colour,
              strokeWidth: 1.8,
              strokeDasharray: line.dash || null,
              strokeLinejoin: "round",
            }),
          ]),
      Plot.dot(points, {
        ...common,
        y: "value",
        symbol: symbolOf(line),
        r: 3.8,
        fill: stroked ? "none" : colour,
        stroke: stroked ? colour : "var(--card)",
        strokeWidth: stroked ? 1.6 : 0.7,
      }),
    );
  });
  const texts = new Map(panel.x.map((x, k) => [axis.categorical ? panel.text[k] : x, panel.text[k]]));
  const plot = Plot.plot({
    width,
    height: chartHeight,
    marginLeft: 52,
    marginRight: 16,
    marginTop: chartTop,
    marginBottom: axis.categorical ? 62 : 40,
    style: { background: "none", color: "var(--ink)", fontFamily: "inherit", fontSize: "12px", overflow: "visible" },
    x: {
      type: axis.categorical ? "point" : axis.log ? "log" : "linear",
      label: axis.label + (axis.binned ? ", medians of bins" : ""),
      labelAnchor: "center",
      labelArrow: "none",
      insetLeft: 14,
      insetRight: 14,
      nice: false,
      ...(axis.categorical
        ? { domain: panel.text, tickRotate: longest(panel.text) * panel.text.length * 7 > width - 80 ? -20 : 0 }
        : !axis.binned && fits(axis, panel, width)
          ? { ticks: panel.x, tickFormat: (x) => texts.get(x) }
          : { ticks: 5, ...(axis.log ? { tickFormat: powerText } : {}) }),
    },
    y: {
      type: measure.log ? "log" : "linear",
      domain: range,
      label: measure.title + unitSigns[measure.unit],
      labelAnchor: "top",
      labelArrow: "none",
      grid: true,
      ...(measure.log ? { ticks: logTicks(...range), tickFormat: (y) => tickText(y, measure.unit) } : { ticks: 6 }),
    },
    marks,
  });
  for (const group of plot.querySelectorAll('g[aria-description^="line-"]')) {
    group.dataset.line = group.getAttribute("aria-description").slice(5);
    group.removeAttribute("aria-description");
  }
  return plot;
}

const longest = (texts) => Math.max(...texts.map((text) => text.length));

/** Is there room for a label at every point? */
function fits(axis, panel, width) {
  const x = panel.x.map((one) => (axis.log ? Math.log10(one) : one)).sort(d3.ascending);
  const span = x[x.length - 1] - x[0] || 1;
  const room = (d3.min(d3.pairs(x, (a, b) => b - a)) / span) * (width - 96);
  return x.length < 2 || room > 8 * longest(panel.text);
}

/** Few round numbers between the bounds, as in the figures. */
function logTicks(low, high) {
  let ticks = [];
  for (const leading of [[1], [1, 2, 5], [1, 1.5, 2, 3, 4, 5, 6, 8]]) {
    ticks = [];
    for (let k = Math.floor(Math.log10(low)); k <= Math.ceil(Math.log10(high)); ++k) {
      ticks.push(...leading.map((a) => Number(`${a}e${k}`)).filter((tick) => tick >= low && tick <= high));
    }
    if (ticks.length >= 3) break;
  }
  const every = Math.max(1, Math.floor(ticks.length / 6));
  return ticks.filter((_, k) => k % every === 0);
}

function tickText(value, unit) {
  const text =
    value >= 1e-3 && value < 1e5 ? String(Number(value.toPrecision(3))) : value.toExponential(0).replace("e+", "e");
  return unit === "times" ? `${text}×` : text;
}

const powerText = (value) => {
  const power = Math.log10(value);
  return Math.abs(power - Math.round(power)) < 1e-9 ? tickText(value, "") : "";
};
