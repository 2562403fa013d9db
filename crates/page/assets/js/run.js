// A recording: its charts, its violations and the keys that move through it.

class Run {
  constructor(article, data) {
    this.article = article;
    this.data = data;
    this.view = new TimeWindow(data.range || [0, 1]);
    this.selected = null;
    this.order = Array.from(article.querySelectorAll("details.property"), (card) => Number(card.dataset.property));
    this.startCharts();
    this.startTools();
    article.addEventListener("click", (event) => this.clicked(event));
    article.addEventListener("keydown", (event) => this.pressed(event));
  }

  startCharts() {
    const { data, view } = this;
    this.charts = new Map();
    for (const figure of this.article.querySelectorAll("figure.chart")) {
      const number = Number(figure.dataset.property);
      const isLanes = figure.dataset.chart === "lanes";
      const draws = isLanes ? () => lanesFigure(data, view, this.order)
        : (width) => propertyFigure(data, view, number, this.selected?.property === number ? this.selected.violation : -1, width);
      if (!data.range || (!isLanes && !data.properties[number]) || !data.properties.length) { figure.remove(); continue; }
      const chart = new Chart(figure, view, draws);
      chart.onPick = (points) => this.picked(points);
      chart.onPoint = (event) => { figure.cursor = event.xvals?.[0] ?? figure.cursor; };
      this.charts.set(isLanes ? "lanes" : number, chart);
      this.describe(figure, isLanes ? null : data.properties[number]);
    }
    const lanes = this.article.querySelector("figure[data-chart=lanes]");
    if (!lanes) { this.article.querySelectorAll(".timeline, .bar").forEach((part) => part.remove()); return; }
    lanes.before(legend(data));
  }

  // What a screen reader says of a chart; what it shows is in the text beside it.
  describe(figure, property) {
    const what = property ? `Chart of ${property.name} and what it reads over time` : "Chart: a lane for each property over time";
    figure.tabIndex = 0;
    figure.setAttribute("role", "group");
    figure.setAttribute("aria-label", `${what}. The arrow keys move a cursor that tells the values, with Shift they move through time; `
      + "plus and minus zoom, 0 shows the whole recording, N and P go to the next and the previous violation.");
    const readout = document.createElement("p");
    readout.className = "readout";
    readout.setAttribute("role", "status");
    figure.append(readout);
  }

  startTools() {
    const tools = this.article.querySelector(".tools");
    if (!tools) return;
    tools.hidden = false;
    const shown = tools.querySelector(".shown");
    const tell = () => {
      const [from, to] = this.view.range;
      shown.textContent = `${seconds(from, this.view.span)} – ${seconds(to, this.view.span)}`;
    };
    this.view.listeners.add(tell);
    tell();
  }

  clicked(event) {
    const button = event.target.closest("button");
    if (button?.dataset.do) this.carryOut(button.dataset.do);
    if (button?.dataset.violation !== undefined) {
      const property = Number(button.closest("details.property").dataset.property);
      const violation = Number(button.dataset.violation);
      const isAgain = this.selected?.property === property && this.selected.violation === violation;
      if (isAgain) this.close(); else this.select(property, violation);
    }
  }

  carryOut(what) {
    const { view } = this;
    ({ earlier: () => view.move(-0.5), later: () => view.move(0.5), in: () => view.zoom(0.5), out: () => view.zoom(2), all: () => view.all() })[what]();
  }

  pressed(event) {
    if (event.ctrlKey || event.metaKey || event.altKey || event.target.closest("input, select, textarea")) return;
    const figure = event.target.closest("figure.chart");
    const arrow = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (arrow && figure) {
      if (event.shiftKey) this.view.move(arrow * 0.25); else this.point(figure, arrow);
    } else if (arrow && event.target.closest(".tools")) {
      this.view.move(arrow * 0.25);
    } else if (event.key === "+" || event.key === "=") this.view.zoom(0.5);
    else if (event.key === "-") this.view.zoom(2);
    else if (event.key === "0" || event.key === "Escape") this.view.all();
    else if (event.key === "n" || event.key === "p") this.step(event.key === "n" ? 1 : -1);
    else return;
    event.preventDefault();
  }

  // Moves the cursor of a chart by a fiftieth of what is shown, and tells the values there.
  point(figure, direction) {
    const { view } = this;
    const [from, to] = view.range;
    const now = figure.cursor ?? (direction > 0 ? from : to);
    figure.cursor = Math.min(Math.max(now + direction * view.span / 50, from), to);
    figure.querySelector(".readout").textContent = this.told(figure, figure.cursor);
    const plot = figure.chart.plot;
    if (plot) Plotly.Fx.hover(plot, { xval: figure.cursor });
  }

  // How everything in a chart stands at a time.
  told(figure, time) {
    const { tracks, properties } = this.data;
    const property = properties[Number(figure.dataset.property)];
    const stands = property ? [standAt(property, time)]
      : this.order.map((number) => `${properties[number].name}: ${standAt(properties[number], time)}`);
    const drawn = property ? [...property.lanes, ...property.plots.flatMap((plot) => plot.tracks)] : [];
    const values = drawn.map((t) => valueAt(tracks[t], time)).filter((text) => text);
    return `At ${seconds(time, this.view.span)}: ${[...stands, ...values].join(", ")}`;
  }

  // The next or previous violation, in the order of the page.
  step(by) {
    const all = this.order.flatMap((property) => this.data.properties[property].marks.map((_, violation) => ({ property, violation })));
    if (!all.length) return;
    const now = all.findIndex((v) => v.property === this.selected?.property && v.violation === this.selected?.violation);
    const next = all[now < 0 ? (by > 0 ? 0 : all.length - 1) : (now + by + all.length) % all.length];
    this.select(next.property, next.violation)?.focus();
  }

  picked(points) {
    const mark = points.find((p) => p.data.meta === "marks");
    if (mark) { this.select(...mark.customdata); return; }
    const bar = points.find((p) => p.data.type === "bar" && p.customdata?.[0] !== undefined);
    if (!bar) return;
    const [property, from, to, kind] = bar.customdata;
    const violation = this.data.properties[property].marks.findIndex(([began, , until]) => until >= from && began <= to);
    if (violation >= 0 && kind === "violated") this.select(property, violation);
    else this.card(property).open = true;
  }

  card(property) {
    return this.article.querySelector(`details.property[data-property="${property}"]`);
  }

  // Opens a violation in its list, and zooms to it. Gives its button.
  select(property, violation) {
    const card = this.card(property);
    this.close(card);
    card.open = true;
    this.selected = { property, violation };
    const [began, failed, until] = this.data.properties[property].marks[violation];
    this.view.frame(Math.min(began, failed), until);
    this.charts.get(property)?.change();
    const button = card.querySelector(`button[data-violation="${violation}"]`);
    button?.setAttribute("aria-expanded", "true");
    if (button) button.nextElementSibling.hidden = false;
    card.querySelector("figure.chart")?.scrollIntoView({ block: "nearest" });
    return button;
  }

  // Nothing is selected any more; what is open closes, in the card where something else opens.
  close(card = this.selected && this.card(this.selected.property)) {
    const before = this.selected;
    this.selected = null;
    for (const button of card.querySelectorAll("button[data-violation][aria-expanded=true]")) {
      button.setAttribute("aria-expanded", "false");
      button.nextElementSibling.hidden = true;
    }
    if (before) this.charts.get(before.property)?.change();
  }
}

function standAt(property, time) {
  const phase = property.phases.findLast(([from]) => from <= time);
  return phase ? STANDS[phase[2]] : "not started";
}

function valueAt(track, time) {
  if (track.kind === "ticks") return "";
  const last = after(track.x, time) - 1;
  if (last < 0 || track.y?.[last] === null) return `${track.name} has no value`;
  const state = track.kind === "steps" ? track.labels[track.states[last]] ?? "changing" : number(track.y[last]);
  return `${track.name} ${state}${track.unit ? " " + track.unit : ""}`;
}

function legend(data) {
  const stands = new Set(data.properties.flatMap((p) => p.phases.map((phase) => phase[2])));
  const list = document.createElement("ul");
  list.className = "legend";
  for (const stand of Object.keys(STANDS).filter((s) => stands.has(s))) {
    const item = document.createElement("li");
    item.style.setProperty("--swatch", `var(--${stand})`);
    item.classList.toggle("hatched", !!look(stand).hatch);
    item.textContent = STANDS[stand];
    list.append(item);
  }
  return list;
}
