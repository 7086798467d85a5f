// The page: what comes from the vehicle goes to its parts, sixty times a second.
import { byId, fixed, write } from "./format.js";
import { connect, want } from "./link.js";
import { buildCar, chosenWheel, showCar } from "./car.js";
import { buildEnergy, showEnergy } from "./energy.js";
import { buildLimits, showLimits } from "./limits.js";
import { buildControls, greetControls, loseControls, showControls } from "./controls.js";
import { buildFaults, greetFaults, showFaults, showFindings } from "./faults.js";
import { addRows, buildCurves, greetCurves, plotted, showCurves } from "./curves.js";
import { buildParameters, greetParameters, refuseParameters, showParameters } from "./parameters.js";
import { buildRecording, greetRecording, refuseReplay, showRecording, showReplay } from "./recording.js";
import { buildBlackBox, greetBlackBox, noticeFindings, refuseBlackBox, showBlackBox } from "./blackbox.js";
import { armedScope, buildScope, greetScope, refuseScope, showScope, takeFile } from "./scope.js";
import { buildStep, greetStep, refuseStep, showStep } from "./step.js";
import { Samples } from "./samples.js";

const STALE_MS = 500;
const REFUSED_MS = 6000;

const last = { rows: null, time_s: 0, heard_ms: 0, state: null };
const counts = { frames: 0, updates: 0 };

function chooseWheel(wheel) {
  want({ do: "wheel", wheel });
}

const hears = {
  hello(told) {
    document.title = `hubfoc live: ${told.vehicle}`;
    write(byId("vehicle"), told.vehicle);
    buildCar(told, chooseWheel);
    buildEnergy();
    buildLimits(told);
    greetControls(told);
    greetFaults(told);
    greetCurves(told);
    greetParameters(told);
    greetRecording(told);
    greetBlackBox(told);
    greetScope(told);
    greetStep(told);
    last.rows = null;
  },
  state(told) {
    last.state = told;
    last.heard_ms = performance.now();
    write(byId("driver"), driver(told));
    write(byId("factor"), fixed(told.health.realtime_factor, 2));
    showControls(told);
    showLimits(told.limits);
    showFaults(told);
    showFindings(told);
    noticeFindings(told.findings);
    showRecording(told);
  },
  parameters: showParameters,
  replay: showReplay,
  blackbox: showBlackBox,
  armed: armedScope,
  scope: showScope,
  step: showStep,
  file: takeFile,
  rows(told) {
    counts.updates++;
    last.rows = told;
    last.time_s = (told.first + told.count) / 1e3;
    last.heard_ms = performance.now();
    addRows(told);
  },
  refused({ why }) {
    refuseParameters(why);
    refuseReplay(why);
    refuseBlackBox(why);
    refuseScope(why);
    refuseStep();
    write(byId("refused"), why);
    setTimeout(() => write(byId("refused"), ""), REFUSED_MS);
  },
  lost() {
    loseControls();
  },
};

function driver({ controls, scenario }) {
  if (scenario !== null) return "the scenario's driver drives";
  return { own: "you drive", free: "nobody drives", "another page": "another page drives" }[controls] ?? "another program drives";
}

function status(age_ms) {
  if (age_ms > STALE_MS) return `link lost, values are ${fixed(age_ms / 1e3, 0)} s old`;
  if (last.state?.ended) return last.state.ended;
  return last.state?.paused ? "paused" : "running";
}

function frame(now_ms) {
  counts.frames++;
  requestAnimationFrame(frame);
  const age_ms = now_ms - last.heard_ms;
  const stale = last.heard_ms === 0 || age_ms > STALE_MS;
  document.body.className = stale ? "stale" : "";
  write(byId("status"), last.heard_ms === 0 ? "waiting" : status(age_ms));
  if (last.rows === null || stale) return;
  const { now } = last.rows;
  write(byId("time"), fixed(last.time_s, 1));
  write(byId("speed"), fixed(now["vehicle.speed_m_per_s"] * 3.6));
  showCar(now);
  showEnergy(now, last.time_s);
  showCurves(now_ms);
}

buildControls();
buildFaults();
buildCurves();
buildParameters();
buildRecording();
buildBlackBox();
buildScope();
buildStep();
loseControls();
connect(hears);
requestAnimationFrame(frame);
globalThis.hubfoc = { last, counts, plotted, chosenWheel, Samples }; // for tests and the curious
