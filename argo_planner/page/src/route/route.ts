import { customElement, html, PageElement } from "../ui/element";

@customElement("argo-route")
export class RoutePanel extends PageElement {
  override render() {
    return html``;
  }
}
