// Controls, charts and tables of a family: what is chosen is one object, and everything is drawn from it.

const mostCharts = 6;
const onPaper = ["ratio", "speedup_guess_cg", "speedup_step"]; // besides what is chosen

function startExplorer(root, sweep, family, number) {
  const first = family.measures[0];
  const state = {
    measure: first.name,
    axis: 0,
    tolerance: sweep.tolerance,
    newton: "first",
    settings: {},
    on: new Set(family.lines.keys()),
    all: false,
  };
  const id = (name) => `explorer-${number}-${name}`;
  const status = element("p", { class: "hidden", role: "status" });
  const say = (text) => {
    status.textContent = text;
  };
  const charts = element("div", { class: "charts" });
  const tables = element("div", { class: "tables" });
  const more = element("button", {
    type: "button",
    class: "more",
    onclick: () => {
      state.all = true;
      draw();
    },
  });
  const note = element("p", { class: "conditions" });
  const filters = element("div", { class: "filters" });
  const measure = () => family.measures.find((one) => one.name === state.measure);
  const axis = () => family.axes[state.axis];

  root.style.cssText = family.lines.map((line, k) => `--line-${k}: ${colourOf(line)}`).join(";");

  function choice(name, label, options, value, onchange) {
    const select = element(
      "select",
      {
        id: id(name),
        onchange: (event) => {
          onchange(event.target.value);
          update();
        },
      },
      ...options.map(([key, text]) => element("option", { value: key }, text)),
    );
    select.value = value;
    return element("div", { class: "control" }, element("label", { for: id(name) }, label), select);
  }

  const measureChoice = choice(
    "measure",
    "Show",
    family.measures.map((one) => [one.name, one.title]),
    state.measure,
    (value) => {
      state.measure = value;
    },
  );
  const axisChoice = choice(
    "axis",
    "Over",
    family.axes.map((one, k) => [String(k), one.label]),
    "0",
    (value) => {
      state.axis = Number(value);
      state.settings = {};
      state.all = false;
      buildFilters();
    },
  );
  const toleranceChoice = choice(
    "tolerance",
    "To the tolerance",
    sweep.tolerances.map((text, k) => [String(k), text]),
    String(state.tolerance),
    (value) => {
      state.tolerance = Number(value);
    },
  );
  const newtonChoice = element(
    "fieldset",
    { class: "control" },
    element("legend", {}, "Newton iterations"),
    element(
      "div",
      { class: "segmented" },
      ...["first", "all"].flatMap((key) => [
        element("input", {
          type: "radio",
          name: id("newton"),
          id: id(`newton-${key}`),
          value: key,
          checked: key === state.newton,
          onchange: () => {
            state.newton = key;
            update();
          },
        }),
        element("label", { for: id(`newton-${key}`) }, key),
      ]),
    ),
  );

  const settingOf = (panel, key) => (key === "scene" ? panel.scene : panel.settings[key]);

  /** A choice for the scene and for every grid of the job that is not along x. */
  function buildFilters() {
    filters.replaceChildren();
    for (const { key, label } of [{ key: "scene", label: "Scene" }, ...axis().settings]) {
      const values = new Set(axis().panels.map((panel) => settingOf(panel, key)));
      values.delete(undefined);
      if (values.size > 1) filters.append(filter(key, label, [...values]));
    }
  }

  function filter(key, label, values) {
    const options = values.map((value) => [value, value.replaceAll("_", " ")]);
    return choice(`filter-${key}`, label, [["", "all"], ...options], "", (value) => {
      if (value) state.settings[key] = value;
      else delete state.settings[key];
    });
  }

  function shownPanels() {
    return axis().panels.filter((panel) =>
      Object.entries(state.settings).every(([key, value]) => settingOf(panel, key) === value),
    );
  }

  const chips = family.lines.map((line, index) => {
    return element(
      "button",
      {
        type: "button",
        class: "chip",
        "aria-pressed": "true",
        onclick: () => {
          state.on[state.on.has(index) ? "delete" : "add"](index);
          update();
        },
      },
      swatchOf(line),
      line.label,
    );
  });
  const legend = element(
    "div",
    { class: "legend", role: "group", "aria-label": family.name === "guesses" ? "Guesses" : "Methods" },
    ...chips,
  );
  for (const text of family.lines.length > 2 ? ["All", "None"] : []) {
    const onclick = () => {
      state.on = new Set(text === "All" ? family.lines.keys() : []);
      update();
    };
    legend.append(element("button", { type: "button", class: "chip plain", onclick }, text));
  }
  const details = element("details", { class: "numbers" }, element("summary", {}, "The same as a table"), tables);

  root.replaceChildren(
    element(
      "div",
      { class: "controls" },
      measureChoice,
      axisChoice,
      family.measures.some((one) => one.tolerances > 1) ? toleranceChoice : null,
      family.measures.some((one) => one.newton.length > 1) ? newtonChoice : null,
      filters,
    ),
    legend,
    note,
    charts,
    more,
    details,
    status,
  );

  function update() {
    const lines = draw();
    const count = (number, word) => `${number} ${word}${number === 1 ? "" : "s"}`;
    say(`${title()}, ${count(shownPanels().length, "chart")}, ${count(lines.size, "line")}`);
  }

  function title(shown = measure()) {
    return (
      shown.title +
      (shown.tolerances > 1 ? ` at ${sweep.tolerances[state.tolerance]}` : "") +
      (shown.newton.length > 1
        ? `, ${state.newton === "all" ? "all Newton iterations" : "first Newton iteration"}`
        : "") +
      ` over ${axis().label}`
    );
  }

  /** The lines that have a point of what is chosen, by index; the reference's may be the rule at 1. */
  function draw() {
    const chosen = measure();
    toleranceChoice.querySelector("select").disabled = chosen.tolerances === 1;
    for (const input of newtonChoice.querySelectorAll("input")) input.disabled = chosen.newton.length === 1;
    chips.forEach((chip, index) => chip.setAttribute("aria-pressed", String(state.on.has(index))));
    const timed = chosen.unit === "us" || chosen.unit === "times";
    note.replaceChildren(
      chosen.note,
      ...(timed && sweep.warning ? [" ", element("strong", { class: "warned" }, sweep.warning)] : []),
    );
    const panels = shownPanels();
    const few = state.all || printing ? panels : panels.slice(0, mostCharts);
    charts.classList.toggle("single", few.length === 1);
    const width = chartWidth(few.length);
    charts.replaceChildren();
    tables.replaceChildren();
    const lines = new Set();
    for (const shown of printing
      ? family.measures.filter((one) => one === chosen || onPaper.includes(one.name))
      : [chosen]) {
      const series = few.map((panel) => seriesOf(family, shown, axis(), panel, state));
      const range = commonRange(shown, series.flat(), shown.unit === "ratio" || shown.unit === "times");
      if (shown === chosen) series.flat().forEach(({ index }) => lines.add(index));
      charts.append(...few.map((panel, k) => chart(shown, panel, series[k], range, width)));
      tables.append(...few.map((panel, k) => table(shown, panel, series[k])));
    }
    more.hidden = few.length === panels.length;
    more.textContent = `Show all ${panels.length} charts`;
    return lines;
  }

  function chartWidth(count) {
    const room = charts.clientWidth || 720;
    const columns = count === 1 ? 1 : Math.max(1, Math.min(count, Math.floor(room / 400)));
    return Math.max(280, Math.floor((room - 24 * (columns - 1)) / columns) - 26);
  }

  function chart(shown, panel, series, range, width) {
    const caption = element("figcaption", {}, panel.caption);
    if (!series.length) {
      return element(
        "figure",
        { class: "chart" },
        caption,
        element("p", { class: "empty" }, state.on.size ? "Not measured." : "Nothing to show: choose a guess above."),
      );
    }
    const frame = element("div", {
      class: "frame",
      tabindex: "0",
      role: "application",
      "aria-roledescription": "chart",
      "aria-label":
        `${title(shown)}, ${panel.caption}. Left and right go along the axis, up and down from line to line; ` +
        "the same is in a table below.",
    });
    const plot = drawChart(family, shown, axis(), panel, series, range, width);
    plot.setAttribute("aria-hidden", "true");
    frame.append(plot);
    addCursor(frame, plot, { measure: shown, axis: axis(), panel, series, say });
    return element("figure", { class: "chart" }, caption, frame);
  }

  function table(shown, panel, series) {
    const made = element(
      "table",
      { class: "sortable" },
      element("caption", {}, `${panel.caption}: ${title(shown)}`),
      element(
        "thead",
        {},
        element(
          "tr",
          {},
          heading(family.name === "guesses" ? "Guess" : "Method", ""),
          ...panel.text.map((text, k) => heading(k ? text : `${axis().label} ${text}`, "number")),
        ),
      ),
      element(
        "tbody",
        {},
        ...series.map(({ line, points }) =>
          element(
            "tr",
            {},
            element("th", { scope: "row" }, line.label),
            ...panel.x.map((_, k) => {
              const estimate = points.find((point) => point.k === k) ?? null;
              return element(
                "td",
                { class: "number", "data-value": estimate ? estimate.value : "" },
                valueText(estimate, shown.unit),
                " ",
                element("span", { class: "interval" }, intervalText(estimate, shown.unit)),
              );
            }),
          ),
        ),
      ),
    );
    makeSortable(made);
    return element("div", { class: "wide", tabindex: "0", role: "region", "aria-label": panel.caption }, made);
  }

  function heading(text, kind) {
    return element("th", { scope: "col", class: kind }, element("button", { type: "button", class: "sort" }, text));
  }

  let width = 0;
  new ResizeObserver(() => {
    if (charts.clientWidth === width) return;
    width = charts.clientWidth;
    draw();
  }).observe(charts);
  document.addEventListener("printing", draw);
  buildFilters();
  draw();
}
