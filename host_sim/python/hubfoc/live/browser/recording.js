// Record, and run it again: both drawn over one another, with what the second one is.
import { byId, fixed, made, words, write } from "./format.js";
import { want } from "./link.js";
import { chosenWheel } from "./car.js";
import { drawPanel } from "./panel.js";
import { editedValues } from "./parameters.js";

const HEIGHT = 300;
const FIRST = "motor_torque_command_nm";

let hello = null;
let told = null; // the latest replay

export function buildRecording() {
  byId("record").addEventListener("click", () => {
    want({ do: "change", change: { record: byId("record").getAttribute("aria-pressed") === "true" ? null : true } });
  });
  byId("open-replay").addEventListener("click", open);
  byId("replay-close").addEventListener("click", () => byId("replay").close());
  byId("replay-run").addEventListener("click", run);
  byId("replay-file").addEventListener("click", () => made("a", { href: "recording", download: "" }).click());
  byId("replay-wheel").addEventListener("change", () => {
    if (told !== null) run();
  });
  byId("replay-signal").addEventListener("change", () => {
    if (told !== null) want({ do: "replayed", signal: byId("replay-signal").value });
  });
}

export function greetRecording(now) {
  hello = now;
  byId("replay-wheel").replaceChildren(...hello.wheels.map((name, wheel) => made("option", { value: wheel }, words(name))));
  byId("replay-signal").replaceChildren(...Object.keys(hello.commands).map((name) => made("option", { value: name }, name)));
  byId("replay-signal").value = FIRST;
}

export function showRecording({ recording_s, recorded }) {
  for (const id of ["record", "open-replay", "open-parameters"]) byId(id).hidden = recorded === undefined; // real wheels
  const records = (recording_s ?? null) !== null;
  byId("record").setAttribute("aria-pressed", String(records));
  write(byId("record"), records ? `Stop, ${fixed(recording_s, 0)} s` : "Record");
  byId("open-replay").disabled = recorded === null || records;
}

function open() {
  byId("replay-wheel").value = chosenWheel();
  const edited = Object.keys(editedValues()).length;
  write(byId("replay-edited-text"), `with what is edited under Parameters (${edited})`);
  byId("replay-edited").disabled = edited === 0;
  byId("replay-edited").checked = edited > 0;
  byId("replay").showModal();
  run();
}

function run() {
  const simulate = byId("replay-simulate").checked;
  const values = byId("replay-edited").checked ? editedValues() : {};
  write(byId("replay-words"), simulate ? "simulating the vehicle again …" : "running its steps again …");
  byId("replay-run").disabled = true;
  want({ do: "replay", wheel: Number(byId("replay-wheel").value), signal: byId("replay-signal").value, simulate, values });
}

export function refuseReplay(why) {
  byId("replay-run").disabled = false;
  if (byId("replay").open) write(byId("replay-words"), why);
}

export function showReplay(now) {
  told = now;
  byId("replay-run").disabled = false;
  write(byId("replay-words"), now.words);
  draw();
}

function label() {
  if (told.equal) return told.simulated ? "simulated again, equal" : "replayed, equal";
  return told.simulated ? "simulated again" : "replayed, open loop: commanded for these sensor values";
}

function draw() {
  if (!byId("replay").open) return;
  const [unit, text] = hello.commands[told.signal];
  drawPanel(byId("replay-plot"), {
    title: text,
    height: HEIGHT,
    times: told.time_s,
    curves: [
      { name: "recorded", unit, values: told.recorded, style: "soft", width: 3.5 },
      { name: label(), unit, values: told.replayed, style: "motor", width: 1.25 },
    ],
  });
}
