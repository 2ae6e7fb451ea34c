/** The form of a task. */

import type { Task, TimeWindow, Transition, WaitRule } from "../api/types";
import { edit, editFromForm } from "../state/commands";
import { tasksByName } from "../state/plan";
import { mayPlan } from "../state/session";
import { laterTaskOptions, taskLabel } from "../state/task-labels";
import { lookAt } from "../state/view";
import { checkpointsById } from "../state/world";
import { t } from "../texts";
import { html, nothing } from "../ui/element";
import { bound, unitText } from "../ui/figures";
import { icon } from "../ui/icons";
import { chargeFields, NO_CHARGE } from "./charging";
import { aboveNormalCondition, conditionList } from "./conditions";
import {
  checkField,
  checkpointOptions,
  countField,
  optionsOf,
  poseFields,
  selectField,
  speedField,
  textField,
  timeField,
} from "./parts";

/** Saves fields of the task. A function gets the task in its state when the edit is made. */
type Save = (fields: Fields | ((task: Task) => Fields)) => Promise<string | null>;
type Fields = Partial<Omit<Task, "name" | "action" | "transitions" | "source" | "group">>;

export function taskForm(task: Task) {
  const texts = t().forms;
  const set: Save = (fields) =>
    editFromForm(() => [
      {
        kind: "change_task",
        name: task.name,
        ...(typeof fields === "function" ? fields(currentTask(task)) : fields),
      },
    ]);
  const rename = (name: string) =>
    editFromForm(() => [{ kind: "rename_task", name: task.name, new_name: name.trim() }]);
  return html`<div class="title">
      <h2>${taskLabel(task.name)}</h2>
      ${task.object_id || task.pose
        ? html`<button title=${`${texts.show} (v)`} @click=${() => lookAt(task)}>
            ${icon("camera", 16)} ${texts.show}
          </button>`
        : nothing}
    </div>
    ${textField(texts.name, task.name, rename)}
    ${task.action === "MEASURE" ? measuring(task, set) : nothing}
    ${task.action === "WAIT" ? waiting(task.wait ?? null, set) : nothing}
    ${task.action === "WAYPOINT" || task.action === "START"
      ? poseFields(texts.place, task.pose, (change) => set((was) => ({ pose: change(was.pose ?? null) })), null)
      : nothing}
    ${task.action === "START" ? transitionFields(task) : rest(task, set)}`;
}

function rest(task: Task, set: Save) {
  const texts = t().forms;
  const moves = task.action !== "WAIT";
  return html`${moves
      ? speedField(texts.speed, task.velocity, (velocity) => set({ velocity }))
      : nothing}
    ${transitionFields(task)}
    <details ?open=${task.on_failure !== "continue" || task.retries > 0}>
      <summary>${texts.failure}</summary>
      ${countField(texts.retries, task.retries, (retries) => set({ retries: retries ?? 0 }))}
      ${timeField(texts.timeLimit, task.time_limit, (time_limit) => set({ time_limit }))}
      ${task.action === "MEASURE"
        ? timeField(texts.readingLimit, task.reading_limit, (reading_limit) =>
            set({ reading_limit }),
          )
        : nothing}
      ${selectField(texts.onFailure, task.on_failure, optionsOf(texts.failures), (value) => {
        const on_failure = value as Task["on_failure"];
        if (on_failure !== "branch") return set({ on_failure, failure_target: null });
        return set((was) => ({ on_failure, failure_target: was.failure_target ?? possibleFollowers(was)[0]?.value ?? null }));
      })}
      ${task.on_failure === "branch"
        ? selectField(texts.goOnWith, task.failure_target ?? "", possibleFollowers(task), (failure_target) =>
            set({ failure_target }),
          )
        : nothing}
    </details>
    <details ?open=${task.optional || task.window !== null}>
      <summary>${texts.when}</summary>
      ${checkField(texts.optional, task.optional, (optional) => set({ optional }))}
      ${countField(texts.priority, task.priority, (priority) => set({ priority: priority ?? 1 }))}
      ${windowFields(task, set)}
    </details>
    ${task.joint_states
      ? html`<details>
          <summary>${texts.joints}</summary>
          <ul>
            ${task.joint_states.names.map(
              (name, index) => html`<li>${name}: ${task.joint_states?.positions[index] ?? "–"}</li>`,
            )}
          </ul>
        </details>`
      : nothing}`;
}

function measuring(task: Task, set: Save) {
  const texts = t().forms;
  const checkpoint = checkpointsById.value.get(task.object_id ?? "");
  return html`${selectField(texts.checkpoint, task.object_id ?? "", checkpointOptions(), (object_id) =>
      set({ object_id }),
    )}
    ${checkpoint
      ? html`<p class="dim">
            ${t().words.checkpoint[checkpoint.kind]},
            ${texts.nominal(bound(checkpoint.nominal.low), bound(checkpoint.nominal.high), unitText(checkpoint.unit))}
          </p>
          ${checkpoint.problem ? html`<p class="error">${checkpoint.problem}</p>` : nothing}`
      : nothing}
    ${poseFields(texts.standing, task.pose, (change) => set((was) => ({ pose: change(was.pose ?? null) })), texts.anywhere)}`;
}

function waiting(wait: WaitRule | null, set: Save) {
  const texts = t().forms;
  const save = (change: (wait: WaitRule) => Partial<WaitRule>) =>
    set((task) => {
      const was = { conditions: [], ...task.wait };
      return { wait: { ...was, ...change(was) } };
    });
  const timed = wait === null || typeof wait.duration === "number";
  const kind = timed ? "time" : "event";
  return html`${selectField(texts.waitFor, kind, optionsOf(texts.waits), (value) =>
      value === "time"
        ? set({ wait: { duration: 60, conditions: [] } })
        : set({ wait: { event: "all_clear", conditions: [] } }),
    )}
    ${timed
      ? timeField(texts.duration, wait?.duration, (duration) => save(() => ({ duration: duration ?? 0 })))
      : html`${selectField(
            texts.event,
            wait.event ?? "",
            [{ value: "", label: texts.noEvent }, ...optionsOf(t().words.event)],
            (value) => save(() => ({ event: value === "" ? null : (value as WaitRule["event"]), ...NO_CHARGE })),
          )}
          ${wait.event === "battery_charged" ? chargeFields(wait, (change) => save(() => change)) : nothing}
          ${conditionList(wait.conditions, (change) => save((was) => ({ conditions: change(was.conditions) })), texts.orCondition)}
          ${timeField(texts.waitLimit, wait.limit, (limit) => save(() => ({ limit })))}`}`;
}

function windowFields(task: Task, set: Save) {
  const texts = t().forms;
  const window = task.window ?? null;
  const save = (change: Partial<TimeWindow>) =>
    set((task) => {
      const next = { earliest: 0, latest: null, hard: true, ...task.window, ...change };
      return { window: next.earliest === 0 && next.latest === null ? null : next };
    });
  return html`<div class="two">
      ${timeField(texts.earliest, window?.earliest ?? null, (earliest) =>
        save({ earliest: earliest ?? 0 }),
      )}
      ${timeField(texts.latest, window?.latest, (latest) => save({ latest }))}
    </div>
    ${window?.latest
      ? html`${checkField(texts.hard, window.hard, (hard) => save({ hard }))}
        ${selectField(
          texts.missed,
          window.missed_target ?? "",
          [{ value: "", label: texts.likeFailure }, ...possibleFollowers(task)],
          (value) => save({ missed_target: value === "" ? null : value }),
        )}`
      : nothing}`;
}

/** Render the transitions of a task. */
function transitionFields(task: Task) {
  const texts = t().forms;
  const { conditional, onward } = splitTransitions(task);
  const save = (change: (ways: SplitTransitions) => Partial<SplitTransitions>) =>
    editFromForm(() => {
      const was = splitTransitions(currentTask(task));
      const next = { ...was, ...change(was) };
      const transitions = next.onward ? [...next.conditional, next.onward] : next.conditional;
      return [{ kind: "set_transitions", task: task.name, transitions }];
    });
  const saveWay = (index: number, change: (way: Transition) => Transition | null) =>
    save((was) => ({
      conditional: was.conditional.flatMap((way, at) => (at === index ? (change(way) ?? []) : way)),
    }));
  const add = () => {
    const target = possibleFollowers(task)[0]?.value;
    if (target === undefined) return;
    const condition = aboveNormalCondition(task.object_id ?? checkpointOptions()[0]?.value ?? "1");
    const transition = { target, conditions: [condition] };
    void edit({ kind: "add_transition", task: task.name, transition, at: conditional.length });
  };
  const start = task.action === "START";
  return html`<h3>${texts.afterwards}</h3>
    ${start
      ? nothing
      : conditional.map(
          (way, index) =>
            html`<div class="way">
              ${conditionList(
                way.conditions,
                (change) =>
                  saveWay(index, (was) => {
                    const conditions = change(was.conditions);
                    return conditions.length === 0 ? null : { ...was, conditions };
                  }),
                texts.addCondition,
              )}
              ${selectField(texts.then, way.target, possibleFollowers(task), (target) =>
                saveWay(index, (was) => ({ ...was, target })),
              )}
            </div>`,
        )}
    ${selectField(
      conditional.length > 0 ? texts.otherwise : texts.then,
      onward?.target ?? "",
      [{ value: "", label: texts.endsHere }, ...possibleFollowers(task)],
      (target) => save(() => ({ onward: target === "" ? null : { target, conditions: [] } })),
    )}
    ${start
      ? nothing
      : html`<button class="bare" ?disabled=${!mayPlan()} @click=${add}>
          ${icon("add", 16)} ${texts.addWay}
        </button>`}`;
}

interface SplitTransitions {
  readonly conditional: readonly Transition[];
  /** The transition without conditions; null: the mission ends there. */
  readonly onward: Transition | null;
}

function splitTransitions(task: Task): SplitTransitions {
  return {
    conditional: task.transitions.filter((way) => way.conditions.length > 0),
    onward: task.transitions.find((way) => way.conditions.length === 0) ?? null,
  };
}

/** Return the present state of the task. */
function currentTask(task: Task): Task {
  return tasksByName.value.get(task.name) ?? task;
}

/** Return the tasks that may follow. */
function possibleFollowers(task: Task) {
  return laterTaskOptions.value.filter(({ value }) => value !== task.name);
}
