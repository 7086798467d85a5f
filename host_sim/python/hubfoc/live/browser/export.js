// Curves as files: a table of text, a picture.
import { made } from "./format.js";
import { colour } from "./panel.js";

const LINE = 18; // of text below a picture

export function save(name, blob) {
  const link = made("a", { href: URL.createObjectURL(blob), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 1000);
}

export function csvOf(names, [times, ...columns], decimals) {
  const lines = [["time_s", ...names].join(",")];
  times.forEach((time, row) => {
    lines.push([time.toFixed(decimals), ...columns.map((column) => Number(column[row].toPrecision(7)))].join(","));
  });
  return `${lines.join("\n")}\n`;
}

export function saveCsv(name, names, columns, decimals = 3) {
  save(name, new Blob([csvOf(names, columns, decimals)], { type: "text/csv" }));
}

export function bytesOf(coded) {
  return Uint8Array.from(atob(coded), (letter) => letter.charCodeAt(0));
}

// What a plot shows, with a line of text for each curve in its colour.
export function savePicture(name, plot, lines) {
  const source = plot.ctx.canvas;
  const line = LINE * devicePixelRatio;
  const canvas = made("canvas", { width: source.width, height: source.height + line * lines.length });
  const context = canvas.getContext("2d");
  context.fillStyle = colour("paper");
  context.fillRect(0, 0, canvas.width, canvas.height);
  context.drawImage(source, 0, 0);
  context.font = `${12 * devicePixelRatio}px system-ui, sans-serif`;
  lines.forEach(({ text, style }, place) => {
    context.fillStyle = colour(style);
    context.fillText(text, 10, source.height + line * (place + 0.7));
  });
  canvas.toBlob((blob) => save(name, blob));
}
