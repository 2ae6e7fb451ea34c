/** The form of a reaction: event, response, and what follows. */

import type { EventKind, Reaction } from "../api/types";
import { reactionKey } from "../model/outline";
import { edit, editFromForm } from "../state/commands";
import { mission, select } from "../state/plan";
import { extensionsOf, mayPlan } from "../state/session";
import { world } from "../state/world";
import { t } from "../texts";
import { html, nothing } from "../ui/element";
import { chargeFields, NO_CHARGE, percent, share } from "./charging";
import { countField, numberField, optionsOf, poseFields, selectField, timeField } from "./parts";

export function reactionForm(reaction: Reaction) {
  const texts = t().forms;
  const saveOf = async (change: (was: Reaction) => Partial<Reaction>) => {
    let event = reaction.event;
    const wrong = await editFromForm(() => {
      const was = mission.value?.reactions.find((one) => one.event === reaction.event) ?? reaction;
      const now = { ...was, ...change(was), source: null };
      event = now.event;
      return [{ kind: "change_reaction", event: reaction.event, reaction: now }];
    });
    if (wrong === null) select([reactionKey(event)]);
    return wrong;
  };
  // The service replaces a package's response by one of Argo's own, with its fields.
  const saveExtension = (response: string) =>
    editFromForm(() => [
      { kind: "change_reaction", event: reaction.event, reaction: { event: reaction.event, response } },
    ]);
  const responses = [
    ...optionsOf(t().words.response),
    ...extensionsOf("response").map((name) => ({ value: name, label: name })),
  ];
  const save = (change: Partial<Reaction>) => saveOf(() => change);
  const had = new Set(mission.value?.reactions.map((one) => one.event));
  const events = optionsOf(t().words.event).filter(
    ({ value }) => value === reaction.event || !had.has(value as EventKind),
  );
  const drives = reaction.response === "return" || reaction.response === "safe_area";
  const holds = drives || reaction.response === "pause";
  return html`<h2>${texts.reaction}</h2>
    ${selectField(texts.event, reaction.event, events, (event) =>
      save({ event: event as EventKind, battery_below: null }),
    )}
    ${reaction.event === "low_battery"
      ? numberField(
          texts.batteryBelow,
          percent(reaction.battery_below),
          (battery_below) => save({ battery_below: share(battery_below) }),
          { note: "%" },
        )
      : nothing}
    ${selectField(texts.response, reaction.response, responses, (response) =>
      extensionsOf("response").includes(response)
        ? saveExtension(response)
        : saveOf((was) => responding(was, response as Reaction["response"])),
    )}
    ${drives
      ? poseFields(
          texts.where,
          reaction.pose,
          (change) =>
            saveOf((was) => {
              const pose = change(was.pose ?? null);
              return { pose, area: areaOf(pose) };
            }),
          reaction.response === "return" ? texts.ownDock : null,
        )
      : nothing}
    ${holds
      ? html`${selectField(
            texts.waitUntil,
            reaction.until ?? "",
            [{ value: "", label: texts.noEvent }, ...optionsOf(t().words.event)],
            (until) => save({ until: until === "" ? null : (until as EventKind), ...NO_CHARGE }),
          )}
          ${reaction.until === "battery_charged" ? chargeFields(reaction, save) : nothing}
          ${timeField(texts.holdLimit, reaction.hold_limit, (hold_limit) => save({ hold_limit }))}
          ${reaction.hold_limit
            ? selectField(texts.onLimit, reaction.on_limit, optionsOf(t().words.afterwards), (value) =>
                save({ on_limit: value as Reaction["on_limit"] }),
              )
            : nothing}`
      : nothing}
    ${drives
      ? selectField(texts.whatThen, reaction.afterwards, optionsOf(t().words.afterwards), (value) =>
          save({ afterwards: value as Reaction["afterwards"] }),
        )
      : nothing}
    ${countField(texts.rank, reaction.priority, (priority) => save({ priority }), {
      placeholder: texts.byEvent,
    })}
    <button
      class="danger"
      ?disabled=${!mayPlan()}
      @click=${() => edit({ kind: "remove_reaction", event: reaction.event })}
    >
      ${t().list.delete}
    </button>`;
}

/** Return the fields that change with the response; fields without an effect are reset. */
function responding(reaction: Reaction, response: Reaction["response"]): Partial<Reaction> {
  const place = world.value?.places[0]?.pose ?? world.value?.docks[0]?.pose ?? null;
  const holds = response !== "report" && response !== "abort";
  return {
    response,
    pose: response === "safe_area" ? (reaction.pose ?? place) : null,
    area: null,
    until: holds ? (reaction.until ?? null) : null,
    charge_to: holds ? (reaction.charge_to ?? null) : null,
    charge_for: holds ? (reaction.charge_for ?? null) : null,
    hold_limit: holds ? (reaction.hold_limit ?? null) : null,
    on_limit: holds && reaction.hold_limit ? reaction.on_limit : "wait",
    afterwards: response === "return" || response === "safe_area" ? reaction.afterwards : "end",
  };
}

function areaOf(pose: Reaction["pose"]): number | null {
  const found = world.value?.docks.find((dock) => dock.pose.x === pose?.x && dock.pose.y === pose.y);
  return found?.area ?? null;
}
