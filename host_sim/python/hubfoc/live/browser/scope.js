// The scope: any eight signals of a wheel at the PWM frequency.
import { byId, made, words, write } from "./format.js";
import { want } from "./link.js";
import { chosenWheel } from "./car.js";
import { STYLES, drawPanel, unitOf } from "./panel.js";
import { bytesOf, save, saveCsv, savePicture } from "./export.js";

const HEIGHT = 320;
const MOST = 8;
const FIRST = ["fast_input.phase_current_code_a", "fast_input.phase_current_code_b", "fast_input.bus_voltage_code"];
const ON_SIGNAL = ["above", "below", "rises", "falls"];

let hello = null;
let chosen = [];
let told = null; // the latest recording
let plot = null;
let waits = false;

export function buildScope() {
  byId("open-scope").addEventListener("click", () => {
    byId("scope-wheel").value = chosenWheel();
    byId("scope").showModal();
    draw();
  });
  byId("scope-close").addEventListener("click", () => byId("scope").close());
  byId("scope-add").addEventListener("click", add);
  byId("scope-signal").addEventListener("keydown", (event) => {
    if (event.key === "Enter") add();
  });
  byId("scope-trigger").addEventListener("change", showTrigger);
  byId("scope-run").addEventListener("click", run);
  byId("scope-csv").addEventListener("click", () => {
    const columns = [told.time_s, ...told.curves.map(({ values }) => values)];
    saveCsv("hubfoc-scope.csv", namesOf(), columns, 7);
  });
  for (const format of ["parquet", "mcap"]) {
    byId(`scope-${format}`).addEventListener("click", () => want({ do: "export", of: "scope", format }));
  }
  byId("scope-picture").addEventListener("click", () => {
    const lines = told.curves.map(({ name, unit }, place) => ({ text: `${name}, ${unit}`, style: styleOf(place) }));
    savePicture("hubfoc-scope.png", plot, lines);
  });
  allowExport();
}

export function greetScope(now) {
  hello = now;
  byId("scope-wheel").replaceChildren(...hello.wheels.map((name, wheel) => made("option", { value: wheel }, words(name))));
  byId("scope-signals").replaceChildren(
    ...Object.entries(hello.scope).map(([name, [unit, text]]) => made("option", { value: name }, `${unit} ${text}`)),
  );
  byId("scope-trigger").replaceChildren(...hello.triggers.map((name) => made("option", { value: name }, name)));
  if (chosen.length === 0) chosen = FIRST.filter((name) => name in hello.scope);
  showChosen();
  showTrigger();
}

function namesOf() {
  return told.curves.map(({ name }) => name);
}

function styleOf(place) {
  return STYLES[place % STYLES.length];
}

function add() {
  const name = byId("scope-signal").value.trim();
  if (!(name in hello.scope) || chosen.includes(name) || chosen.length >= MOST) return;
  chosen.push(name);
  byId("scope-signal").value = "";
  showChosen();
}

function showChosen() {
  const chips = chosen.map((name) => {
    const chip = made("button", { title: `take away: ${hello.scope[name][1]}` }, `${name} ✕`);
    chip.addEventListener("click", () => {
      chosen = chosen.filter((other) => other !== name);
      showChosen();
    });
    return chip;
  });
  byId("scope-chosen").replaceChildren(...chips);
  byId("scope-run").disabled = waits || chosen.length === 0;
}

function showTrigger() {
  const trigger = byId("scope-trigger").value;
  byId("scope-on").disabled = !ON_SIGNAL.includes(trigger);
  byId("scope-level").disabled = trigger === "none";
}

function run() {
  begin("setting the scope …");
  want({
    do: "scope",
    wheel: Number(byId("scope-wheel").value),
    signals: chosen,
    trigger: byId("scope-trigger").value,
    on: byId("scope-on").value.trim(),
    level: byId("scope-level").value.trim(),
    before: Number(byId("scope-before").value) / 100,
    every: Number(byId("scope-every").value),
  });
}

function begin(text) {
  waits = true;
  byId("scope-run").disabled = true;
  write(byId("scope-words"), text);
}

export function refuseScope(why) {
  if (!byId("scope").open) return;
  waits = false;
  showChosen();
  write(byId("scope-words"), why);
}

export function showScope(now) {
  waits = false;
  told = now;
  showChosen();
  byId("scope-wheel").value = told.wheel;
  write(byId("scope-words"), told.words);
  allowExport();
  draw();
}

function allowExport() {
  for (const id of ["scope-csv", "scope-parquet", "scope-mcap", "scope-picture"]) byId(id).disabled = told === null;
}

function draw() {
  if (told === null || !byId("scope").open) return;
  const unit = told.curves[0].unit;
  const curves = told.curves.map((curve, place) => ({
    ...curve,
    style: styleOf(place),
    right: curve.unit !== unit,
  }));
  const title = `from the trigger, left in ${unitOf(unit) || "numbers"}`;
  plot = drawPanel(byId("scope-plot"), { title, height: HEIGHT, times: told.time_s, curves, marksZero: true });
}

export function armedScope() {
  if (waits) write(byId("scope-words"), "waiting for the trigger, at most 30 s …");
}

export function takeFile({ name, content }) {
  save(name, new Blob([bytesOf(content)], { type: "application/octet-stream" }));
}
