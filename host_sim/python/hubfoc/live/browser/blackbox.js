// The record of a wheel's first fault: what it says, and curves from before it to after it.
import { byId, made, words, write } from "./format.js";
import { want } from "./link.js";
import { chosenWheel } from "./car.js";
import { clearPanel, drawPanel } from "./panel.js";

const HEIGHT = 170;
const LOG_MOST = 40000; // characters: the latest record in a terminal's log is in its end

let hello = null;
let latest = null; // wheel of the latest fault

export function buildBlackBox() {
  byId("open-blackbox").addEventListener("click", () => {
    byId("blackbox-wheel").value = latest ?? chosenWheel();
    byId("blackbox").showModal();
    if (hello.real) say("choose the log of a terminal in which its shell was asked: blackbox");
    else read();
  });
  byId("blackbox-close").addEventListener("click", () => byId("blackbox").close());
  byId("blackbox-wheel").addEventListener("change", () => {
    if (!hello.real) read();
  });
  byId("blackbox-log").addEventListener("change", async (event) => {
    const [file] = event.target.files;
    if (file === undefined) return;
    ask({ log: (await file.slice(Math.max(file.size - LOG_MOST, 0)).text()).replaceAll("\r", "") });
    event.target.value = "";
  });
}

export function greetBlackBox(told) {
  hello = told;
  latest = null;
  byId("blackbox-wheel").replaceChildren(...hello.wheels.map((name, wheel) => made("option", { value: wheel }, words(name))));
}

export function noticeFindings(findings) {
  latest = findings.find(({ kind }) => kind === "fault")?.wheel ?? null;
}

function read() {
  ask({});
}

function ask(more) {
  say("reading it …");
  want({ do: "blackbox", wheel: Number(byId("blackbox-wheel").value), ...more });
}

function say(text) {
  write(byId("blackbox-words"), text);
  for (const element of byId("blackbox-panels").children) clearPanel(element);
  byId("blackbox-panels").replaceChildren();
}

export function refuseBlackBox(why) {
  if (byId("blackbox").open) write(byId("blackbox-words"), why);
}

export function showBlackBox({ wheel, reason, text, lines, panels }) {
  byId("blackbox-wheel").value = wheel;
  say([...(reason === null ? [] : [`${reason}: ${text}`]), ...lines].join("\n"));
  for (const { title, unit, time_s, curves } of panels) {
    const element = made("div", { class: "panel" });
    byId("blackbox-panels").append(element);
    const drawn = curves.map((curve) => ({ ...curve, unit }));
    drawPanel(element, { title: `${title}, from the fault`, height: HEIGHT, times: time_s, curves: drawn, marksZero: true });
  }
}
