/** The form of a group: its rounds, and what ends them. */

import type { Group } from "../api/types";
import { ownName } from "../model/outline";
import { edit, editFromForm } from "../state/commands";
import { mission } from "../state/plan";
import { mayPlan } from "../state/session";
import { groupLabel, taskLabel } from "../state/task-labels";
import { t } from "../texts";
import { html } from "../ui/element";
import { conditionList } from "./conditions";
import { checkField, countField, optionsOf, selectField, textField, timeField } from "./parts";

type Fields = Partial<Omit<Group, "name" | "source">>;

export function groupForm(group: Group) {
  const texts = t().forms;
  const setOf = (change: (was: Group) => Fields) =>
    editFromForm(() => {
      const was = mission.value?.groups.find((one) => one.name === group.name) ?? group;
      return [{ kind: "change_group", name: group.name, ...change(was) }];
    });
  const set = (fields: Fields) => setOf(() => fields);
  const saveUntil = (change: (was: Group["until"]) => Group["until"]) =>
    setOf((was) => ({ until: change(was.until) }));
  const tasks = (mission.value?.tasks ?? []).map(({ name }) => ({ value: name, label: taskLabel(name) }));
  const rename = (name: string) =>
    editFromForm(() => [{ kind: "rename_group", name: group.name, own_name: name.trim() }]);
  return html`<h2>${groupLabel(group.name)}</h2>
    ${textField(texts.name, ownName(group.name), rename)}
    ${countField(texts.rounds, group.max_repeat_count || null, (count) =>
      set({ max_repeat_count: count ?? 0 }),
    )}
    ${timeField(texts.duration, group.max_repeat_duration || null, (time) =>
      // A new group has one round. With a time limit its rounds are to be repeated until then.
      setOf((was) => ({
        max_repeat_duration: time ?? 0,
        ...(was.max_repeat_count === 1 && time ? { max_repeat_count: 0 } : {}),
      })),
    )}
    ${group.max_repeat_duration > 0
      ? html`${selectField(texts.stop, group.stop, optionsOf(texts.stops), (stop) =>
            set({ stop: stop as Group["stop"] }),
          )}
          ${checkField(texts.countInterruptions, group.count_interruptions, (counted) =>
            set({ count_interruptions: counted }),
          )}`
      : null}
    ${timeField(texts.every, group.every || null, (every) => set({ every: every ?? 0 }))}
    <h3>${texts.until}</h3>
    ${conditionList(group.until, saveUntil, texts.addCondition)}
    <details>
      <summary>${texts.extent}</summary>
      ${selectField(texts.first, group.start, tasks, (start) => set({ start }))}
      ${selectField(texts.last, group.end, tasks, (end) => set({ end }))}
    </details>
    <button
      ?disabled=${!mayPlan()}
      @click=${() => edit({ kind: "dissolve_group", name: group.name })}
    >
      ${t().list.ungroup}
    </button>`;
}
