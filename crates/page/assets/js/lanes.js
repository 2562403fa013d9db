// Lanes: what stood how from when until when, as bars in a row.

const CURVES = ["curve-1", "curve-2", "curve-3", "curve-4", "curve-5"];

// What is drawn of a lane: its name and its stretches, each with a kind that has a colour, and a text.
function phaseLane(name, property, number) {
  const stretches = property.phases.map(([from, to, stand]) => ({ from, to, kind: stand, text: STANDS[stand] }));
  return { name, stretches, property: number };
}

// The keyword is enough to tell most scopes apart; the text beside has all of it.
function scopeLane(scope, all, place) {
  const word = (s) => s.name.split(" ")[0];
  const isAlone = all.every((other, i) => i === place || word(other) !== word(scope));
  const stretches = (scope.open || []).map(([from, to]) => ({ from, to, kind: "open", text: "open" }));
  const never = scope.open && stretches.length === 0;
  return { name: isAlone ? word(scope) : scope.name, stretches, note: never ? "never entered" : scope.open ? "" : "not shown: it depends on what comes later" };
}

function stepLane(track, end) {
  const until = (i) => (i + 1 < track.x.length ? track.x[i + 1] : end);
  const isTruth = track.labels.every((label) => label === "true" || label === "false");
  const all = track.x.map((from, i) => {
    const state = track.states[i];
    const text = state === null ? "…" : track.labels[state];
    const kind = state === null ? "unclear" : isTruth ? text : CURVES[state % CURVES.length];
    return { from, to: until(i), kind, text };
  });
  return { name: track.name, stretches: all.filter((s) => s.kind !== "false"), isTruth, isStates: true };
}

function look(kind) {
  switch (kind) {
    case "unmet": return { color: faded("unmet", 0.25), hatch: "/", line: colour("unmet") };
    case "waiting": return { color: faded("waiting", 0.35), hatch: "/", line: colour("waiting") };
    case "inconclusive": return { color: faded("inconclusive", 0.3), hatch: "/", line: colour("inconclusive") };
    case "unclear": return { color: faded("waiting", 0.5), hatch: ".", line: colour("muted") };
    case "true": return { color: colour("open") };
    case "holds": case "violated": case "idle": case "open": return { color: colour(kind) };
    default: return { color: faded(kind, isDark() ? 0.55 : 0.4) };
  }
}

// The part of a stretch that is in sight, so that what is written in it is in sight, too.
function cut(stretch, [from, to]) {
  return stretch.to < from || stretch.from > to ? null : { from: Math.max(stretch.from, from), to: Math.min(stretch.to, to) };
}

// A letter takes so many pixels when it is as small as can still be read.
const LETTER = 3.8;

// What is written in a stretch: nothing where it could not be read. The pointer tells it.
function written({ lane, stretch }, kind, range, pixels) {
  const text = lane.property === undefined && !lane.isTruth && kind !== "open" ? plain(stretch.text) : "";
  return text.length * LETTER <= ((stretch.to - stretch.from) / (range[1] - range[0])) * pixels ? text : "";
}

// One trace for each kind: plotly.js colours traces faster than bars.
function laneTraces(lanes, axis, range, pixels) {
  const kinds = new Map();
  for (const [row, lane] of lanes.entries()) {
    for (const whole of lane.stretches) {
      const part = range ? cut(whole, range) : whole;
      if (!part) continue;
      const stretch = { ...whole, ...part, whole };
      if (!kinds.has(stretch.kind)) kinds.set(stretch.kind, []);
      kinds.get(stretch.kind).push({ row, lane, stretch });
    }
  }
  return Array.from(kinds, ([kind, bars]) => {
    const { color, hatch, line = color } = look(kind);
    return {
      type: "bar", orientation: "h", xaxis: "x", yaxis: axis, showlegend: false, name: "",
      y: bars.map((b) => b.row), base: bars.map((b) => b.stretch.from), x: bars.map((b) => b.stretch.to - b.stretch.from),
      width: kind === "idle" || kind === "waiting" ? 0.36 : 0.68,
      // The line makes sure that what is short can be seen.
      marker: {
        color, line: { color: line, width: ["violated", "open", "true"].includes(kind) ? 1.5 : 0.5 },
        pattern: hatch ? { shape: hatch, size: 6, solidity: 0.2, fillmode: "overlay", fgcolor: line, fgopacity: 0.8 } : {},
      },
      text: range ? bars.map((b) => written(b, kind, range, pixels)) : undefined,
      textposition: "inside", insidetextanchor: "middle", textangle: 0, constraintext: "inside", textfont: { size: 11, color: colour("ink") },
      customdata: bars.map((b) => [b.lane.property, b.stretch.from, b.stretch.to, kind]),
      hovertext: bars.map((b) => `<b>${plain(shortened(b.lane.name, 60))}</b><br>${plain(b.stretch.text)}: ${lasts(b.stretch.whole)}`),
      hovertemplate: "%{hovertext}<extra></extra>",
    };
  });
}

function lasts({ from, to }) {
  return `${seconds(from, to - from)} – ${seconds(to, to - from)}`;
}

// Violations as signs, which stay when their bars are too short to see.
function markTrace(rows, axis, reach) {
  const marks = rows.flatMap(({ row, property, number }) => property.marks.map((mark, i) => ({ row, mark, number, i })));
  return {
    type: "scatter", mode: "markers", xaxis: "x", yaxis: axis, showlegend: false, name: "", cliponaxis: false,
    x: marks.map((m) => m.mark[1]), y: marks.map((m) => m.row - reach),
    marker: { symbol: "triangle-down", size: 9, color: colour("violated"), line: { width: 1, color: colour("surface") } },
    customdata: marks.map((m) => [m.number, m.i]),
    hovertext: marks.map((m) => `violated at ${seconds(m.mark[1], 1e-3)}`),
    hovertemplate: "%{hovertext}<br>click to zoom<extra></extra>",
    meta: "marks",
  };
}

function laneAxis(lanes, domain, most) {
  return {
    domain, fixedrange: true, range: [lanes.length - 0.5, -0.5], zeroline: false, showgrid: false, ticks: "outside", ticklen: 7,
    tickcolor: "rgba(0,0,0,0)",
    tickvals: lanes.map((_, row) => row), ticktext: lanes.map((lane) => plain(shortened(lane.name, most))), tickfont: { size: 12 },
  };
}

function laneNotes(lanes, axis) {
  return lanes.flatMap((lane, row) => (lane.note ? [{
    xref: "paper", yref: axis, x: 0, y: row, text: plain(lane.note), showarrow: false, xanchor: "left", font: { size: 11, color: colour("muted") },
  }] : []));
}
