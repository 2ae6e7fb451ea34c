import { customElement, html, PageElement } from "../ui/element";

@customElement("argo-strip")
export class StripPanel extends PageElement {
  override render() {
    return html``;
  }
}
