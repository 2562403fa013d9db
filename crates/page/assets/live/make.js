// Elements. What a specification or a robot has named only ever becomes text.

const at = (id) => document.getElementById(id);

function make(tag, kind, ...content) {
  const made = document.createElement(tag);
  if (kind) made.className = kind;
  made.append(...content);
  return made;
}

function draw(tag, kind, attributes = {}) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  made.setAttribute("class", kind);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}

// Writes a text where it is another one: what does not change keeps a selection and is not read aloud again.
function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

function classes(element, kind) {
  if (element.className !== kind) element.className = kind;
}
