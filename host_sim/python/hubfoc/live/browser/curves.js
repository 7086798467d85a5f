// Curves of any signals: two axes, cursor, zoom, hold, export.
/* global uPlot */
import { byId, fixed, made, write } from "./format.js";
import { want } from "./link.js";
import { STYLES, colour } from "./panel.js";
import { saveCsv, savePicture } from "./export.js";
import { Samples } from "./samples.js";

const FIRST = ["wheel0.motor_torque_nm", "wheel0.hydraulic_torque_nm", "wheel0.available_nm", "vehicle.speed_m_per_s"];
const DASHES = [[], [6, 3], [2, 3]];
const HEIGHT = 160;
const MOST_CURVES = 24;
const EVERY_MS = 25; // many curves are drawn in every second frame at 60 Hz
const FEW = 8; // curves that are drawn thicker, and in every frame

export const plotted = { row: 0 }; // the last row whose place is drawn

const samples = new Samples();
let chosen = []; // { name, right }
let plot = null;
let held = null; // the zoomed or held window, rows
let hello = null;
let shown_ms = 0;

export function buildCurves() {
  byId("add").addEventListener("click", add);
  byId("signal").addEventListener("keydown", (event) => {
    if (event.key === "Enter") add();
  });
  byId("hold").addEventListener("click", hold);
  byId("span").addEventListener("change", () => {
    held = null;
    showHold();
  });
  byId("csv").addEventListener("click", exportCsv);
  for (const format of ["parquet", "mcap"]) byId(format).addEventListener("click", () => exportFile(format));
  byId("picture").addEventListener("click", exportPicture);
  addEventListener("keydown", (event) => {
    if (event.key.toLowerCase() === "h" && !event.target.matches("input, select")) hold();
  });
  addEventListener("resize", () => build());
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => build());
}

export function greetCurves(told) {
  hello = told;
  byId("signals").replaceChildren(
    ...Object.entries(told.signals).map(([name, [unit, text]]) => made("option", { value: name }, `${unit} ${text}`)),
  );
  if (chosen.length === 0) chosen = FIRST.map((name) => ({ name, right: name.startsWith("vehicle") }));
  chosen = chosen.filter(({ name }) => name in told.signals);
  ask();
}

function ask() {
  const names = chosen.map(({ name }) => name);
  samples.choose(names);
  want({ do: "curves", names });
  build();
}

function add() {
  const name = byId("signal").value.trim();
  if (!(name in (hello?.signals ?? {})) || chosen.some((one) => one.name === name) || chosen.length >= MOST_CURVES) return;
  const unit = hello.signals[name][0];
  const left = chosen.filter((one) => !one.right);
  chosen.push({ name, right: left.length > 0 && hello.signals[left[0].name][0] !== unit });
  byId("signal").value = "";
  ask();
}

export function addRows({ first, count, curves, samples: values }) {
  if (curves === chosen.length) samples.add(first, count, values);
}

function span() {
  return 1e3 * Number(byId("span").value);
}

// First and last row that are shown: of the rows that are there, or of the first span.
function shown() {
  return held ?? [Math.max(samples.end - span(), 0), Math.max(samples.end, span()) - 1];
}

function hold() {
  held = held === null ? shown() : null;
  showHold();
}

function showHold() {
  byId("hold").setAttribute("aria-pressed", String(held !== null));
}

function build() {
  plot?.destroy();
  const soft = colour("soft");
  const axis = (scale, side) => ({
    scale, side, stroke: soft, size: 56, font: "12px system-ui, sans-serif",
    grid: { show: side === 3, stroke: colour("rule"), width: 1 }, ticks: { show: false },
    values: (_, ticks) => ticks.map((tick) => fixed(tick, Number.isInteger(tick) ? 0 : Math.abs(tick) < 1 ? 2 : 1)),
  }); // prettier-ignore
  const options = {
    width: Math.max(byId("plot").clientWidth, 200), height: HEIGHT,
    legend: { show: false }, pxAlign: false,
    cursor: { drag: { x: true, y: false, setScale: false }, points: { show: false } },
    scales: { x: { time: false }, left: { range: roomy }, right: { range: roomy } },
    axes: [
      { stroke: soft, font: "12px system-ui, sans-serif", size: 26, grid: { stroke: colour("rule"), width: 1 }, ticks: { show: false },
        values: (_, ticks) => ticks.map((tick) => `${Number(tick.toFixed(3))} s`) },
      axis("left", 3), axis("right", 1),
    ],
    series: [{}, ...chosen.map(({ right }, place) => ({
      scale: right ? "right" : "left", width: chosen.length > FEW ? 1 : 1.75, points: { show: false }, spanGaps: true,
      stroke: colour(STYLES[place % STYLES.length]), dash: DASHES[Math.floor(place / STYLES.length)],
    }))],
    hooks: { setSelect: [zoom], setCursor: [showValues], ready: [(own) => own.over.addEventListener("dblclick", unzoom)] },
  }; // prettier-ignore
  plot = new uPlot(options, samples.window(0, -1, 1), byId("plot"));
  buildLegend();
}

function roomy(_, low, high) {
  if (low === null || !Number.isFinite(low)) return [0, 1];
  const least = Math.min(low, 0);
  const most = Math.max(high, 0);
  const edge = 0.06 * (most - least || 1);
  return [least - (least < 0 ? edge : 0), most + edge];
}

function zoom(own) {
  if (own.select.width < 4) return;
  const rows = [own.posToVal(own.select.left, "x"), own.posToVal(own.select.left + own.select.width, "x")];
  held = rows.map((time_s) => 1e3 * time_s);
  own.setSelect({ left: 0, width: 0, top: 0, height: 0 }, false);
  showHold();
}

function unzoom() {
  held = null;
  showHold();
}

function buildLegend() {
  const items = chosen.map((one, place) => {
    const side = made("button", { title: "left or right axis", "aria-label": `axis of ${one.name}` }, one.right ? "right" : "left");
    side.addEventListener("click", () => {
      one.right = !one.right;
      build();
    });
    const away = made("button", { title: "take away", "aria-label": `take away ${one.name}` }, "✕");
    away.addEventListener("click", () => {
      chosen = chosen.filter((other) => other !== one);
      ask();
    });
    const mark = made("i");
    mark.style.background = `var(--${STYLES[place % STYLES.length]})`;
    const [unit, text] = hello.signals[one.name];
    one.output = made("output");
    return made("li", { title: text }, mark, `${one.name} `, one.output, ` ${unit.replace(".", " ")}`, side, away);
  });
  byId("legend").replaceChildren(...items);
}

function showValues() {
  const at = plot?.cursor.left >= 0 ? plot.posToVal(plot.cursor.left, "x") : samples.end / 1e3;
  for (const { name, output } of chosen) if (output) write(output, fixed(samples.value(name, at), 2));
}

export function showCurves(now_ms) {
  if (plot === null || (chosen.length > FEW && now_ms - shown_ms < EVERY_MS)) return;
  shown_ms = now_ms;
  const [from, to] = shown();
  const data = samples.window(from, to, plot.width);
  plot.batch(() => {
    plot.setData(data, false);
    plot.setScale("x", { min: from / 1e3, max: to / 1e3 });
  });
  plotted.row = Math.round(1e3 * (data[0][data[0].length - 1] ?? 0));
  showValues();
}

function exportCsv() {
  const [from, to] = shown();
  const names = chosen.map(({ name }) => name);
  saveCsv("hubfoc.csv", names, samples.window(from, to, Infinity));
}

function exportFile(format) {
  const [from, to] = shown();
  const rows = { from: Math.ceil(from), to: Math.floor(to) + 1 };
  want({ do: "export", of: "curves", format, names: chosen.map(({ name }) => name), ...rows });
}

function exportPicture() {
  const lines = chosen.map(({ name, right }, place) => ({
    text: `${name}, ${hello.signals[name][0]}, ${right ? "right" : "left"}`,
    style: STYLES[place % STYLES.length],
  }));
  savePicture("hubfoc.png", plot, lines);
}
