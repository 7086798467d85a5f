// Curves that stand still, of a record, a replay, the scope: one plot with its legend, a cursor, zoom.
/* global uPlot */
import { fixed, made, write } from "./format.js";

const FONT = "12px system-ui, sans-serif";
const SHORT_S = 0.5; // shorter than that is in ms
const drawnPanels = new Map(); // by element

export const STYLES = ["motor", "hydraulic", "limit", "battery", "ratio", "travel", "loss-text", "ink"];

export function colour(name) {
  return getComputedStyle(document.documentElement).getPropertyValue(`--${name}`).trim();
}

export function unitOf(text) {
  return text === "1" ? "" : text.replace(".", " ").replace("deg", "°");
}

// `curves`: name, unit, values, and where wanted style, width, dash, right. Times in s.
export function drawPanel(element, panel) {
  clearPanel(element);
  const plot = made("div", { class: "plot", role: "img", "aria-label": panel.title });
  const legend = made("ul", { class: "legend" });
  element.replaceChildren(...(panel.shows === false ? [] : [made("h3", {}, panel.title)]), legend, plot);
  const own = { panel, plot: new uPlot(optionsOf(panel, plot), dataOf(panel), plot), outputs: [] };
  legend.append(...panel.curves.map((curve, place) => entry(curve, place, own)));
  drawnPanels.set(element, own);
  return own.plot;
}

export function clearPanel(element) {
  drawnPanels.get(element)?.plot.destroy();
  drawnPanels.delete(element);
  element.replaceChildren();
}

function again() {
  for (const [element, { panel }] of [...drawnPanels]) drawPanel(element, panel);
}

addEventListener("resize", again);
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", again);

function isShort({ times }) {
  return times.length > 0 && times[times.length - 1] - times[0] < SHORT_S;
}

function dataOf(panel) {
  const scale = isShort(panel) ? 1e3 : 1;
  return [Float64Array.from(panel.times, (time) => time * scale), ...panel.curves.map(({ values }) => values)];
}

function styleOf(curve, place) {
  return curve.style ?? STYLES[place % STYLES.length];
}

function entry(curve, place, own) {
  const mark = made("i");
  mark.style.background = `var(--${styleOf(curve, place)})`;
  const output = made("output");
  own.outputs.push(output);
  const side = curve.right ? " (right)" : "";
  return made("li", { title: curve.text ?? "" }, mark, `${curve.name} `, output, ` ${unitOf(curve.unit)}${side}`);
}

function showValues(element) {
  const own = drawnPanels.get(element);
  if (own === undefined) return;
  const row = own.plot.cursor.idx;
  own.panel.curves.forEach(({ values }, place) => {
    write(own.outputs[place], row === null || row === undefined ? "" : fixed(values[row], 2));
  });
}

function lineAtZero(own) {
  const { left, top, width, height } = own.bbox;
  const at = own.valToPos(0, "x", true);
  if (at < left || at > left + width) return;
  own.ctx.save();
  own.ctx.strokeStyle = colour("soft");
  own.ctx.setLineDash([4, 3]);
  own.ctx.beginPath();
  own.ctx.moveTo(at, top);
  own.ctx.lineTo(at, top + height);
  own.ctx.stroke();
  own.ctx.restore();
}

// With zero where it is near; a constant in the middle.
function rangeOf(_, low, high) {
  if (low === null || !Number.isFinite(low)) return [0, 1];
  const least = low > 0 && low < 0.5 * high ? 0 : low;
  const most = high < 0 && high > 0.5 * low ? 0 : high;
  const edge = Math.max(0.06 * (most - least), 0.02 * Math.max(Math.abs(low), Math.abs(high)), 1e-3);
  return [least - (least === 0 && high > 0 ? 0 : edge), most + (most === 0 && low < 0 ? 0 : edge)];
}

function optionsOf(panel, plot) {
  const soft = colour("soft");
  const grid = { stroke: colour("rule"), width: 1 };
  const common = { stroke: soft, font: FONT, ticks: { show: false } };
  const decimals = (tick) => (Number.isInteger(tick) ? 0 : Math.abs(tick) < 1 ? 2 : 1);
  const axis = (scale, side) => ({
    ...common, scale, side, size: 56, grid: { ...grid, show: side === 3 },
    values: (_, ticks) => ticks.map((tick) => fixed(tick, decimals(tick))),
  }); // prettier-ignore
  const time = isShort(panel) ? "ms" : "s";
  const times = (_, ticks) => ticks.map((tick) => `${Number(tick.toFixed(3))} ${time}`.replace("-", "\u2212"));
  const hasRight = panel.curves.some(({ right }) => right);
  return {
    width: Math.max(plot.clientWidth, 200), height: panel.height,
    legend: { show: false }, pxAlign: false,
    cursor: { drag: { x: true, y: false }, points: { show: false } },
    scales: { x: { time: false }, left: { range: rangeOf }, right: { range: rangeOf } },
    axes: [{ ...common, size: 26, grid, values: times }, axis("left", 3), ...(hasRight ? [axis("right", 1)] : [])],
    series: [{}, ...panel.curves.map((curve, place) => ({
      scale: curve.right ? "right" : "left", stroke: colour(styleOf(curve, place)), width: curve.width ?? 1.5,
      dash: curve.dash ?? [], points: { show: false },
    }))],
    hooks: {
      draw: panel.marksZero ? [lineAtZero] : [],
      setCursor: [(own) => showValues(own.root.parentElement.parentElement)],
    },
  }; // prettier-ignore
}
