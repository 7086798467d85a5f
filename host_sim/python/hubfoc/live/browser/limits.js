// Why not more: the table of torque limits of the chosen wheel, the tightest marked.
import { byId, fixed, made, words, write } from "./format.js";

let lines = {};
let hello = null;

export function buildLimits(told) {
  hello = told;
  lines = {};
  byId("limit-lines").replaceChildren();
}

function line(name) {
  const bar = () => made("i");
  const cell = { braking: made("span"), driving: made("span"), cost: made("td") };
  const bars = { braking: bar(), driving: bar() };
  const row = made(
    "tr",
    { title: hello.limits[name] ?? "" },
    made("th", { scope: "row" }, words(name)),
    made("td", { class: "bar" }, bars.braking, cell.braking),
    made("td", { class: "bar" }, bars.driving, cell.driving),
    cell.cost,
  );
  byId("limit-lines").append(row);
  return { row, bars, cell };
}

export function showLimits(limits) {
  write(byId("limits-of"), words(hello.wheels[limits.wheel] ?? ""));
  for (const limit of limits.lines) {
    const { row, bars, cell } = (lines[limit.name] ??= line(limit.name));
    show(bars.braking, cell.braking, limit.braking_nm, limit.tightest_braking);
    show(bars.driving, cell.driving, limit.driving_nm, limit.tightest_driving);
    write(cell.cost, fixed((limits.cost_j[limit.name] ?? 0) / 1e3, 2));
    row.className = limit.tightest_braking || limit.tightest_driving ? "tightest" : "";
  }
  const tightest = limits.lines.find((limit) => limit.tightest_braking);
  const note = limits.in_use
    ? "somebody types in this wheel's shell: not asked for half a minute"
    : tightest === undefined
      ? "asking the wheel's shell"
      : `braking: ${tightest.text || hello.limits[tightest.name]}`;
  write(byId("limits-note"), note);
}

function show(bar, text, bound, tightest) {
  const share = bound === null ? 1 : Math.min(bound / hello.drive_nm, 1);
  bar.style.width = `calc(${share} * (100% - 10px))`;
  bar.className = bound === null ? "none" : tightest ? "mark" : "";
  write(text, bound === null ? "–" : `${fixed(bound)}${tightest ? " ◄" : ""}`);
}
