import { customElement, html, PageElement } from "../ui/element";

@customElement("argo-run")
export class RunPanel extends PageElement {
  override render() {
    return html``;
  }
}
