// Recorded trajectories on a canvas: tubes sorted by depth, with their shadows on the floor, between frames along
// straight ways. Dragging or the arrow keys turn the view; nothing plays by itself for readers who want less motion.

const lessMotion = window.matchMedia("(prefers-reduced-motion: reduce)");
const filmColours = {
  light: { paper: "#f4f2ec", floor: "#e6e2d8", shadow: "rgb(60 52 40 / 22%)", solid: "#b9b4aa" },
  dark: { paper: "#191d22", floor: "#23282e", shadow: "rgb(0 0 0 / 45%)", solid: "#6d7178" },
};

function decoded(text, Type) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  return new Type(bytes.buffer);
}

const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
const cross = (a, b) => [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
const along = (a, b, share) => a.map((value, k) => value + share * b[k]);
const unit = (a) => a.map((value) => value / Math.hypot(...a));

/** The view from an azimuth and elevation in degrees; up is an axis of the scene. */
function viewFrom(film, azimuth, elevation) {
  const level = Math.abs(film.up[0]) > 0.9 ? [0, -1, 0] : [1, 0, 0];
  const back = cross(level, film.up);
  const [a, e] = [azimuth, elevation].map((degrees) => (degrees * Math.PI) / 180);
  const towards = [0, 1, 2].map(
    (k) => Math.cos(e) * (Math.sin(a) * level[k] + Math.cos(a) * back[k]) + Math.sin(e) * film.up[k],
  );
  const forward = towards.map((value) => -value);
  const right = unit(cross(forward, film.up));
  return { forward, right, up: cross(right, forward), distance: 2.4 * film.extent };
}

/** [across, upwards, away, size of a metre there] of a point. */
function projected(film, view, x, y, z) {
  const from = [x - film.centre[0], y - film.centre[1], z - film.centre[2]];
  const away = dot(from, view.forward);
  const scale = view.distance / Math.max(0.05 * view.distance, view.distance + away);
  return [dot(from, view.right) * scale, dot(from, view.up) * scale, away, scale];
}

function shaded(colour, light) {
  const number = parseInt(colour.slice(1), 16);
  const part = (shift) => Math.round(Math.min(255, ((number >> shift) & 255) * light));
  return `rgb(${part(16)} ${part(8)} ${part(0)})`;
}

function startFilm(figure, film) {
  const canvas = figure.querySelector("canvas"),
    context = canvas.getContext("2d");
  const place = decoded(film.place, Uint16Array),
    segments = decoded(film.segments, Uint16Array);
  const colour = decoded(film.colour, Uint8Array),
    size = decoded(film.size, Uint16Array);
  const frames = film.time_s.length,
    count = segments.length / 2,
    end = film.time_s[frames - 1] - film.time_s[0];
  let view = viewFrom(film, film.azimuth, film.elevation),
    turned = [film.azimuth, film.elevation];
  let time = lessMotion.matches ? end / 2 : 0,
    playing = false,
    before = null,
    visible = false,
    width = 0,
    height = 0;
  const fit = fitted();

  const play = element("button", { type: "button", class: "play", onclick: () => (playing ? pause() : start()) });
  const scrub = element("input", {
    type: "range",
    min: 0,
    max: end,
    step: end / 1000,
    value: 0,
    "aria-label": "Time",
    oninput: () => {
      pause();
      time = Number(scrub.value);
      draw();
    },
  });
  const clock = element("output", { class: "clock" });
  const rate = element(
    "select",
    { "aria-label": "Speed" },
    ...[0.1, 0.25, 0.5, 1, 2].map((value) =>
      element("option", { value, selected: value === usualRate() }, `${value}×`),
    ),
  );
  figure.append(element("div", { class: "playback" }, play, scrub, clock, rate));

  function usualRate() {
    return [2, 1, 0.5, 0.25, 0.1].find((value) => end / value >= 3) ?? 0.1;
  }

  function onFloor(point) {
    return along(point, film.up, film.floor - dot(point, film.up));
  }

  /** Where the scene is in the first view, over all frames. */
  function fitted() {
    const low = [Infinity, Infinity],
      high = [-Infinity, -Infinity];
    const reach = Math.max(...film.sizes);
    const include = (point, radius) => {
      const [x, y, , scale] = projected(film, view, ...point);
      ((low[0] = Math.min(low[0], x - radius * scale)), (low[1] = Math.min(low[1], y - radius * scale)));
      ((high[0] = Math.max(high[0], x + radius * scale)), (high[1] = Math.max(high[1], y + radius * scale)));
    };
    for (let frame = 0; frame < frames; frame += Math.max(1, Math.floor(frames / 12))) {
      for (let k = 0; k < film.points; ++k) {
        const point = pointAt(k, frame, frame, 0);
        include(point, reach);
        if (film.floor !== null) include(onFloor(point), reach);
      }
    }
    for (const { start, end: last, radius } of film.capsules.filter((one) => one.radius < film.extent)) {
      include(start, radius);
      include(last, radius);
    }
    return { middle: [(low[0] + high[0]) / 2, (low[1] + high[1]) / 2], span: [high[0] - low[0], high[1] - low[1]] };
  }

  function pointAt(k, frame, next, share) {
    const a = 3 * (frame * film.points + k),
      b = 3 * (next * film.points + k);
    return [0, 1, 2].map((c) => film.low[c] + film.step * ((1 - share) * place[a + c] + share * place[b + c]));
  }

  function draw() {
    const colours = isDark() && !printing ? filmColours.dark : filmColours.light;
    const now = film.time_s[0] + time;
    let frame = d3.bisectRight(film.time_s, now) - 1;
    frame = Math.max(0, Math.min(frames - 1, frame));
    const next = Math.min(frames - 1, frame + 1),
      gap = film.time_s[next] - film.time_s[frame];
    const share = gap > 0 ? Math.min(1, (now - film.time_s[frame]) / gap) : 0;
    const zoom = 0.92 * Math.min(width / fit.span[0], height / fit.span[1]);
    const onto = ([x, y, away, scale]) => [
      width / 2 + zoom * (x - fit.middle[0]),
      height / 2 - zoom * (y - fit.middle[1]),
      away,
      zoom * scale,
    ];
    context.fillStyle = colours.paper;
    context.fillRect(0, 0, width, height);
    context.lineCap = "round";

    const points = Array.from({ length: film.points }, (_, k) => pointAt(k, frame, next, share));
    if (film.floor !== null && dot(view.forward, film.up) < 0) {
      ground(onFloor(film.centre), onto, colours);
      shadows(
        points.map((point) => onto(projected(film, view, ...onFloor(point)))),
        colours.shadow,
      );
    }
    const tubes = [];
    const seen = points.map((point) => onto(projected(film, view, ...point)));
    for (let k = 0; k < count; ++k) {
      const a = seen[segments[2 * k]],
        b = seen[segments[2 * k + 1]];
      tubes.push({ a, b, away: (a[2] + b[2]) / 2, radius: film.sizes[size[k]], colour: film.palette[colour[k]] });
    }
    for (const { start: from, end: to, radius, velocity } of film.capsules) {
      const [a, b] = [from, to].map((point) => onto(projected(film, view, ...along(point, velocity, now))));
      tubes.push({ a, b, away: (a[2] + b[2]) / 2, radius, colour: colours.solid });
    }
    tubes.sort((one, other) => other.away - one.away);
    for (const { a, b, away, radius, colour: own } of tubes) {
      const wide = Math.max(1.5, radius * (a[3] + b[3]));
      const depth = 1 - 0.22 * Math.max(-1, Math.min(1, (2 * away) / film.extent));
      if (Math.hypot(b[0] - a[0], b[1] - a[1]) < 0.05 * wide) {
        ball(a, wide / 2, own, depth);
        continue;
      }
      context.lineCap = "butt"; // a dark end would show on the next segment
      context.strokeStyle = shaded(own, 0.62 * depth);
      line(a, b, wide);
      context.lineCap = "round";
      context.strokeStyle = shaded(own, depth);
      line(shifted(a, -0.1 * wide), shifted(b, -0.1 * wide), 0.72 * wide);
      if (wide > 4) {
        context.strokeStyle = shaded(own, 1.28 * depth);
        line(shifted(a, -0.2 * wide), shifted(b, -0.2 * wide), 0.26 * wide);
      }
    }
    scrub.value = time;
    const said = `${(film.time_s[0] + time).toFixed(2)} s`;
    clock.textContent = said;
    scrub.setAttribute("aria-valuetext", said);
  }

  /** One path for all of a size, since shadows on shadows are no darker. */
  function shadows(points, colour) {
    const paths = film.sizes.map(() => new Path2D());
    for (let k = 0; k < count; ++k) {
      const a = points[segments[2 * k]],
        b = points[segments[2 * k + 1]];
      paths[size[k]].moveTo(a[0], a[1]);
      paths[size[k]].lineTo(b[0], b[1]);
    }
    const middle = d3.mean(points, (point) => point[3]);
    context.strokeStyle = colour;
    paths.forEach((path, k) => {
      context.lineWidth = Math.max(1, 2 * film.sizes[k] * middle);
      context.stroke(path);
    });
  }

  function ball([x, y], radius, colour, depth) {
    const light = context.createRadialGradient(x - 0.35 * radius, y - 0.45 * radius, 0.1 * radius, x, y, radius);
    light.addColorStop(0, shaded(colour, 1.25 * depth));
    light.addColorStop(0.6, shaded(colour, depth));
    light.addColorStop(1, shaded(colour, 0.6 * depth));
    context.fillStyle = light;
    context.beginPath();
    context.arc(x, y, radius, 0, 2 * Math.PI);
    context.fill();
  }

  function ground(middle, onto, colours) {
    const level = Math.abs(film.up[0]) > 0.9 ? [0, -1, 0] : [1, 0, 0],
      back = cross(level, film.up);
    context.beginPath();
    for (let k = 0; k < 48; ++k) {
      const angle = (k * Math.PI) / 24,
        radius = 0.72 * film.extent;
      const rim = along(along(middle, level, radius * Math.cos(angle)), back, radius * Math.sin(angle));
      const [x, y] = onto(projected(film, view, ...rim));
      context[k ? "lineTo" : "moveTo"](x, y);
    }
    context.closePath();
    context.fillStyle = colours.floor;
    context.fill();
  }

  const shifted = (point, by) => [point[0] + 0.5 * by, point[1] + by];

  function line(a, b, wide) {
    context.lineWidth = wide;
    context.beginPath();
    context.moveTo(a[0], a[1]);
    context.lineTo(b[0], b[1]);
    context.stroke();
  }

  function start() {
    playing = true;
    before = null;
    if (time >= end) time = 0;
    label();
    requestAnimationFrame(step);
  }

  function pause() {
    playing = false;
    label();
  }

  function label() {
    play.textContent = playing ? "Pause" : "Play";
  }

  function step(now) {
    if (!playing) return;
    if (visible) {
      if (before !== null) time += (Number(rate.value) * Math.min(100, now - before)) / 1000;
      if (time > end) time = 0;
      draw();
    }
    before = now;
    requestAnimationFrame(step);
  }

  function turn(across, upwards) {
    turned = [turned[0] + across, Math.max(-85, Math.min(89, turned[1] + upwards))];
    view = viewFrom(film, ...turned);
    draw();
  }

  let from = null;
  canvas.addEventListener("pointerdown", (event) => {
    from = [event.clientX, event.clientY];
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    if (from === null) return;
    turn(-0.4 * (event.clientX - from[0]), 0.4 * (event.clientY - from[1]));
    from = [event.clientX, event.clientY];
  });
  for (const name of ["pointerup", "pointercancel"])
    canvas.addEventListener(name, () => {
      from = null;
    });
  canvas.addEventListener("keydown", (event) => {
    const turns = { ArrowLeft: [-6, 0], ArrowRight: [6, 0], ArrowUp: [0, 6], ArrowDown: [0, -6] };
    if (!(event.key in turns)) return;
    event.preventDefault();
    turn(...turns[event.key]);
  });

  function resize() {
    const ratio = Math.max(2, window.devicePixelRatio);
    [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!width || !height) return;
    canvas.width = width * ratio;
    canvas.height = height * ratio;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    draw();
  }
  new ResizeObserver(resize).observe(canvas);
  new IntersectionObserver(
    ([entry]) => {
      const came = entry.isIntersecting && !visible;
      visible = entry.isIntersecting;
      if (came && !lessMotion.matches && !figure.dataset.played) {
        figure.dataset.played = "";
        start();
      }
    },
    { threshold: 0.4 },
  ).observe(canvas);
  document.addEventListener("theme", draw);
  document.addEventListener("printing", draw);
  label();
  resize();
}
