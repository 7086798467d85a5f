// The car from above: each wheel's torques as bars against the limit, and its state in words.
import { byId, drawn, fixed, made, move, words, write } from "./format.js";

const WIDTH = 236;
const HEIGHT = 330;
const ZERO = 50; // of a bar, below its top
const BAR = 160; // its height
const LEAST_NM = 0.5; // of a motor that drives: below it the limit of braking is shown
const SHOWN_FULL = 3; // in torques of the motor, where the brakes can do more

let wheels = [];
let scale = 1; // pixels for 1 N m
let hello = null;
let chosen = 0;
let onChoice = () => {};

export function chosenWheel() {
  return chosen;
}

export function buildCar(told, choose) {
  hello = told;
  onChoice = choose;
  chosen = Math.min(chosen, told.wheels.length - 1);
  scale = (BAR - ZERO) / Math.min(told.brake_nm, SHOWN_FULL * told.drive_nm);
  const picture = drawn("svg", { viewBox: `0 0 ${WIDTH} ${HEIGHT}`, "aria-hidden": "true" });
  picture.append(
    drawn("path", { class: "body", d: "M88 34 Q118 2 148 34 L154 90 L154 250 Q154 316 118 318 Q82 316 82 250 L82 90 Z" }),
    drawn("path", { class: "glass", d: "M92 112 Q118 98 144 112 L138 142 L98 142 Z M98 236 L138 236 L143 262 L93 262 Z" }),
  );
  wheels = told.wheels.map((position, place) => wheel(picture, position, place));
  byId("car").replaceChildren(...wheels.map(({ panel }) => panel), picture);
  choice(chosen);
}

function wheel(picture, position, place) {
  const left = place % 2 === 0;
  const top = place < 2 ? 4 : HEIGHT - BAR - 4;
  const x = left ? 10 : WIDTH - 40;
  const part = (name) => picture.appendChild(drawn("rect", { class: name, x, width: 30, y: top + ZERO, height: 0 }));
  picture.append(
    drawn("rect", { class: "tyre", x: left ? 60 : WIDTH - 80, y: top + BAR / 2 - 28, width: 20, height: 56, rx: 6 }),
    drawn("rect", { class: "track", x, y: top, width: 30, height: BAR, rx: 3 }),
  );
  const parts = { motor: part("motor"), hydraulic: part("hydraulic"), limit: part("limit-mark") };
  picture.append(drawn("line", { class: "zero", x1: x - 4, x2: x + 34, y1: top + ZERO, y2: top + ZERO }));
  const text = {};
  for (const name of ["mode", "speed", "motor", "hydraulic", "side", "limit", "reason", "says"]) text[name] = made("span");
  const panel = made(
    "button",
    { class: `wheel ${position}`, "aria-keyshortcuts": `${place + 1}` },
    made("span", { class: "line" }, made("b", {}, words(position)), text.mode, made("span", { class: "push" }), text.speed),
    made("span", { class: "line motor-text" }, "motor", made("span", { class: "push" }), text.motor),
    made("span", { class: "line hydraulic-text" }, "hydraulic", made("span", { class: "push" }), text.hydraulic),
    made("span", { class: "line limit-text" }, text.side, made("span", { class: "push" }), text.limit),
    made("span", { class: "reason" }, text.reason),
    made("span", { class: "says" }, text.says),
  );
  panel.addEventListener("click", () => choice(place));
  return { panel, parts, text, top };
}

export function choice(place) {
  if (place >= wheels.length) return;
  chosen = place;
  wheels.forEach(({ panel }, other) => panel.setAttribute("aria-pressed", String(other === place)));
  onChoice(place);
}

export function showCar(now) {
  wheels.forEach((one, place) => showWheel(one, (name) => now[`wheel${place}.${name}`]));
}

function showWheel({ parts, text, top }, value) {
  const motor = value("motor_torque_nm");
  const hydraulic = value("hydraulic_torque_nm");
  const speed = value("speed_rad_per_s");
  const against = speed < -0.1 ? -motor : motor; // positive: in the direction of rotation
  const drives = against > LEAST_NM;
  const limit = drives ? value("drive_available_nm") : value("available_nm");
  const long = (torque) => Math.min((Math.abs(torque) || 0) * scale, BAR - ZERO); // not known: nothing
  const zero = top + ZERO;
  const height = drives ? Math.min(long(motor), ZERO) : long(motor);
  move(parts.motor, { y: drives ? zero - height : zero, height });
  const below = drives ? 0 : height;
  move(parts.hydraulic, { y: zero + below, height: Math.min(long(hydraulic), BAR - ZERO - below) });
  const mark = drives ? -Math.min(long(limit), ZERO) : long(limit);
  move(parts.limit, { y: zero + mark - 1.5, height: 3 });
  const reason = value("reason");
  const mode = hello.modes[value("mode")] ?? "silent";
  const fault = value("fault_reason") || value("warning_reason");
  const waits = value("waits_for");
  write(text.mode, mode);
  const kmh = speed * hello.wheel_radius_m * 3.6;
  write(text.speed, `${fixed(kmh, Math.abs(kmh) < 9.95 ? 1 : 0)} km/h`);
  write(text.motor, `${fixed(motor)} N m`);
  write(text.hydraulic, `${fixed(hydraulic)} N m`);
  write(text.limit, `${fixed(limit)} N m`);
  write(text.side, drives ? "driving limit" : "braking limit");
  write(text.reason, hello.reasons[reason]?.[1] ?? "");
  write(text.says, fault ? `${hello.reasons[fault]?.[0] ?? fault}` : waits ? `waits for: ${hello.waits_for[waits]}` : "");
}
