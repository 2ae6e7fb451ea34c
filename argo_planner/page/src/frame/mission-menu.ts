/** The menu of the mission: export, save a version, copy. */

import { responseData, client } from "../api/client";
import { openPlans } from "../floorplan/state";
import { commandId, withPlan } from "../state/commands";
import { showNotice } from "../state/notices";
import { extensionsOf } from "../state/session";
import { planId, planName, revision, takePlanState, versions } from "../state/plan";
import { t } from "../texts";
import { iconButton } from "../ui/controls";
import { css, customElement, html, nothing, PageElement } from "../ui/element";
import { icon } from "../ui/icons";
import { returnFocus, closeOnFocusLoss } from "../ui/popover";

const FORMATS = ["script", "json", "scxml", "btcpp", "flexbe", "mermaid", "dot", "isar"] as const;

@customElement("argo-mission-menu")
export class MissionMenu extends PageElement {
  static override styles = css`
    [popover] {
      inset: 48px auto auto 12vw;
      width: 300px;
      max-height: 80vh;
      overflow: auto;
    }
    h2 {
      margin: 12px 0 4px;
    }
    #menu > button {
      margin: 0 4px 4px 0;
    }
    .formats {
      display: flex;
      flex-wrap: wrap;
      gap: 4px 12px;
    }
    ul {
      margin-top: 6px;
    }
  `;

  override render() {
    const texts = t().frame;
    const id = planId.value ?? "";
    return html`${iconButton("more", texts.missionMenu, null, { opens: "menu" })}
      <div id="menu" popover @focusout=${closeOnFocusLoss} @toggle=${returnFocus}>
        <button @click=${this.duplicate}>${icon("copy")} ${texts.duplicate}</button>
        <button id="open-plans" title="p" @click=${() => this.showPlans("plans")}>${icon("plan")} ${t().floorplan.plans}</button>
        <button id="open-sheet" @click=${() => this.showPlans("sheet")}>${icon("print")} ${t().floorplan.sheet}</button>
        <h2>${texts.exportAs}</h2>
        <p class="formats">
          ${[...FORMATS, ...extensionsOf("format")].map(
            (format) => html`<a href=${`/api/missions/${id}/export/${format}`} download>${format}</a>`,
          )}
        </p>
        <h2>${texts.versions}</h2>
        <form class="row" @submit=${this.keepVersion}>
          <input
            class="grow"
            name="name"
            required
            maxlength="200"
            aria-label=${texts.versionName}
            placeholder=${texts.versionName}
          />
          <button>${texts.keepVersion}</button>
        </form>
        ${versions.value.length > 0
          ? html`<ul>
              ${[...versions.value].reverse().map(
                (version) =>
                  html`<li class="row">
                    <span class="grow">${version.name} <span class="dim">${version.author}</span></span>
                    <button @click=${() => this.restore(version.number)}>${texts.restore}</button>
                  </li>`,
              )}
            </ul>`
          : nothing}
      </div>`;
  }

  private showPlans(shown: "plans" | "sheet"): void {
    this.renderRoot.querySelector<HTMLElement>("#menu")?.hidePopover();
    void openPlans(shown);
  }

  private async duplicate(): Promise<void> {
    await withPlan(async (id) => {
      const name = t().frame.copyOf(planName.value).slice(0, 200);
      const made = await responseData(
        client.POST("/api/missions/{id}/duplicate", { params: { path: { id } }, body: { name } }),
      );
      location.hash = `#/missions/${made.id}`;
    });
  }

  private async keepVersion(event: SubmitEvent): Promise<void> {
    event.preventDefault();
    const form = event.target as HTMLFormElement;
    const name = (new FormData(form).get("name") as string).trim();
    if (name === "") return;
    await withPlan(async (id) => {
      await responseData(
        client.POST("/api/missions/{id}/versions", {
          params: { path: { id }, header: { "If-Match": `"${revision.value}"` } },
          body: { name },
        }),
      );
      form.reset();
      showNotice("info", t().frame.versionKept(name));
    });
  }

  private async restore(number: number): Promise<void> {
    await withPlan(async (id) => {
      const done = await responseData(
        client.POST("/api/missions/{id}/versions/{number}/restore", {
          params: { path: { id, number }, header: { "If-Match": `"${revision.value}"` } },
          body: { id: commandId() },
        }),
      );
      if (planId.value === id) takePlanState(done);
    });
  }
}
