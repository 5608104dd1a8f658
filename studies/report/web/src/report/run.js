// The recipe and what made it: enough to make the results again.
import { button, copyText, el } from "../lib/dom.js";
import { count } from "../lib/format.js";

export function whatWasRun(model) {
  const { run } = model.data;
  const copy = button("Copy", () => copyText(run.command, copy), { class: "small" });
  const left = run.planned - run.missions - run.failed;
  const missions = `${count(run.missions)} of ${count(run.planned)} planned${run.failed ? `, ${count(run.failed)} failed in the program` : ""}`;
  const machine = run.machine;
  return el(
    "section",
    { id: "run" },
    el("h2", {}, "What was run"),
    model.data.compared &&
      el("p", { class: "note" }, `Of ${model.data.compared[0]}; manifest.json tells the others.`),
    el(
      "dl",
      {},
      fact("command", run.command && [el("code", {}, run.command), " ", copy]),
      fact("sweep", run.sweep),
      fact("seed", run.seed),
      fact("missions", [missions, left > 0 && el("b", {}, `; ${count(left)} still missing`)]),
      fact(
        "flown time",
        `${run.simulated_h.toFixed(1)} simulated hours in ${run.wall_h.toFixed(2)} core hours`,
      ),
      fact(
        "worlds",
        Object.entries(run.inputs).map(([file, print]) => el("div", {}, file, " ", el("small", {}, print))),
      ),
      fact("code", [
        `commit ${run.commit || "unknown"}, sources `,
        el("code", {}, run.code),
        run.mixed_code && el("b", {}, "; mixed: several versions flew this run"),
      ]),
      fact(
        "machine",
        Object.keys(machine).length > 0 &&
          `${machine.cpu ?? "unknown"}, ${machine.cores ?? "?"} cores, ${machine.memory ?? "?"} memory, SIMD ${machine.simd ?? "unknown"}; ${machine.compiler ?? "unknown compiler"}, ${machine.flags ?? ""}${run.sessions > 1 ? ` (last of ${run.sessions} sessions)` : ""}`,
      ),
      fact(
        "libraries",
        Object.entries(machine)
          .filter(([name]) => name.startsWith("lib "))
          .map(([name, version]) => `${name.slice(4)} ${version}`)
          .join(", "),
      ),
      fact("when", run.begun && `${run.begun} to ${run.ended || "now"}`),
      fact("digest of the results", [
        el("code", {}, run.digest),
        run.unchecked && el("b", {}, `; ${run.unchecked}`),
      ]),
      fact("this page", el("code", {}, run.report_command)),
    ),
  );
}

const fact = (name, value) =>
  value && value.length !== 0 ? [el("dt", {}, name), el("dd", {}, value)] : null;
