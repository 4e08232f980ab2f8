// What was: reports, and the recording of the day.
import {byId, make} from "./dom.js";
import {t, onLanguage} from "./i18n.js";

export class LookBack {
  constructor(connection) {
    this.connection = connection;
    this.panel = byId("panel-back");
    this.recording = false;
    onLanguage(() => this.show());
  }

  async show() {
    const parts = [];
    if (this.connection.replays) {
      if (this.connection.live) parts.push(make("p", {}, make("a", {href: location.pathname}, t("back_live"))));
    } else if (this.recording) {
      parts.push(make("p", {}, make("a", {href: "?replay"}, t("watch")), make("span", {class: "sub note"}, " " + t("watch_text"))));
    }
    if (!this.connection.replays) {
      parts.push(make("h3", {}, t("reports")));
      let names = [];
      try {
        const answer = await fetch("reports");
        if (answer.ok) names = await answer.json();
      } catch { /* shown as lost anyway */ }
      parts.push(names.length
        ? make("ul", {}, ...names.map((name) => make("li", {}, make("a", {href: "report/" + name.split("/").map(encodeURIComponent).join("/"), target: "_blank", rel: "noopener"}, name))))
        : make("p", {class: "note"}, t("no_reports")));
    }
    this.panel.replaceChildren(...parts);
  }
}
