import { customElement, html, PageElement } from "../ui/element";

@customElement("argo-script")
export class ScriptPanel extends PageElement {
  override render() {
    return html``;
  }
}
