// What this page knows: how things stand, and how they went as far back as it looks. It never keeps more than that.

const MOST_EVENTS = 200;
const MOST_POINTS = 4000;

class Past {
  constructor() {
    this.run = null;
    this.revision = 0;
    this.clear();
  }

  clear() {
    this.properties = [];
    this.tracks = new Map();
    this.events = [];
    this.state = null;
    // Grows when the cards have to be made anew.
    this.layout = (this.layout ?? 0) + 1;
  }

  // What has to be asked for.
  get query() {
    return this.run === null ? "" : `?run=${this.run}&since=${this.revision}`;
  }

  take(state) {
    if (state.since === 0 || state.run !== this.run) this.clear();
    this.run = state.run;
    this.revision = state.revision;
    this.state = state;
    state.properties.forEach((fresh, number) => this.property(fresh, number));
    this.properties.length = state.properties.length;
    for (const [id, fresh] of Object.entries(state.tracks)) this.track(id, fresh);
    this.events.push(...state.events);
    if (this.events.length > MOST_EVENTS) this.events.splice(0, this.events.length - MOST_EVENTS);
    this.forget(state.now - state.reach);
  }

  property(fresh, number) {
    const known = this.properties[number];
    if (fresh.name !== undefined) {
      const isSame = known?.name === fresh.name && known.file === fresh.file;
      this.properties[number] = { ...fresh, changes: isSame ? [...known.changes, ...fresh.changes] : fresh.changes };
      this.layout += 1;
      return;
    }
    if (!known) return;
    const changes = known.changes;
    changes.push(...fresh.changes);
    Object.assign(known, fresh, { changes });
  }

  track(id, fresh) {
    const known = this.tracks.get(id);
    if (known && known.kind === fresh.kind) known.points.push(...fresh.points);
    else this.tracks.set(id, fresh);
  }

  // What came last before the rest says how things stood then, and stays.
  forget(before) {
    const shorten = (list) => {
      let over = Math.max(0, list.length - MOST_POINTS);
      while (over + 1 < list.length && list[over + 1][0] < before) over += 1;
      if (over > 0) list.splice(0, over);
    };
    this.properties.forEach((property) => shorten(property.changes));
    this.tracks.forEach((track) => shorten(track.points));
  }
}

// The point that stands at a time.
function standing(points, time) {
  let [low, high] = [0, points.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (points[middle][0] <= time) low = middle + 1; else high = middle;
  }
  return low > 0 ? points[low - 1] : undefined;
}

// A value as text, with its unit.
function shownValue(track, time) {
  const value = track && standing(track.points, time)?.[1];
  if (value === undefined || value === null) return track?.kind === "steps" && value === null ? "changing" : "no value";
  if (typeof value === "number") return number(value) + (track.unit ? ` ${track.unit}` : "");
  return String(value);
}
