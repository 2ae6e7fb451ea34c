import { customElement, html, PageElement } from "../ui/element";

@customElement("argo-properties")
export class PropertiesPanel extends PageElement {
  override render() {
    return html``;
  }
}
