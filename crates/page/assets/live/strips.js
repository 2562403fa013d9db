// Strips: time goes from left to right, what is now is at the right edge. Each is an SVG a thousand units wide that is stretched to its place.

const WIDTH = 1000;

// The stretch of time that all strips show, and the cursor in it.
const sight = { from: 0, to: 1, cursor: null };

function place(time) {
  return Math.min(Math.max((time - sight.from) / (sight.to - sight.from), 0), 1) * WIDTH;
}

function rounded(x) {
  return Math.round(x * 10) / 10;
}

class Strip {
  constructor(height, kind = "") {
    this.height = height;
    this.svg = draw("svg", "", { viewBox: `0 0 ${WIDTH} ${height}`, preserveAspectRatio: "none", "aria-hidden": "true" });
    this.line = make("i", "cursor");
    this.line.hidden = true;
    this.element = make("div", `track ${kind}`, this.svg, this.line);
    this.paths = new Map();
    this.texts = [];
  }

  // The path of a kind, which is made where there is none.
  path(kind, data) {
    let path = this.paths.get(kind);
    if (!path) {
      path = draw("path", kind);
      this.paths.set(kind, path);
      // What is filled lies below what is drawn with a line, whichever came first.
      if (kind.startsWith("fill")) this.svg.prepend(path); else this.svg.append(path);
    }
    path.setAttribute("d", data);
  }

  // Paths that were not drawn this time are empty.
  paint(drawn) {
    for (const kind of this.paths.keys()) if (!drawn.has(kind)) this.path(kind, "");
    drawn.forEach((data, kind) => this.path(kind, data));
    this.line.hidden = sight.cursor === null;
    if (sight.cursor !== null) this.line.style.left = `${place(sight.cursor) / WIDTH * 100}%`;
  }

  // Words in stretches that are wide enough for them.
  label(words) {
    words.forEach(([left, width, text], i) => {
      this.texts[i] ??= this.element.appendChild(make("span", "state"));
      write(this.texts[i], text);
      Object.assign(this.texts[i].style, { left: `${left}%`, maxWidth: `${width}%` });
    });
    this.texts.splice(words.length).forEach((text) => text.remove());
  }
}

// What stood from when until when, in sight.
function stretches(changes) {
  const all = [];
  changes.forEach(([from, kind], i) => {
    const until = i + 1 < changes.length ? changes[i + 1][0] : sight.to;
    if (until >= sight.from && from <= sight.to) all.push([place(from), place(until), kind]);
  });
  return all;
}

// Rectangles of one kind are one path. None is too narrow to be seen.
function boxes(all, height, kindOf) {
  const drawn = new Map();
  for (const [from, to, what] of all) {
    const kind = kindOf(what);
    const box = `M${rounded(from)} 0H${rounded(Math.max(to, from + 1))}V${height}H${rounded(from)}Z`;
    drawn.set(kind, (drawn.get(kind) ?? "") + box);
  }
  return drawn;
}

function verticals(times, height) {
  return times.filter((time) => time >= sight.from && time <= sight.to).map((time) => `M${rounded(place(time))} 0V${height}`).join("");
}

// How a property stood, and when it was violated.
function paintLane(strip, property, marks) {
  const drawn = boxes(stretches(property.changes), strip.height, (kind) => `fill-${kind}`);
  // Signs stay where stretches are too short to see, and are drawn above them.
  drawn.set("marks", verticals(marks, strip.height));
  strip.paint(drawn);
}

// A signal that is in one of several states, or happens now and then.
function paintStates(strip, track) {
  const points = track?.points ?? [];
  if (track?.kind === "ticks") { strip.paint(new Map([["ticks", verticals(points.map(([time]) => time), strip.height)]])); return; }
  strip.states ??= new Map();
  const kindOf = (state) => {
    if (state === null) return "fill-unclear";
    if (state === "true" || state === "false") return `fill-${state}`;
    if (!strip.states.has(state)) strip.states.set(state, strip.states.size);
    return `fill-state-${strip.states.get(state) % 5}`;
  };
  const all = stretches(points);
  strip.paint(boxes(all, strip.height, kindOf));
  const wide = all.filter(([from, to, state]) => to - from > 70 && state !== "false");
  strip.label(wide.map(([from, to, state]) => [from / 10, (to - from) / 10, state ?? "…"]));
}

// Ticks of the axis of time, at round seconds.
function paintAxis(axis) {
  const span = sight.to - sight.from;
  const step = [0.1, 0.2, 0.5, 1, 2, 5, 10, 20, 30, 60].find((s) => span / s <= 8) ?? 60;
  const marks = [];
  for (let time = Math.ceil(sight.from / step) * step; time <= sight.to; time += step) {
    const left = place(time) / 10;
    if (left > 2 && left < 98) marks.push([left, `${Number(time.toFixed(1))} s`]);
  }
  while (axis.children.length > marks.length) axis.lastChild.remove();
  marks.forEach(([left, text], i) => {
    const mark = axis.children[i] ?? axis.appendChild(make("span"));
    mark.style.left = `${left}%`;
    write(mark, text);
  });
}
