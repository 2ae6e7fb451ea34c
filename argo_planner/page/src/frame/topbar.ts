import { customElement, html, PageElement } from "../ui/element";

@customElement("argo-topbar")
export class PageTopbar extends PageElement {
  override render() {
    return html``;
  }
}
