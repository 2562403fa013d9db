// The stretch of time that all charts of a recording show.

// At most so far in, in seconds: a double still tells nanoseconds apart.
const NARROWEST = 1e-6;

class TimeWindow {
  constructor(whole) {
    const [from, to] = whole;
    // A recording of one moment still needs some room.
    this.whole = to > from ? whole : [from - 0.5, to + 0.5];
    this.range = this.whole;
    this.listeners = new Set();
  }

  get span() {
    return this.range[1] - this.range[0];
  }

  set(from, to) {
    const [first, last] = this.whole;
    const span = Math.min(Math.max(to - from, NARROWEST), last - first);
    const start = Math.min(Math.max((from + to - span) / 2, first), last - span);
    this.range = [start, start + span];
    this.listeners.forEach((tell) => tell(this));
  }

  all() {
    this.set(...this.whole);
  }

  zoom(factor) {
    const middle = (this.range[0] + this.range[1]) / 2;
    const half = this.span * factor / 2;
    this.set(middle - half, middle + half);
  }

  // By a part of what is shown.
  move(part) {
    const by = this.span * part;
    const [from, to] = this.range;
    const kept = Math.min(Math.max(by, this.whole[0] - from), this.whole[1] - to);
    this.set(from + kept, to + kept);
  }

  // Shows a violation with what is around it.
  frame(began, until) {
    const around = Math.max((until - began) * 0.75, Math.min((this.whole[1] - this.whole[0]) * 0.05, 0.5));
    this.set(began - around, until + around);
  }
}
