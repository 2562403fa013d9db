// What happened, the latest first, and the topics.

const ROWS = 100;

class Happened {
  constructor() {
    this.run = null;
    this.last = null;
  }

  paint(past) {
    const list = at("events");
    const events = past.events.filter((event) => ["violation", "warning", "verdict"].includes(event.type));
    const known = this.run === past.run ? events.lastIndexOf(this.last) + 1 : 0;
    if (known === 0) list.replaceChildren();
    list.prepend(...events.slice(known).reverse().map(eventRow));
    while (list.children.length > ROWS) list.lastChild.remove();
    [this.run, this.last] = [past.run, events.at(-1)];
  }
}

function eventRow(event) {
  const when = event.failed ?? event.at;
  const time = make("time", "", when === undefined ? "" : seconds(when, 1));
  if (event.type === "violation") {
    const what = make("span", "what", event.name);
    if (event.text) what.append(make("code", "", shortened(event.text.replace(/\s+/g, " "), 120)));
    return make("li", "", time, make("span", "violation", "violated"), what);
  }
  if (event.type === "warning") return make("li", "", time, make("span", "warning", "warning"), make("span", "what", event.message));
  return make("li", "", time, make("span", "", event.verdict), make("span", "what", event.name + (event.cause ? `: ${event.cause}` : "")));
}

function paintTopics(state) {
  const body = at("topic-rows");
  while (body.children.length > state.topics.length) body.lastChild.remove();
  state.topics.forEach((topic, i) => {
    const row = body.children[i] ?? body.appendChild(topicRow());
    const [name, rate, messages, publishers, type] = row.children;
    write(name.firstChild, topic.name);
    write(rate, `${topic.rate.toFixed(1)} Hz`);
    write(messages, String(topic.messages));
    write(publishers, String(topic.publishers));
    write(type, topic.causes.join("; ") || topic.type || "");
    classes(type, topic.causes.length ? "blind" : "");
  });
}

function topicRow() {
  return make("tr", "", make("td", "", make("code")), make("td", "count"), make("td", "count"), make("td", "count"), make("td"));
}
