// The step test of the current loop: measured and designed response.
import { byId, fixed, made, words, write } from "./format.js";
import { want } from "./link.js";
import { chosenWheel } from "./car.js";
import { release } from "./controls.js";
import { drawPanel } from "./panel.js";
import { saveCsv, savePicture } from "./export.js";

const CURRENTS_HEIGHT = 300;
const VOLTAGES_HEIGHT = 160;
const LOOKS = {
  "fast_view.i_q_pu": { style: "motor", width: 2 },
  "designed.i_q": { style: "hydraulic", width: 2, dash: [6, 3] },
  "fast_view.i_q_reference_pu": { style: "ink", width: 1 },
  "fast_view.i_d_pu": { style: "battery", width: 2 },
  "designed.i_d": { style: "limit", width: 2, dash: [6, 3] },
  "fast_view.i_d_reference_pu": { style: "soft", width: 1, dash: [2, 3] },
  "fast_view.u_d_pu": { style: "battery" },
  "fast_view.u_q_pu": { style: "motor" },
};

let hello = null;
let told = null;
let plot = null;
let waits = false;

export function buildStep() {
  byId("open-step").addEventListener("click", begin);
  byId("step-close").addEventListener("click", () => byId("step").close());
  byId("step-csv").addEventListener("click", () => {
    const names = told.curves.map(({ name }) => name);
    saveCsv("hubfoc-step.csv", names, [told.time_s, ...told.curves.map(({ values }) => values)], 7);
  });
  byId("step-picture").addEventListener("click", () => {
    const lines = curvesOf("A").map(({ name, unit, style }) => ({ text: `${name}, ${unit}`, style }));
    savePicture("hubfoc-step.png", plot, lines);
  });
}

export function greetStep(now) {
  hello = now;
  waits = false;
}

function begin() {
  if (waits) return;
  waits = true;
  want({ do: "step", wheel: chosenWheel() });
}

export function refuseStep() {
  if (waits) release();
  waits = false;
}

export function showStep(now) {
  waits = false;
  told = now;
  release();
  byId("step").showModal();
  const [from, to] = told.step_a;
  write(byId("step-of"), `${words(hello.wheels[told.wheel])}, i_q from ${fixed(from)} A to ${fixed(to)} A`);
  const row = (text, ...values) => made("tr", {}, made("th", { scope: "row" }, text), ...values.map((value) => made("td", {}, value)));
  const both = [told.measured, told.designed];
  byId("step-lines").replaceChildren(
    row("rise time, 10 to 90 %", ...both.map(({ rise_ms }) => `${fixed(rise_ms, 3)} ms`)),
    row("overshoot", ...both.map(({ overshoot }) => `${fixed(100 * overshoot)} %`)),
  );
  const limited = told.limited ? " The voltage reached its limit, which makes the current slower." : "";
  const worst = `${fixed(told.worst_a, 2)} A, ${fixed(100 * told.worst)} % of the step`;
  write(byId("step-words"), `Largest difference ${worst}; a code of the converter is ${fixed(told.code_a, 2)} A.${limited}`);
  const time = { times: told.time_s, marksZero: true };
  const currents = { ...time, title: "Currents, A", height: CURRENTS_HEIGHT, curves: curvesOf("A") };
  plot = drawPanel(byId("step-currents"), currents);
  const voltages = { ...time, title: "Voltages, shares of the voltage circle", height: VOLTAGES_HEIGHT, curves: curvesOf("1") };
  drawPanel(byId("step-voltages"), voltages);
}

function curvesOf(wanted) {
  return told.curves.filter(({ unit }) => unit === wanted).map((curve) => ({ ...curve, ...LOOKS[curve.name] }));
}
