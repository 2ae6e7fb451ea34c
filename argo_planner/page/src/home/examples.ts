/** The examples that the package has, to begin with. */

import type { ExampleSummary } from "../api/types";
import { mayPlan } from "../state/session";
import { t } from "../texts";
import { css, customElement, html, nothing, PageElement, state } from "../ui/element";
import { icon } from "../ui/icons";
import { openExample } from "./actions";
import { examples, missions } from "./state";

@customElement("argo-examples")
export class ExampleCards extends PageElement {
  static override styles = css`
    ul {
      display: grid;
      grid-template-columns: repeat(auto-fill, minmax(230px, 1fr));
      gap: 10px;
      margin-top: 10px;
    }
    button {
      display: grid;
      grid-template-columns: auto 1fr;
      justify-items: start;
      align-content: start;
      gap: 4px 8px;
      width: 100%;
      height: 100%;
      padding: 12px;
      border-radius: var(--round);
      text-align: left;
    }
    .title {
      font-weight: 600;
      overflow-wrap: anywhere;
    }
    .about {
      grid-column: 1 / 3;
      color: var(--dim);
      font-size: 13px;
    }
    summary {
      margin-top: 18px;
    }
  `;

  /** Whether an example is being opened; a second click must not open another copy. */
  @state() private opening = false;

  override render() {
    const all = examples.value;
    const texts = t().home;
    if (all.length === 0 || missions.value === null) return nothing;
    const cards = html`<ul>
      ${all.map((one) => html`<li>${this.card(one)}</li>`)}
    </ul>`;
    if (missions.value.length > 0)
      return html`<details>
        <summary>${texts.examples}</summary>
        ${cards}
      </details>`;
    return html`<section aria-labelledby="examples">
      <h2 id="examples">${texts.beginWithExample}</h2>
      <p class="dim">${mayPlan() ? texts.exampleIsCopied : t().list.mayNot}</p>
      ${cards}
    </section>`;
  }

  private card(one: ExampleSummary) {
    const known = t().home.exampleTexts[one.name];
    const title = known?.title ?? one.name;
    return html`<button ?disabled=${!mayPlan() || this.opening} @click=${() => this.open(one.name, title)}>
      ${icon("script")} <span class="title">${title}</span>
      <span class="about">${known?.about ?? one.about}</span>
    </button>`;
  }

  private async open(name: string, title: string): Promise<void> {
    this.opening = true;
    await openExample(name, title);
    this.opening = false;
  }
}
