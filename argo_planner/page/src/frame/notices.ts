import { customElement, html, PageElement } from "../ui/element";

@customElement("argo-notices")
export class PageNotices extends PageElement {
  override render() {
    return html``;
  }
}
