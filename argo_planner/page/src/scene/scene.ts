import { customElement, html, PageElement } from "../ui/element";

@customElement("argo-scene")
export class ScenePanel extends PageElement {
  override render() {
    return html``;
  }
}
