// Texts for charts and for the status line.

// plotly.js takes a part of HTML for markup: names are to be read as they are.
function plain(text) {
  return text.replace(/&/g, "&amp;").replace(/</g, "&lt;").replace(/>/g, "&gt;");
}

function shortened(text, most) {
  const characters = Array.from(text);
  return characters.length > most ? characters.slice(0, most - 1).join("") + "…" : text;
}

// A time in seconds, with as many decimals as a window of that length needs.
function seconds(time, span) {
  const decimals = Math.max(0, Math.min(6, 3 - Math.floor(Math.log10(span > 0 ? span : 1))));
  return Number(time.toFixed(decimals)).toString() + " s";
}

function number(value) {
  return Number(value.toPrecision(5)).toString();
}

// A property that has no name goes by its text.
function title(property) {
  return /^line \d+$/.test(property.name) ? `${property.name.slice(5)}: ${property.text.replace(/\s+/g, " ")}` : property.name;
}

function withUnit(track) {
  return track.unit ? `${track.name} (${track.unit})` : track.name;
}

const STANDS = {
  violated: "violated", unmet: "did not happen", inconclusive: "cannot be judged", holds: "holds",
  idle: "nothing asked", waiting: "not started",
};
