/** Reports of a person to the run: an event, a reading, or a fault in the simulation. */

import type { EventKind } from "../api/types";
import { parseCheckpoint } from "../model/checkpoint-choice";
import { sendRequest, type RunRequest } from "../state/requests";
import { run } from "../state/run";
import { mayOperate } from "../state/session";
import { world } from "../state/world";
import { t } from "../texts";
import { faultText } from "../texts/fault-names";
import { options } from "../ui/controls";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { checkpointList, parts } from "./parts";
import { faultKinds } from "./faults";

const OWN: readonly string[] = ["time_up"]; // events that only the run itself raises

@customElement("argo-run-tell")
export class RunTell extends PageElement {
  static override styles = [
    parts,
    css`
      .all {
        display: grid;
        gap: 8px;
      }
      form {
        display: grid;
        grid-template-columns: minmax(0, 1fr) auto;
        gap: 6px;
      }
      form.reading {
        grid-template-columns: minmax(0, 1fr) 80px auto;
      }
    `,
  ];

  override render() {
    const state = run.value;
    if (state?.status !== "running") return nothing;
    const texts = t().run;
    const off = !mayOperate();
    const events = Object.entries(t().words.event).filter(([kind]) => !OWN.includes(kind));
    return html`<details>
      <summary>${texts.tell}</summary>
      <div class="all">
        <form @submit=${this.tellEvent}>
          <select name="event" aria-label=${texts.event}>
            ${options(events)}
          </select>
          <button id="tell-event" ?disabled=${off}>${texts.tellEvent}</button>
        </form>
        <form class="reading" @submit=${this.tellReading}>
          <input name="of" list="known" aria-label=${texts.checkpoint} placeholder=${texts.checkpoint} />
          ${checkpointList("known")}
          <input name="value" type="number" step="any" required aria-label=${texts.value} placeholder=${texts.value} />
          <button ?disabled=${off}>${texts.tellEvent}</button>
        </form>
        <form @submit=${this.beginFault}>
          <select name="fault" aria-label=${texts.beginFault}>
            ${options(faultKinds().map((kind) => [kind, faultText(kind)]))}
          </select>
          <button id="begin-fault" ?disabled=${off || state.drive === "remote"}>${texts.begin}</button>
        </form>
      </div>
    </details>`;
  }

  private tellEvent(event: SubmitEvent): void {
    const kind = this.field(event, "event").value as EventKind;
    void sendRequest({ kind: "event", event: kind });
  }

  private tellReading(event: SubmitEvent): void {
    const of = this.field(event, "of");
    const checkpoint = parseCheckpoint(of.value, world.value?.checkpoints ?? []);
    if (checkpoint === null) return of.focus();
    const value = Number(this.field(event, "value").value);
    void sendRequest({ kind: "reading", checkpoint: String(checkpoint.id), value });
  }

  private beginFault(event: SubmitEvent): void {
    const kind = this.field(event, "fault").value;
    void sendRequest({ kind: "fault", fault: { kind } } as unknown as RunRequest);
  }

  private field(event: SubmitEvent, name: string): HTMLInputElement {
    event.preventDefault();
    return (event.target as HTMLFormElement).elements.namedItem(name) as HTMLInputElement;
  }
}
