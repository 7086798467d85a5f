// Break something: every fault by name, on and off; and what the controllers say, with times.
import { byId, fixed, made, words, write } from "./format.js";
import { want } from "./link.js";

let hello = null;
let shownFaults = "";
let shownFindings = "";

export function buildFaults() {
  byId("fault").addEventListener("change", describe);
  byId("inject").addEventListener("click", () => {
    const wheel = byId("fault-wheel").value || null;
    want({ do: "change", change: { fault: byId("fault").value, on: true, wheel } });
  });
}

export function greetFaults(told) {
  hello = told;
  shownFaults = shownFindings = "";
  const groups = new Map();
  for (const fault of told.faults) {
    if (!groups.has(fault.group)) groups.set(fault.group, made("optgroup", { label: fault.group }));
    const option = made("option", { value: fault.name }, words(fault.name));
    if (fault.refused !== null) option.disabled = true;
    groups.get(fault.group).append(option);
  }
  const before = byId("fault").value;
  byId("fault").replaceChildren(...groups.values());
  if (before) byId("fault").value = before;
  byId("fault-wheel").replaceChildren(
    made("option", { value: "" }, "all wheels"),
    ...told.wheels.map((position) => made("option", { value: position }, words(position))),
  );
  describe();
}

function describe() {
  const fault = hello.faults.find(({ name }) => name === byId("fault").value);
  if (fault === undefined) return; // real wheels
  write(byId("fault-text"), fault.text);
  for (const option of byId("fault-wheel").options) option.hidden = option.value !== "" && !fault.one_wheel;
  if (!fault.one_wheel) byId("fault-wheel").value = "";
}

export function showFaults(state) {
  const said = JSON.stringify(state.faults);
  if (said === shownFaults) return;
  shownFaults = said;
  const chips = Object.entries(state.faults).map(([name, { wheel, since_s }]) => {
    const chip = made("button", { class: "chip", "data-needs": "controls", title: "mend it" });
    chip.textContent = `${words(name)}${wheel ? `, ${words(wheel)}` : ""}, since ${fixed(since_s, 3)} s ✕`;
    chip.disabled = state.controls !== "own";
    chip.addEventListener("click", () => want({ do: "change", change: { fault: name, on: false } }));
    return chip;
  });
  byId("active").replaceChildren(...(chips.length ? chips : [made("span", { class: "soft" }, "nothing is broken")]));
}

export function showFindings(state) {
  const said = JSON.stringify(state.findings);
  if (said === shownFindings) return;
  shownFindings = said;
  const lines = state.findings.map(finding);
  const none = made("tr", {}, made("td", { class: "soft" }, "nothing yet"));
  byId("finding-lines").replaceChildren(...(lines.length ? lines : [none]));
}

function finding({ wheel, kind, reason, text, from_s, until_s, acknowledged_s, after, delay_s }) {
  const cause = after === null ? "" : `${fixed(1e3 * delay_s, 0)} ms after ${words(after)}`;
  const state = until_s === null ? "present" : `until ${fixed(until_s, 3)} s`;
  const mark = acknowledged_s === null ? "new" : `acknowledged at ${fixed(acknowledged_s, 1)} s`;
  return made(
    "tr",
    { class: `${kind} ${until_s === null ? "present" : "past"}` },
    made("td", {}, `${fixed(from_s, 3)} s`),
    made("td", {}, words(hello.wheels[wheel])),
    made("td", {}, made("b", {}, reason), ` ${text}`, made("small", {}, [cause, state, mark].filter(Boolean).join(" · "))),
  );
}
