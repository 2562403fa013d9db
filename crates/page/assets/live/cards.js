// The lanes of all properties at the top, and a card for each below.

const LANE_HEIGHT = 20;
// So many cards are open at first.
const OPEN = 6;
// So many violations are listed in a card.
const LISTED = 5;

const SIGNS = {
  violated: ["failed", "✕", "violated"], blind: ["open", "?", "cannot be judged now"],
  waiting: ["vacuous", "…", "waiting"], good: ["good", "✓", "holds so far"],
};

class Card {
  constructor(property, isOpen) {
    this.lane = new Strip(LANE_HEIGHT);
    const name = title(property);
    this.row = make("div", "row", make("span", "label", shortened(name, 40)), this.lane.element);
    this.row.title = name;
    this.badge = make("span", "badge");
    this.gist = make("p", "gist");
    this.now = make("p", "now");
    this.latest = make("ol", "latest");
    this.plots = property.plots.map((plot) => new Plot(plot));
    this.states = property.lanes.map((id) => ({ id, strip: new Strip(LANE_HEIGHT, "states"), label: make("p", "names") }));
    this.axis = make("div", "axis");
    const text = make("div", "text", make("pre", "source", property.text), make("p", "place", `${property.file}:${property.line}`), this.now, this.latest);
    const rows = this.states.flatMap(({ strip, label }) => [label, strip.element]);
    const charts = make("div", "charts", ...rows, ...this.plots.map((plot) => plot.element), this.axis);
    this.diagram = make("div", "diagrams");
    const heading = make("h3", "", this.badge, make("span", "name", name));
    this.element = make("details", "property", make("summary", "", heading, this.gist), make("div", "body", text, charts, this.diagram));
    this.element.open = isOpen;
    this.element.dataset.name = property.name;
  }

  paint(past, property) {
    const [kind, sign, word] = SIGNS[property.state];
    classes(this.element, `property ${kind}`);
    classes(this.badge, `badge ${kind}`);
    write(this.badge, `${sign} ${word}`);
    const times = property.violations ? `${property.violations} ${property.violations === 1 ? "time" : "times"}` : "";
    const values = property.values.map(([name, value]) => `${name} = ${value}`).join(", ");
    write(this.gist, [times, property.cause ?? values].filter((part) => part).join("; "));
    const violations = past.events.filter((e) => e.type === "violation" && e.name === property.name && e.file === property.file);
    paintLane(this.lane, property, violations.map((violation) => violation.failed));
    if (!this.element.open) return;
    write(this.now, property.cause ? `Cannot be judged now: ${property.cause}` : values ? `Now: ${values}` : "");
    if (property.margin !== null) write(this.now, `${this.now.textContent} (worst margin so far ${number(property.margin)})`);
    this.list(violations);
    this.states.forEach(({ id, strip, label }) => {
      const track = past.tracks.get(id);
      write(label, !track ? "" : track.kind === "ticks" ? track.name : `${track.name}: ${shownValue(track, sight.cursor ?? sight.to)}`);
      paintStates(strip, track);
    });
    // The drawing comes as HTML, from the hand that draws the report page's: in it all names are text already.
    if (this.drawn !== property.diagram) this.diagram.innerHTML = this.drawn = property.diagram;
    this.plots.forEach((plot) => plot.paint(past));
    if (this.plots.length || this.states.length) paintAxis(this.axis);
  }

  list(violations) {
    const key = violations.length ? `${violations.length} ${violations.at(-1).failed}` : "";
    if (this.listed === key) return;
    this.listed = key;
    this.latest.replaceChildren(...violations.slice(-LISTED).reverse().map((violation) => {
      const values = Object.entries(violation.values ?? {}).map(([name, value]) => `${name} = ${typeof value === "number" ? number(value) : JSON.stringify(value)}`);
      const since = violation.began === violation.failed ? "" : `, since ${seconds(violation.began, 1)}`;
      return make("li", "", make("strong", "", `${seconds(violation.failed, 1)}${since}`), values.length ? `  ${values.join(", ")}` : "");
    }));
  }
}

// All cards; they are made anew only where the properties, or what they draw, are others than before.
class Cards {
  constructor() {
    this.cards = [];
    this.layout = null;
    this.axis = make("div", "axis");
  }

  paint(past) {
    if (this.layout !== past.layout) this.make(past);
    this.cards.forEach((card, i) => card.paint(past, past.properties[i]));
    paintAxis(this.axis);
  }

  make(past) {
    this.layout = past.layout;
    const before = new Map(this.cards.map((card) => [card.element.dataset.name, card.element.open]));
    this.cards = past.properties.map((property, i) => new Card(property, before.get(property.name) ?? i < OPEN));
    at("lanes").replaceChildren(...this.cards.map((card) => card.row), make("div", "row", make("span", "label"), this.axis));
    at("cards").replaceChildren(...this.cards.map((card) => card.element));
    this.cards.forEach((card) => card.element.addEventListener("toggle", () => repaint.forEach((paint) => paint())));
  }
}
