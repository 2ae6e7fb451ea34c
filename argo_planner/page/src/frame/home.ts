import { customElement, html, PageElement } from "../ui/element";

@customElement("argo-home")
export class PageHome extends PageElement {
  override render() {
    return html``;
  }
}
