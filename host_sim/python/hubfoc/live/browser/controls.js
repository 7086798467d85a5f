// Pedals, road, battery, temperature, direction, scenarios, pause; by pointer and by keys.
import { byId, fixed, made, words } from "./format.js";
import { want } from "./link.js";
import { choice } from "./car.js";

const DRIVE_MS = 50; // the vehicle releases the pedals of a page that is silent for half a second
const RELOADED_MS = 3000;
const STEP = 0.05; // of a pedal's travel, a key
const PEDALS = [
  ["accelerator", "accelerator", "W", "S", "motor-text"],
  ["brake", "brake", "B", "N", "hydraulic-text"],
];
const WORLD = [
  ["slope", "slope, %", -20, 20, 0.5, 100, ["U", "J"]],
  ["friction", "friction", 0.05, 1.2, 0.05, 1, ["I", "K"]],
  ["soc", "charge, %", 0, 100, 1, 100, ["O", "L"]],
  ["temperature_c", "winding, °C", -20, 180, 1, 1, ["T", "G"]],
];
const BUTTONS = ["stop", "descent_full", "contactor", "mu_split", "hill_hold", "hot_derate", "udds"];
const DIRECTIONS = ["forward", "neutral", "reverse"];

const pedals = { accelerator: 0, brake: 0 };
const sliders = {};
let direction = "forward";
let own = false;
let held = false; // the dead-man key, of real wheels
let asked = false; // for the controls that this very page had before it was loaded again
let paused = false;
let hello = null;

export function buildControls() {
  byId("sliders").replaceChildren(...PEDALS.map(pedal));
  byId("world").replaceChildren(...WORLD.map(setting));
  byId("direction").replaceChildren(...DIRECTIONS.map(radio));
  byId("take").addEventListener("click", () => want({ do: own ? "release" : "take" }));
  byId("pause").addEventListener("click", pause);
  byId("acknowledge").addEventListener("click", acknowledge);
  byId("scenario").addEventListener("change", (event) => scenario(event.target.value || null));
  setInterval(() => {
    if (own && !document.hidden) drive();
  }, DRIVE_MS);
  buildDeadMan();
  addEventListener("keydown", key);
  document.addEventListener("visibilitychange", release);
}

// Without the dead-man key real wheels get no torque from here, whatever the pedals show.
function drive() {
  const wanted = hello.real && !held ? { accelerator: 0, brake: 0 } : pedals;
  want({ do: "drive", ...wanted, direction });
}

function buildDeadMan() {
  const button = byId("dead-man");
  button.addEventListener("pointerdown", () => hold(true));
  for (const end of ["pointerup", "pointerleave", "pointercancel"]) button.addEventListener(end, () => hold(false));
  addEventListener("keyup", (event) => {
    if (event.key.toLowerCase() === "d") hold(false);
  });
  addEventListener("blur", () => hold(false));
}

function hold(wanted) {
  if (held === wanted) return;
  held = wanted;
  byId("dead-man").setAttribute("aria-pressed", String(held));
  if (own) drive();
}

function row(id, label, least, most, step, keys, style = "") {
  const input = made("input", { type: "range", id, min: least, max: most, step, value: 0, "data-needs": "controls" });
  const output = made("output", { for: id });
  const line = made(
    "label",
    { class: `slider ${style}` },
    made("span", {}, `${label} `, ...keys.map((text) => made("kbd", {}, text))),
    output,
    input,
  );
  return { line, input, output };
}

function pedal([name, label, up, down, style]) {
  const { line, input, output } = row(name, label, 0, 1, 0.01, [up, down], style);
  sliders[name] = { input, output };
  input.addEventListener("input", () => setPedal(name, Number(input.value)));
  return line;
}

function setting([name, label, least, most, step, factor, keys]) {
  const { line, input, output } = row(name, label, least, most, step, keys);
  sliders[name] = { input, output, factor, decimals: step < 0.1 ? 2 : step < 1 ? 1 : 0 };
  input.addEventListener("input", () => want({ do: "change", change: { [name]: Number(input.value) / factor } }));
  return line;
}

function radio(name) {
  const input = made("input", { type: "radio", name: "direction", value: name, "data-needs": "controls" });
  input.checked = name === direction;
  input.addEventListener("change", () => {
    direction = name;
  });
  return made("label", {}, input, ` ${name}`);
}

function setPedal(name, value) {
  pedals[name] = Math.min(Math.max(value, 0), 1);
  sliders[name].input.value = pedals[name];
  showPedals();
}

export function release() {
  hold(false);
  setPedal("accelerator", 0);
  setPedal("brake", 0);
}

function showPedals() {
  if (hello === null) return;
  sliders.accelerator.output.textContent = `${fixed(pedals.accelerator * hello.drive_nm, 0)} N m a wheel`;
  sliders.brake.output.textContent = `${fixed(pedals.brake * hello.brake_nm, 0)} N m a wheel`;
}

function pause() {
  want({ do: "change", change: { paused: !paused } });
}

function acknowledge() {
  release();
  want({ do: "acknowledge" });
}

function scenario(name) {
  release();
  want({ do: "change", change: { scenario: name } });
}

export function greetControls(told) {
  hello = told;
  document.documentElement.dataset.of = told.real ? "real" : "simulated";
  const buttons = [null, ...BUTTONS.filter((name) => name in told.scenarios)].map((name) => {
    const button = made("button", { "data-needs": "controls", "data-scenario": name ?? "", title: told.scenarios[name] ?? "" });
    button.textContent = name === null ? "nobody drives" : words(name);
    button.addEventListener("click", () => scenario(name));
    return button;
  });
  byId("scenarios").replaceChildren(...buttons);
  const options = Object.keys(told.scenarios).map((name) => made("option", { value: name }, words(name)));
  byId("scenario").replaceChildren(made("option", { value: "" }, "nobody drives"), ...options);
  release();
}

export function showControls(state) {
  own = state.controls === "own";
  if (state.controls === "free" && !hello.real && !asked && performance.now() < RELOADED_MS) {
    asked = true;
    want({ do: "take" });
  }
  paused = state.paused;
  for (const [name] of hello.real ? [] : WORLD) {
    const { input, output, factor, decimals } = sliders[name];
    if (document.activeElement !== input) input.value = state[name] * factor;
    output.textContent = name === "friction" && state[name] === 0 ? "no slip" : fixed(state[name] * factor, decimals);
  }
  for (const button of byId("scenarios").children) {
    button.setAttribute("aria-pressed", String(button.dataset.scenario === (state.scenario ?? "")));
  }
  if (document.activeElement !== byId("scenario")) byId("scenario").value = state.scenario ?? "";
  byId("scenario-text").textContent =
    state.scenario === null ? "the pedals above drive" : `its driver drives: ${hello.scenarios[state.scenario] ?? ""}`;
  byId("pause").firstChild.textContent = paused ? "Go on " : "Pause ";
  byId("take").textContent = own ? "Let go" : "Take the controls";
  byId("take").disabled = !hello.demands || (!own && state.controls !== "free");
  allow(own);
}

export function drives() {
  return own;
}

export function loseControls() {
  own = false;
  release();
  byId("take").disabled = true;
  allow(false);
}

function allow(may) {
  for (const element of document.querySelectorAll("[data-needs]")) element.disabled = !may;
}

const KEYS = {
  w: () => setPedal("accelerator", pedals.accelerator + STEP),
  s: () => setPedal("accelerator", pedals.accelerator - STEP),
  b: () => setPedal("brake", pedals.brake + STEP),
  n: () => setPedal("brake", pedals.brake - STEP),
  " ": release,
  p: pause,
  a: acknowledge,
  d: () => hold(true),
};

function key(event) {
  const typing = event.target.matches("input:not([type=range]):not([type=radio]), select") || document.querySelector("dialog[open]");
  if (typing || event.ctrlKey || event.metaKey || event.altKey) return;
  const pressed = event.key.toLowerCase();
  if (/^[1-9]$/.test(pressed)) choice(Number(pressed) - 1);
  if (pressed === " " && event.target.matches("button")) return;
  if (!own) return;
  KEYS[pressed]?.();
  if (pressed === " ") event.preventDefault();
  for (const [name, , , , step, , [up, down]] of hello.real ? [] : WORLD) {
    const sign = pressed === up.toLowerCase() ? 1 : pressed === down.toLowerCase() ? -1 : 0;
    if (sign !== 0) nudge(name, sign * step);
  }
}

function nudge(name, step) {
  const { input, factor } = sliders[name];
  input.value = Number(input.value) + step;
  want({ do: "change", change: { [name]: Number(input.value) / factor } });
}
