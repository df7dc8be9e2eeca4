// The cursor of a chart: the pointer or the arrow keys choose a point, and a box lists what all lines are there. What
// the keys choose is also said to screen readers.

function addCursor(frame, plot, { measure, axis, panel, series, say }) {
  const box = element("div", { class: "readout", "aria-hidden": "true", hidden: true });
  const xScale = plot.scale("x"),
    yScale = plot.scale("y");
  const places = panel.x.map((x, k) => xScale.apply(axis.categorical ? panel.text[k] : x));
  const rule = svgElement("line", { class: "cursor", y1: chartTop, y2: chartHeight - (axis.categorical ? 62 : 40) });
  rule.style.display = "none";
  plot.append(rule);
  frame.append(box);
  let point = null,
    chosen = null;

  const unit = measure.unit;
  const at = (one, k) => one.points.find((candidate) => candidate.k === k);
  const known = (k) => series.filter((one) => at(one, k)).sort((a, b) => at(a, k).value - at(b, k).value);

  function show(k, index, spoken) {
    const lines = known(k);
    if (!lines.length) return hide();
    point = k;
    chosen = lines.some((one) => one.index === index) ? index : lines[0].index;
    rule.setAttribute("x1", places[k]);
    rule.setAttribute("x2", places[k]);
    rule.style.display = "";
    frame.dataset.chosen = chosen;
    for (const group of plot.querySelectorAll("g[data-line]")) {
      group.classList.toggle("faded", Number(group.dataset.line) !== chosen);
    }
    box.replaceChildren(
      element("p", {}, `${axis.label}: `, element("b", {}, panel.text[k])),
      element(
        "table",
        {},
        element(
          "tbody",
          {},
          ...lines.map((one) => {
            const estimate = at(one, k);
            return element(
              "tr",
              { class: one.index === chosen ? "chosen" : null },
              element("td", {}, swatchOf(one.line)),
              element("td", {}, one.line.label),
              element("td", { class: "number" }, valueText(estimate, unit)),
              element("td", { class: "interval" }, intervalText(estimate, unit)),
            );
          }),
        ),
      ),
      element("p", { class: "small" }, countText(panel.simulations[k])),
    );
    box.hidden = false;
    // On the side where it hides less of its own chart, if it fits there; never beyond the window.
    const begin = frame.getBoundingClientRect().left,
      there = begin + places[k],
      room = box.offsetWidth + 14;
    const fitsLeft = there > room,
      fitsRight = there + room < document.documentElement.clientWidth;
    const left = fitsLeft && (!fitsRight || places[k] < Math.min(room, frame.clientWidth - places[k]));
    const most = document.documentElement.clientWidth - begin - box.offsetWidth;
    box.style.left = left ? "auto" : `${Math.min(places[k] + 14, most)}px`;
    box.style.right = left ? `${frame.clientWidth - places[k] + 14}px` : "auto";
    if (spoken) {
      const one = lines.find((candidate) => candidate.index === chosen);
      const estimate = at(one, k);
      const within =
        estimate.low === null ? "" : `, 95 % interval ${units[unit](estimate.low)} to ${units[unit](estimate.high)}`;
      say(
        `${one.line.label} at ${axis.label} ${panel.text[k]}: ${valueText(estimate, unit)}${within}, ${countText(estimate.count)}`,
      );
    }
  }

  function hide() {
    box.hidden = true;
    rule.style.display = "none";
    point = chosen = null;
    delete frame.dataset.chosen;
    for (const group of plot.querySelectorAll("g.faded")) group.classList.remove("faded");
  }

  function pointAt(event) {
    const bounds = plot.getBoundingClientRect();
    const x = event.clientX - bounds.left,
      y = event.clientY - bounds.top;
    const k = d3.minIndex(places, (place) => Math.abs(place - x));
    const lines = known(k);
    const nearest = d3.least(lines, (one) => Math.abs(yScale.apply(at(one, k).value) - y));
    show(k, nearest?.index, false);
  }
  frame.addEventListener("pointermove", pointAt);
  frame.addEventListener("pointerdown", pointAt); // a tap moves nothing
  frame.addEventListener("pointerleave", (event) => {
    // A finger leaves as it is lifted: its values stay until the next tap outside, which blurs the frame.
    if (event.pointerType === "mouse" && document.activeElement !== frame) hide();
  });
  frame.addEventListener("blur", hide);
  frame.addEventListener("keydown", (event) => {
    const order = d3.sort(d3.range(places.length), (k) => places[k]);
    const lines = known(point ?? order[0]);
    const rank = lines.findIndex((one) => one.index === chosen);
    const along = (by) =>
      order[Math.min(order.length - 1, Math.max(0, point === null ? 0 : order.indexOf(point) + by))];
    const moves = {
      ArrowRight: () => show(along(1), chosen, true),
      ArrowLeft: () => show(along(-1), chosen, true),
      Home: () => show(order[0], chosen, true),
      End: () => show(order[order.length - 1], chosen, true),
      ArrowUp: () => show(point ?? order[0], lines[Math.min(lines.length - 1, rank + 1)]?.index, true),
      ArrowDown: () => show(point ?? order[0], lines[Math.max(0, rank - 1)]?.index, true),
      Escape: hide,
    };
    if (!(event.key in moves) || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    moves[event.key]();
  });
}

const countText = (count) => (count === 1 ? "1 simulation" : `${count} simulations`);
