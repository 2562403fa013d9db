// A chart on the page: drawn when it comes into sight, moved with the others, painted anew with the theme.

const CONFIG = { displayModeBar: false, doubleClick: false, responsive: true, scrollZoom: false, showTips: false };

const sight = new IntersectionObserver((entries) => {
  for (const entry of entries) entry.target.chart?.seen(entry.isIntersecting);
}, { rootMargin: "200px" });

class Chart {
  constructor(element, view, figure) {
    this.element = element;
    this.view = view;
    this.figure = figure;
    this.plot = null;
    this.isSeen = false;
    this.isStale = true;
    this.onPick = () => {};
    this.onPoint = () => {};
    element.chart = this;
    sight.observe(element);
    view.listeners.add(() => this.moved());
    repaint.add(() => this.change());
  }

  seen(isSeen) {
    this.isSeen = isSeen;
    if (isSeen && this.isStale) this.draw();
  }

  // What it shows has changed.
  change() {
    this.isStale = true;
    if (this.isSeen) this.draw();
  }

  draw() {
    this.isStale = false;
    const { traces, layout, isCut } = this.figure(this.element.clientWidth);
    this.isCut = isCut;
    if (this.plot) {
      this.quietly(() => Plotly.react(this.plot, traces, layout, CONFIG));
      return;
    }
    this.plot = document.createElement("div");
    this.element.prepend(this.plot);
    this.quietly(() => Plotly.newPlot(this.plot, traces, layout, CONFIG));
    this.plot.on("plotly_relayout", (change) => this.dragged(change));
    this.plot.on("plotly_doubleclick", () => this.view.all());
    this.plot.on("plotly_click", (event) => this.onPick(event.points));
    this.plot.on("plotly_hover", (event) => this.onPoint(event));
  }

  // The window moved: no more is done for what nobody sees than to remember it.
  moved() {
    if (!this.plot || this.isStale) return;
    if (!this.isSeen) { this.isStale = true; return; }
    if (this.isCut) { this.draw(); return; }
    this.quietly(() => Plotly.relayout(this.plot, { "xaxis.range": this.view.range.slice() }));
  }

  // The user drew a stretch to zoom to.
  dragged(change) {
    const [from, to] = [change["xaxis.range[0]"], change["xaxis.range[1]"]];
    if (!this.isQuiet && from !== undefined && to !== undefined) this.view.set(from, to);
  }

  // What we do ourselves is told to us as well.
  quietly(work) {
    this.isQuiet = true;
    Promise.resolve(work()).finally(() => { this.isQuiet = false; });
  }
}
