// What plotly.js is asked to draw: the lanes of all properties, and a property with what it reads.

const LANE = 24;
const CURVE = 108;
const HEAD = 24;
const FOOT = 34;
const GAP = 12;
// As many as a wide screen has pixels for a chart.
const COLUMNS = 900;

function base(view, height, left) {
  return {
    height, margin: { l: left, r: 14, t: 6, b: FOOT }, barmode: "overlay", showlegend: false, hovermode: "closest", dragmode: "zoom",
    paper_bgcolor: "rgba(0,0,0,0)", plot_bgcolor: "rgba(0,0,0,0)",
    font: { family: getComputedStyle(document.body).fontFamily, size: 12, color: colour("ink") },
    hoverlabel: { bgcolor: colour("surface"), bordercolor: colour("muted"), font: { color: colour("ink"), size: 12 }, align: "left", namelength: -1 },
    xaxis: {
      range: view.range.slice(), ticksuffix: " s", showgrid: true, gridcolor: colour("grid"), zeroline: false, linecolor: colour("line"),
      tickcolor: colour("line"), ticks: "outside", nticks: 9, hoverformat: ".9~g", spikecolor: colour("muted"), spikethickness: 1, spikedash: "solid", exponentformat: "none", separatethousands: false,
    },
    shapes: [], annotations: [],
  };
}

function jumps(data) {
  return data.pieces.slice(1).map(([at]) => ({
    type: "line", xref: "x", yref: "paper", x0: at, x1: at, y0: 0, y1: 1, line: { color: colour("muted"), width: 1, dash: "dot" },
  }));
}

// A lane for each property, in the order of the page.
function lanesFigure(data, view, order) {
  const lanes = order.map((number) => phaseLane(title(data.properties[number]), data.properties[number], number));
  const rows = order.map((number, row) => ({ row, number, property: data.properties[number] }));
  const height = lanes.length * (LANE + 4) + FOOT + 10;
  const narrow = innerWidth < 700;
  const layout = base(view, height, narrow ? 104 : 218);
  layout.yaxis = laneAxis(lanes, [0, 1], narrow ? 13 : 30);
  layout.shapes = jumps(data);
  return { traces: [...laneTraces(lanes, "y", null), markTrace(rows, "y", 0.42)], layout };
}

// A property: how it stood, its scopes and states, what it reads, and its margin, above one another on one axis of time.
function propertyFigure(data, view, number, selected, width) {
  const property = data.properties[number];
  const end = view.whole[1];
  const steps = property.lanes.map((t) => data.tracks[t]).filter((t) => t.kind === "steps");
  const ticks = property.lanes.map((t) => data.tracks[t]).filter((t) => t.kind === "ticks");
  const lanes = [phaseLane("verdict", property, number), ...property.scopes.map((scope, i) => scopeLane(scope, property.scopes, i)), ...steps.map((t) => stepLane(t, end)),
    ...ticks.map((t) => ({ name: t.name, stretches: [], track: t }))];
  const plots = property.plots.map((plot) => ({ tracks: plot.tracks.map((t) => data.tracks[t]), limits: plot.limits }));
  if (property.margin && property.margin.x.length) plots.push({ tracks: [property.margin], limits: [], isMargin: true });

  const inner = lanes.length * LANE + plots.length * (GAP + HEAD + CURVE);
  const layout = base(view, inner + FOOT + 6, innerWidth < 700 ? 84 : 120);
  const pixels = width - layout.margin.l - layout.margin.r;
  const at = (pixels) => 1 - pixels / inner;
  layout.hovermode = plots.length ? "x unified" : "closest";
  layout.hoversubplots = "axis";
  layout.yaxis = laneAxis(lanes, [at(lanes.length * LANE), 1], 15);
  layout.shapes = [...jumps(data), ...shades(property, selected)];
  layout.annotations = laneNotes(lanes, "y");
  const traces = [...laneTraces(lanes, "y", view.range, pixels), ...tickTraces(lanes, "y")];
  traces.forEach((trace) => { if (plots.length) trace.hoverinfo = "skip", delete trace.hovertemplate; });
  // A machine's illegal moves are marked where they are made as well.
  const own = lanes.flatMap((lane, row) => (row === 0 || (lane.isStates && lane.name === property.name) ? [{ row, number, property }] : []));
  traces.push(markTrace(own, "y", 0.42));

  let top = lanes.length * LANE;
  plots.forEach((plot, i) => {
    const axis = `y${i + 2}`;
    top += GAP;
    layout.annotations.push(heading(plot, at(top + HEAD / 2)));
    top += HEAD;
    layout[`yaxis${i + 2}`] = curveAxis([Math.max(0, at(top + CURVE)), at(top)], plot);
    top += CURVE;
    traces.push(...curveTraces(plot, axis, view.range));
    layout.shapes.push(...limits(plot, axis));
  });
  layout.xaxis.anchor = plots.length ? `y${plots.length + 1}` : "y";
  return { traces, layout, isCut: true };
}

// The violations, over the whole height.
function shades(property, selected) {
  return property.marks.map(([began, failed, until], i) => ({
    type: "rect", xref: "x", yref: "paper", x0: Math.min(began, failed), x1: until, y0: 0, y1: 1, layer: "below",
    fillcolor: faded("violated", i === selected ? 0.22 : 0.12), line: { color: faded("violated", i === selected ? 0.9 : 0.35), width: i === selected ? 1.5 : 0.7 },
  }));
}

function heading(plot, y) {
  const names = plot.tracks.map((track, i) => `<span style="color:${curveColour(plot, i)}">${plain(shortened(withUnit(track), 48))}</span>`);
  const limited = plot.limits.length ? ` <span style="color:${colour("limit")}">${plain(shortened([...new Set(plot.limits.map((l) => l[1]))].join(", "), 40))}</span>` : "";
  const thinned = plot.tracks.some((t) => t.thinned) ? ` <span style="color:${colour("muted")}">(thinned, extremes kept)</span>` : "";
  return {
    xref: "paper", yref: "paper", x: 0, y, xanchor: "left", yanchor: "middle", showarrow: false, align: "left", font: { size: 12 },
    text: names.join(" &nbsp; ") + limited + thinned,
  };
}

function curveColour(plot, i) {
  return plot.isMargin ? colour("muted") : colour(CURVES[i % CURVES.length]);
}

function curveAxis(domain, plot) {
  return {
    domain, fixedrange: true, gridcolor: colour("grid"), zeroline: !!plot.isMargin, zerolinecolor: colour("muted"), zerolinewidth: 1, nticks: 4,
    linecolor: colour("line"), tickfont: { size: 11, color: colour("muted") }, exponentformat: "none", range: extent(plot),
  };
}

// Curves and limits, with a little room; all of it, so that zooming in time does not move the scale.
function extent(plot) {
  const all = plot.limits.map((l) => l[0]);
  let [least, greatest] = [Infinity, -Infinity];
  for (const values of [all, ...plot.tracks.map((t) => t.y)]) {
    for (const value of values) {
      if (value === null) continue;
      if (value < least) least = value;
      if (value > greatest) greatest = value;
    }
  }
  if (plot.isMargin) [least, greatest] = [Math.min(least, 0), Math.max(greatest, 0)];
  const room = (greatest - least) * 0.08 || Math.abs(greatest) * 0.1 || 1;
  return [least - room, greatest + room];
}

function curveTraces(plot, axis, range) {
  const shown = plot.tracks.map((track) => inSight(track, range, COLUMNS));
  const line = (track, i) => ({
    type: "scatter", mode: track.x.length < 3 ? "lines+markers" : "lines", xaxis: "x", yaxis: axis, ...shown[i], name: plain(shortened(track.name, 40)),
    line: { color: curveColour(plot, i), width: 1.6, shape: "hv", simplify: true }, marker: { size: 4 },
    hovertemplate: `%{y:.5~g}${track.unit ? " " + plain(track.unit) : ""}<extra>%{fullData.name}</extra>`, meta: "curve",
  });
  const traces = plot.tracks.map(line);
  if (plot.isMargin) {
    const [{ x, y }] = shown;
    traces.unshift({
      type: "scatter", mode: "lines", xaxis: "x", yaxis: axis, x, y: y.map((value) => (value === null ? null : Math.min(value, 0))), hoverinfo: "skip",
      fill: "tozeroy", fillcolor: faded("violated", 0.35), line: { width: 0, shape: "hv" },
    });
  }
  return traces;
}

function tickTraces(lanes, axis) {
  const rows = lanes.flatMap((lane, row) => (lane.track ? [{ row, track: lane.track }] : []));
  return rows.map(({ row, track }) => ({
    type: "scatter", mode: "markers", xaxis: "x", yaxis: axis, x: track.x, y: track.x.map(() => row), name: plain(shortened(track.name, 40)),
    marker: { symbol: "line-ns-open", size: 12, color: colour("curve-1"), line: { width: 1.5, color: colour("curve-1") } },
    hovertemplate: "%{x} s<extra>%{fullData.name}</extra>",
  }));
}

function limits(plot, axis) {
  return plot.limits.map(([value]) => ({
    type: "line", xref: "paper", yref: axis, x0: 0, x1: 1, y0: value, y1: value, line: { color: colour("limit"), width: 1, dash: "dash" },
  }));
}
