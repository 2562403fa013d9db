// The page: asks how things stand, again and again, and paints it.

// So long after an answer the next is asked for, in milliseconds; of a page that nobody sees, longer.
const PAUSE = 250;
const PAUSE_UNSEEN = 2000;
// An answer takes so long at most.
const PATIENCE = 5000;

const past = new Past();
const cards = new Cards();
const happened = new Happened();
let reach = 60;
let held = null;

function headline(properties) {
  const all = properties.length;
  if (all === 0) return ["good", "No property is watched"];
  const of = (n) => (all === 1 ? "The property" : n === all ? `All ${all} properties` : `${n} of ${all} properties`);
  const count = (state) => properties.filter((property) => property.state === state).length;
  const parts = [];
  if (count("violated")) parts.push(`${of(count("violated"))} violated`);
  const more = (n, what) => { if (n) parts.push(parts.length ? `${n} ${what}` : `${of(n)} ${what}`); };
  more(count("blind"), "cannot be judged now");
  more(count("waiting"), parts.length || count("waiting") > 1 ? "wait for what they read" : "waits for what it reads");
  const isGood = parts.length === 0;
  if (isGood) parts.push(`${of(all)} ${all === 1 ? "holds" : "hold"} so far`);
  return [count("violated") ? "failed" : isGood ? "good" : "open", parts.join(", ")];
}

function paintHead(state) {
  const [kind, words] = headline(past.properties);
  classes(at("head"), `verdict ${kind}`);
  write(at("headline"), words);
  write(at("source"), state.source);
  document.title = `${words} - Lapwing`;
  const { p50, p99 } = state.latency_ms;
  const latency = p50 === null ? "" : `, judged within ${p50.toFixed(2)} ms (99 %: ${p99.toFixed(2)} ms)`;
  write(at("meta"), `for ${(state.now - state.began).toFixed(1)} s, ${state.messages} messages${latency}, ${state.lost} lost`);
}

function paint() {
  const { state } = past;
  if (!state) return;
  sight.to = held ?? Math.max(state.now, state.began + 1);
  sight.from = Math.max(sight.to - reach, Math.min(state.began, sight.to - 5));
  write(at("shown"), `${seconds(sight.cursor ?? sight.from, 1)}${sight.cursor === null ? ` – ${seconds(sight.to, 1)}` : ""}`);
  paintHead(state);
  cards.paint(past);
  happened.paint(past);
  paintTopics(state);
}

async function look() {
  try {
    const answer = await fetch(`state.json${past.query}`, { cache: "no-store", signal: AbortSignal.timeout(PATIENCE) });
    if (!answer.ok) throw new Error(answer.status);
    past.take(await answer.json());
    at("gone").hidden = true;
  } catch {
    const since = past.state ? `; this is how things stood at ${seconds(past.state.now, 1)}` : "";
    write(at("gone"), `Lapwing has ended, or does not answer${since}.`);
    at("gone").hidden = false;
  }
  paint();
  setTimeout(look, document.hidden ? PAUSE_UNSEEN : PAUSE);
}

function choose(span) {
  reach = span;
  for (const button of document.querySelectorAll("[data-reach]")) button.setAttribute("aria-pressed", String(Number(button.dataset.reach) === span));
  paint();
}

function hold(isHeld) {
  held = isHeld ? sight.to : null;
  at("hold").setAttribute("aria-pressed", String(isHeld));
  paint();
}

// The cursor follows the mouse over any strip, and the arrow keys on the timeline.
function point(event) {
  const strip = event.target.closest?.(".track");
  const box = strip?.getBoundingClientRect();
  sight.cursor = box ? sight.from + (event.clientX - box.left) / box.width * (sight.to - sight.from) : null;
  paint();
}

function pressed(event) {
  const arrow = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
  if (event.key === "Escape") sight.cursor = null;
  else if (arrow) {
    const step = (sight.to - sight.from) / 50;
    sight.cursor = Math.min(Math.max((sight.cursor ?? sight.to) + arrow * step, sight.from), sight.to);
  } else return;
  event.preventDefault();
  paint();
}

startTheme(document.querySelector(".theme"));
repaint.add(paint);
document.querySelectorAll("[data-reach]").forEach((button) => button.addEventListener("click", () => choose(Number(button.dataset.reach))));
at("hold").addEventListener("click", () => hold(held === null));
document.addEventListener("mousemove", (event) => { if (sight.cursor !== null || event.target.closest?.(".track")) point(event); });
const lanes = at("lanes");
lanes.tabIndex = 0;
lanes.addEventListener("keydown", pressed);
document.addEventListener("visibilitychange", () => { if (!document.hidden) paint(); });
choose(reach);
look();
