/** The form of the mission's header. */

import type { Mission } from "../api/types";
import { editFromForm } from "../state/commands";
import { showNotice } from "../state/notices";
import { tasksAfterStart, mission as open } from "../state/plan";
import { mayPlan } from "../state/session";
import { taskLabel } from "../state/task-labels";
import { world } from "../state/world";
import { t } from "../texts";
import { options } from "../ui/controls";
import { html, nothing } from "../ui/element";
import { optionsOf, poseFields, selectField, textField, timeField } from "./parts";

type Fields = Partial<Omit<Mission, "version" | "tasks" | "groups" | "reactions">>;

/** Change fields of the mission. `change` gets its state when the edit is made. */
function setOf(change: (now: Mission) => Fields): Promise<string | null> {
  return editFromForm(() => (open.value === null ? [] : [{ kind: "set_header", ...change(open.value) }]));
}

export function headerForm(mission: Mission) {
  const texts = t().forms;
  const set = (fields: Fields) => setOf(() => fields);
  const areas = (world.value?.docks ?? []).map((dock) => ({
    value: String(dock.area),
    label: texts.area(dock.area),
  }));
  const area = (value: string) => (value === "" ? null : Number(value));
  const unsaid = [{ value: "", label: texts.notSaid }, ...areas];
  return html`<h2>${texts.mission}</h2>
    <p class="dim">${texts.chooseSomething}</p>
    ${textField(texts.designation, mission.designation, (designation) => set({ designation }))}
    ${timeField(texts.maxDuration, mission.max_duration, (max_duration) => set({ max_duration }))}
    ${selectField(texts.mode, mission.mode, optionsOf(texts.modes), (mode) =>
      set({ mode: mode as Mission["mode"] }),
    )}
    ${selectField(texts.order, mission.order, optionsOf(texts.orders), (order) =>
      set({ order: order as Mission["order"] }),
    )}
    <div class="two">
      ${selectField(texts.startArea, String(mission.start_area ?? ""), unsaid, (value) =>
        set({ start_area: area(value) }),
      )}
      ${selectField(texts.endArea, String(mission.end_area ?? ""), unsaid, (value) =>
        set({ end_area: area(value) }),
      )}
    </div>
    ${poseFields(texts.homeDock, mission.dock, (change) => setOf((now) => ({ dock: change(now.dock ?? null) })), texts.none)}
    ${textField(texts.anomalies, mission.anomaly_specification, (anomaly_specification) =>
      set({ anomaly_specification }), "long")}
    ${textField(texts.reporting, mission.real_time_reporting, (real_time_reporting) =>
      set({ real_time_reporting }), "long")}
    ${textField(texts.report, mission.after_mission_report, (after_mission_report) =>
      set({ after_mission_report }), "long")}
    ${precedenceFields(mission)}
    ${mission.left_out.length > 0
      ? html`<h3>${texts.leftOut}</h3>
          <p>${mission.left_out.join(", ")}</p>`
      : nothing}`;
}

/** Render the pairs of tasks with a required order. */
function precedenceFields(mission: Mission) {
  const texts = t().forms;
  const names = tasksAfterStart.value;
  const choice = (name: string, label: string) =>
    html`<select name=${name} aria-label=${label}>
      ${options(names.map((one) => [one, taskLabel(one)]))}
    </select>`;
  const add = (event: SubmitEvent) => {
    event.preventDefault();
    const form = new FormData(event.target as HTMLFormElement);
    const [first, second] = [form.get("first") as string, form.get("second") as string];
    void noticeRefusal(() => setOf((now) => ({ before: [...now.before, [first, second]] })));
  };
  return html`<details ?open=${mission.before.length > 0}>
    <summary>${texts.before}</summary>
    <ul>
      ${mission.before.map(
        ([first, second]) =>
          html`<li>
            ${texts.comesBefore(taskLabel(first), taskLabel(second))}
            <button
              class="bare"
              ?disabled=${!mayPlan()}
              @click=${() =>
                setOf((now) => ({
                  before: now.before.filter(([one, other]) => one !== first || other !== second),
                }))}
            >
              ${texts.remove}
            </button>
          </li>`,
      )}
    </ul>
    ${names.length > 1
      ? html`<form class="two" @submit=${add}>
          ${choice("first", texts.first)} ${choice("second", texts.comesLater)}
          <button ?disabled=${!mayPlan()}>${texts.addBefore}</button>
        </form>`
      : nothing}
  </details>`;
}

/** Show a notice if an edit was refused. */
async function noticeRefusal(work: () => Promise<string | null>): Promise<void> {
  const wrong = await work();
  if (wrong) showNotice("bad", wrong);
}
