// Numbers and words as the page writes them, and elements.

export function fixed(value, decimals = 1) {
  if (value === null || value === undefined || !Number.isFinite(value)) return "–";
  const text = value.toFixed(decimals);
  return (Number(text) === 0 ? text.replace("-", "") : text).replace("-", "\u2212");
}

export function words(name) {
  return name.replaceAll("_", " ").toLowerCase();
}

export function power(watts) {
  return Math.abs(watts) < 1000 ? `${fixed(watts, 0)} W` : `${fixed(watts / 1000, 2)} kW`;
}

export function energy(joules) {
  return Math.abs(joules) < 1e6 ? `${fixed(joules / 1e3, 1)} kJ` : `${fixed(joules / 1e6, 2)} MJ`;
}

export function byId(id) {
  return document.getElementById(id);
}

// Text is only written where it differs: sixty times a second most of it does not.
export function write(element, text) {
  if (element.textContent !== text) element.textContent = text;
}

export function made(tag, attributes = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

export function drawn(tag, attributes = {}, ...children) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
  element.append(...children);
  return element;
}

export function move(element, attributes) {
  for (const [name, value] of Object.entries(attributes)) element.setAttribute(name, value);
}
