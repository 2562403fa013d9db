// Curves on one pair of axes, with the values that they are compared with.

const CURVE_HEIGHT = 100;

class Plot {
  constructor(plot) {
    this.plot = plot;
    this.strip = new Strip(CURVE_HEIGHT, "curve");
    this.most = make("span", "scale most");
    this.least = make("span", "scale least");
    this.strip.element.append(this.most, this.least);
    this.names = make("p", "names");
    this.limits = plot.limits.map(() => this.strip.svg.appendChild(draw("line", "limit", { x1: 0, x2: WIDTH })));
    this.element = make("div", "", this.names, this.strip.element);
  }

  paint(past) {
    const tracks = this.plot.tracks.map((id) => past.tracks.get(id));
    const [least, greatest] = this.extent(tracks);
    const height = (value) => rounded((greatest - value) / (greatest - least) * CURVE_HEIGHT);
    this.strip.paint(new Map(tracks.map((track, i) => [`line stroke-${i % 5}`, this.curve(track, height)])));
    this.plot.limits.forEach(([value], i) => {
      this.limits[i].setAttribute("y1", height(value));
      this.limits[i].setAttribute("y2", height(value));
    });
    write(this.most, number(greatest));
    write(this.least, number(least));
    this.name(tracks);
  }

  // All that is in sight and the limits, with a little room.
  extent(tracks) {
    let [least, greatest] = [Infinity, -Infinity];
    const see = (value) => {
      if (value === null) return;
      least = Math.min(least, value);
      greatest = Math.max(greatest, value);
    };
    this.plot.limits.forEach(([value]) => see(value));
    for (const track of tracks) {
      const points = track?.points ?? [];
      points.forEach(([time, value], i) => {
        if ((points[i + 1]?.[0] ?? sight.to) >= sight.from && time <= sight.to) see(value);
      });
    }
    if (!(least <= greatest)) return [0, 1];
    const room = (greatest - least) * 0.08 || Math.abs(greatest) * 0.1 || 1;
    return [least - room, greatest + room];
  }

  // A value stands until the next; null is a gap.
  curve(track, height) {
    const points = track?.points ?? [];
    let [data, isDown] = ["", false];
    points.forEach(([time, value], i) => {
      const until = points[i + 1]?.[0] ?? sight.to;
      if (until < sight.from || time > sight.to) return;
      if (value === null) { isDown = false; return; }
      const x = rounded(place(time));
      data += isDown ? `V${height(value)}` : `M${x} ${height(value)}`;
      data += `H${rounded(place(until))}`;
      isDown = true;
    });
    return data;
  }

  name(tracks) {
    const time = sight.cursor ?? sight.to;
    const texts = tracks.map((track, i) => [`ink-${i % 5}`, track ? `${track.name}: ${shownValue(track, time)}` : ""]);
    const limits = [...new Set(this.plot.limits.map(([, text]) => text))].join(", ");
    if (limits) texts.push(["limit", limits]);
    while (this.names.children.length < texts.length) this.names.append(make("span"));
    texts.forEach(([kind, text], i) => {
      classes(this.names.children[i], kind);
      write(this.names.children[i], text);
    });
  }
}
