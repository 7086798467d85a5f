// Where the energy goes: a band between battery and wheels, from which the losses branch off.
import { byId, drawn, energy, made, move, power, write } from "./format.js";

const WIDTH = 500; // of the picture, which is stretched; a branch in the middle of each fifth
const HEIGHT = 84;
const AXIS = 24;
const MOST = 40; // of the widest band
const LEAST_FULL_W = 200; // what fills it is the largest flow of the last seconds, at least this
const SETTLE_S = 0.15;
const FORGET_S = 5;
const BRANCHES = [
  ["battery heat", ["energy.battery_j"], "loss"],
  ["inverter", ["energy.conduction_j", "energy.diode_j", "energy.switching_j"], "loss"],
  ["copper", ["energy.copper_j"], "loss"],
  ["iron", ["energy.iron_j", "energy.bearing_j"], "loss"],
  ["hydraulic", ["energy.hydraulic_j"], "hydraulic"],
];

let parts = null;
let before = null;
let smooth = {};
let full_w = LEAST_FULL_W;

export function buildEnergy() {
  before = null;
  smooth = {};
  const svg = drawn("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, preserveAspectRatio: "none", "aria-hidden": "true" });
  const band = svg.appendChild(drawn("path", { class: "band" }));
  const arrow = svg.appendChild(drawn("path", { class: "arrow" }));
  const text = { battery: made("span"), wheels: made("span") };
  const ends = made("div", { class: "line" }, made("b", {}, "battery"), text.battery, made("span", { class: "push" }), text.wheels, made("b", {}, "wheels"));
  const labels = made("div", { class: "branches" });
  const branches = BRANCHES.map(([name, , style]) => {
    const path = svg.appendChild(drawn("path", { class: `branch ${style}` }));
    const label = { now: made("b"), since: made("span") };
    labels.append(made("div", {}, made("span", {}, name), label.now, label.since));
    return { path, ...label };
  });
  parts = { band, arrow, branches, text };
  byId("flow").replaceChildren(ends, svg, labels);
}

export function showEnergy(now, time_s) {
  const joules = { battery: now["battery.drawn_j"] - now["battery.returned_j"], shaft: now["energy.shaft_j"] };
  BRANCHES.forEach(([name, sources]) => {
    joules[name] = sources.reduce((sum, source) => sum + (now[source] ?? 0), 0);
  });
  if (before !== null && time_s > before.time_s) settle(joules, time_s - before.time_s);
  if (before === null || time_s !== before.time_s) before = { joules, time_s };
  const shaft = smooth.shaft ?? 0;
  const battery = smooth.battery ?? 0;
  const wide = (watts) => Math.min(Math.abs(watts) / full_w, 1) * MOST;
  showBand(shaft, battery, wide);
  BRANCHES.forEach(([name, sources], place) => {
    const { path, now: text, since } = parts.branches[place];
    const x = ((place + 0.5) / BRANCHES.length) * WIDTH;
    const half = wide(smooth[name] ?? 0) / 2;
    const start = name === "hydraulic" ? AXIS + MOST / 2 + 2 : AXIS;
    move(path, { d: `M${x - half} ${start} H${x + half} V${HEIGHT - 8} L${x} ${HEIGHT} L${x - half} ${HEIGHT - 8} Z` });
    const known = sources.some((source) => source in now);
    write(text, known ? power(smooth[name] ?? 0) : "–");
    write(since, known ? energy(joules[name]) : "");
  });
  write(parts.text.battery, `${battery < 0 ? "gets" : "gives"} ${power(Math.abs(battery))} · drawn ${energy(now["battery.drawn_j"])}, returned ${energy(now["battery.returned_j"])}`);
  write(parts.text.wheels, `${power(Math.abs(shaft))} ${shaft < 0 ? "from the" : "to the"}`);
}

// Between battery and wheels the band grows or shrinks by the losses.
function showBand(shaft, battery, wide) {
  const [left, right] = [Math.max(wide(battery), 1) / 2, Math.max(wide(shaft), 1) / 2];
  move(parts.band, {
    d: `M0 ${AXIS - left} L${WIDTH} ${AXIS - right} V${AXIS + right} L0 ${AXIS + left} Z`,
    class: shaft < 0 ? "band returns" : "band",
  });
  const [point, back] = shaft < 0 ? [4, 16] : [WIDTH - 4, WIDTH - 16];
  move(parts.arrow, { d: `M${point} ${AXIS} L${back} ${AXIS - 12} V${AXIS + 12} Z` });
  parts.arrow.style.visibility = Math.abs(shaft) < 5 ? "hidden" : "visible";
}

function settle(joules, elapsed_s) {
  const share = 1 - Math.exp(-elapsed_s / SETTLE_S);
  let most_w = LEAST_FULL_W;
  for (const [name, value] of Object.entries(joules)) {
    const watts = (value - before.joules[name]) / elapsed_s;
    smooth[name] = (smooth[name] ?? 0) + share * (watts - (smooth[name] ?? 0));
    most_w = Math.max(most_w, Math.abs(smooth[name]));
  }
  full_w = Math.max(most_w, full_w + (most_w - full_w) * (1 - Math.exp(-elapsed_s / FORGET_S)));
}
