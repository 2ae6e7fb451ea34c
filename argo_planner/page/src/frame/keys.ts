import { customElement, html, PageElement } from "../ui/element";

@customElement("argo-keys")
export class PageKeys extends PageElement {
  override render() {
    return html``;
  }
}
