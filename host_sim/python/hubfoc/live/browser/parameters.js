// The parameters of a wheel: unit, range, meaning; what was changed is marked, and stored through the lock.
import { byId, made, words, write } from "./format.js";
import { want } from "./link.js";
import { chosenWheel } from "./car.js";
import { drives } from "./controls.js";

let rows = []; // as the wheel says
let hello = null;
let edited = {}; // values by name
let waiting = false; // for the wheel

export function buildParameters() {
  byId("open-parameters").addEventListener("click", () => {
    byId("parameter-wheel").value = chosenWheel();
    byId("parameters").showModal();
    if (!waiting) read();
  });
  byId("parameter-close").addEventListener("click", () => byId("parameters").close());
  byId("parameter-wheel").addEventListener("change", read);
  byId("parameter-find").addEventListener("input", find);
  byId("parameter-store").addEventListener("click", store);
  byId("parameter-undo").addEventListener("click", () => {
    edited = {};
    show();
  });
}

export function greetParameters(told) {
  hello = told;
  byId("parameter-wheel").replaceChildren(...hello.wheels.map((name, wheel) => made("option", { value: wheel }, words(name))));
}

export function editedValues() {
  return edited;
}

function read() {
  wait("reading them by XCP …");
  want({ do: "parameters", wheel: Number(byId("parameter-wheel").value) });
}

function store() {
  const own = Number(byId("parameter-wheel").value);
  const wheels = byId("parameter-all").checked ? hello.wheels.map((_, wheel) => wheel) : [own];
  wait("checked, stored, and used after a restart …");
  want({ do: "store", wheels, values: edited });
}

function wait(why) {
  waiting = true;
  mark();
  write(byId("parameter-note"), why);
}

export function refuseParameters(why) {
  waiting = false;
  mark();
  if (byId("parameters").open) write(byId("parameter-note"), why);
}

export function showParameters(told) {
  waiting = false;
  rows = told.rows;
  byId("parameter-wheel").value = told.wheel;
  edited = Object.fromEntries(Object.entries(edited).filter(([name, values]) => differs(values, row(name)?.values)));
  show();
}

function row(name) {
  return rows.find((one) => one.name === name);
}

function differs(one, other) {
  return String(one) !== String(other);
}

function show() {
  const changed = ({ name, values, file }) => name in edited || differs(values, file);
  byId("parameter-lines").replaceChildren(...[...rows.filter(changed), ...rows.filter((one) => !changed(one))].map(line));
  mark();
  find();
}

function line({ name, values, file, unit, lowest, highest, text }) {
  const input = made("input", { "aria-label": name, autocomplete: "off", size: 12 });
  input.value = (edited[name] ?? values).join(" ");
  const own = made("tr", { "data-name": name });
  input.addEventListener("change", () => {
    const wanted = input.value.trim().split(/[\s,]+/).map(Number);
    const right = wanted.length === values.length && wanted.every((one) => Number.isInteger(one) && one >= lowest && one <= highest);
    input.setAttribute("aria-invalid", String(!right));
    delete edited[name];
    if (right && differs(wanted, values)) edited[name] = wanted;
    mark();
  });
  const other = differs(values, file) ? made("small", {}, `the file says ${file.join(" ")}`) : "";
  const range = `${lowest} to ${highest}`;
  own.append(
    made("th", { scope: "row" }, name),
    made("td", {}, input, other),
    made("td", {}, unit),
    made("td", { class: "soft" }, range),
    made("td", {}, text),
  );
  return own;
}

// Of each line: edited here, or another value in the wheel than in its file.
function mark() {
  const wrong = byId("parameter-lines").querySelectorAll("[aria-invalid=true]").length;
  for (const element of byId("parameter-lines").children) {
    const { name, values, file } = row(element.dataset.name);
    element.className = name in edited ? "edited" : differs(values, file) ? "other" : "";
  }
  const count = Object.keys(edited).length;
  byId("parameter-wheel").disabled = waiting;
  byId("parameter-store").disabled = waiting || count === 0 || wrong > 0 || !drives();
  byId("parameter-undo").disabled = count === 0;
  const note = wrong > 0 ? "out of range or not a whole number" : `${count} edited · at rest; the wheel restarts with them`;
  write(byId("parameter-note"), note);
}

function find() {
  const wanted = byId("parameter-find").value.trim().toLowerCase();
  for (const element of byId("parameter-lines").children) {
    element.hidden = wanted !== "" && !element.textContent.toLowerCase().includes(wanted);
  }
}
