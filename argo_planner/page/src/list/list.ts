import { customElement, html, PageElement } from "../ui/element";

@customElement("argo-list")
export class ListPanel extends PageElement {
  override render() {
    return html``;
  }
}
