/** Fields that forms consist of: numbers, times, choices, poses. */

import { Refusal, Unreached } from "../api/client";
import type { Pose } from "../api/types";
import { readDuration } from "../state/durations";
import { mayPlan } from "../state/session";
import { world } from "../state/world";
import { t } from "../texts";
import { html } from "../ui/element";
import { figure } from "../ui/figures";
import type { Commit, FormField, Option } from "./field";
import "./field";
import { writeTime } from "./times";

export interface FieldOptions {
  readonly note?: string | undefined;
  readonly placeholder?: string | undefined;
}

const NONE: readonly Option[] = [];
type Given = number | null | undefined;
/** Saves a number, or null for an empty field. Returns the reason of a refusal. */
type TakeNumber = (value: number | null) => ReturnType<Commit>;

function field(
  kind: FormField["kind"],
  label: string,
  value: string,
  commit: Commit,
  { note = "", placeholder = "" }: FieldOptions = {},
  options = NONE,
) {
  return html`<argo-field
    .label=${label}
    kind=${kind}
    .value=${value}
    .note=${note}
    .placeholder=${placeholder}
    .options=${options}
    .commit=${commit}
    ?disabled=${!mayPlan()}
  ></argo-field>`;
}

export function textField(label: string, value: string, commit: Commit, kind: "text" | "long" = "text") {
  return field(kind, label, value, commit);
}

export function checkField(label: string, value: boolean, commit: (value: boolean) => ReturnType<Commit>) {
  return field("check", label, String(value), (text) => commit(text === "true"));
}

export function selectField(
  label: string,
  value: string,
  options: readonly Option[],
  commit: Commit,
) {
  const known = options.some((option) => option.value === value);
  const all = known ? options : [{ value, label: value === "" ? "–" : `${value}?` }, ...options];
  return field("select", label, value, commit, {}, all);
}

/** Render a field for a number; empty means null. */
export function numberField(label: string, value: Given, commit: TakeNumber, options: FieldOptions = {}) {
  const take = (text: string) => {
    if (text.trim() === "") return commit(null);
    const number = Number(text.trim().replace(",", "."));
    return Number.isFinite(number) ? commit(number) : t().forms.noNumber;
  };
  return field("text", label, value === null || value === undefined ? "" : String(value), take, options);
}

/** Render a field for a whole number; empty means null. */
export function countField(label: string, value: Given, commit: TakeNumber, options: FieldOptions = {}) {
  const take: TakeNumber = (number) =>
    number === null || (Number.isInteger(number) && number >= 0) ? commit(number) : t().forms.noCount;
  return numberField(label, value, take, options);
}

/** Render a field for a speed (m/s) up to the robot's highest speed; empty means null. */
export function speedField(label: string, value: Given, commit: TakeNumber) {
  const most = world.value?.robot.speed ?? Infinity;
  const take: TakeNumber = (speed) =>
    speed === null || (speed > 0 && speed <= most) ? commit(speed) : t().forms.tooFast(figure(most));
  return numberField(label, value, take, { note: "m/s", placeholder: Number.isFinite(most) ? String(most) : "" });
}

/** Render a field for a duration (s); empty means null. The service reads it as it reads durations in scripts. */
export function timeField(label: string, value: Given, commit: TakeNumber, options: FieldOptions = {}) {
  const take = async (text: string) => {
    if (text.trim() === "") return commit(null);
    const texts = t().forms;
    let read;
    try {
      read = await readDuration(text);
    } catch (error) {
      if (error instanceof Unreached) return t().frame.notReached;
      if (error instanceof Refusal) return texts.noTime;
      throw error;
    }
    if (read.seconds !== null) return commit(read.seconds);
    if (read.possible.length === 0) return texts.noTime;
    return { text: texts.whichTime(text.trim()), answers: read.possible.map(writeTime) };
  };
  const shown = value === null || value === undefined ? "" : writeTime(value);
  return field("text", label, shown, take, { placeholder: t().forms.likeTime, ...options });
}

/** Return the options of a choice from a table of texts. */
export function optionsOf(words: Readonly<Record<string, string>>): Option[] {
  return Object.entries(words).map(([value, label]) => ({ value, label }));
}

export function checkpointOptions(): Option[] {
  return (world.value?.checkpoints ?? []).map((one) => ({
    value: String(one.id),
    label: `${one.id} ${one.name}`,
  }));
}

/** Returns the new pose from the pose at the time of the edit. */
export type PoseChange = (was: Pose | null) => Pose | null;

/** Render the fields of a pose: a named location, or coordinates. */
export function poseFields(
  label: string,
  pose: Pose | null | undefined,
  commit: (change: PoseChange) => ReturnType<Commit>,
  none: string | null,
) {
  const texts = t().forms;
  const site = world.value;
  const named = [
    ...(site?.docks ?? []).map((dock) => ({ name: texts.dock(dock.area), pose: dock.pose })),
    ...(site?.places ?? []),
  ];
  const at = named.findIndex((one) => pose && same(one.pose, pose));
  const own = pose && at < 0 ? [{ value: "own", label: texts.exactly }] : [];
  const options = [
    ...(none === null ? [] : [{ value: "", label: none }]),
    ...own,
    ...named.map((one, index) => ({ value: String(index), label: one.name })),
  ];
  const choose = (value: string) => {
    if (value === "own") return null;
    const chosen = value === "" ? null : (named[Number(value)]?.pose ?? null);
    return commit(() => chosen);
  };
  const value = !pose ? "" : at < 0 ? "own" : String(at);
  const part = (name: string, key: "x" | "y" | "z", digits: number) =>
    numberField(
      name,
      pose ? round(pose[key], digits) : null,
      (number) => (number === null ? texts.noNumber : commit((was) => was && { ...was, [key]: number })),
      { note: "m" },
    );
  return html`${selectField(label, value, options, choose)}
  ${pose
    ? html`<div class="four">
        ${part("x", "x", 3)} ${part("y", "y", 3)} ${part("z", "z", 3)}
        ${numberField(
          texts.heading,
          round((pose.yaw * 180) / Math.PI, 1),
          (degrees) =>
            degrees === null || Math.abs(degrees) > 360
              ? texts.noHeading
              : commit((was) => was && { ...was, yaw: (degrees * Math.PI) / 180 }),
          { note: "°" },
        )}
      </div>`
    : null}`;
}

function same(a: Pose, b: Pose): boolean {
  const near = (x: number, y: number) => Math.abs(x - y) < 1e-6;
  return near(a.x, b.x) && near(a.y, b.y) && near(a.z, b.z) && near(a.yaw, b.yaw);
}

function round(value: number, digits: number): number {
  return Number(value.toFixed(digits));
}
