// The robot itself: where it believes to be, what its camera thinks, its parts, and what it can be told to do.
import {byId, make, button, toast, remember} from "./dom.js";
import {t, onLanguage} from "./i18n.js";
import {reasonOf} from "./talk.js";
import {canSpeak, setAloud, speaksAloud} from "./speech.js";

const FADES = 20000; // [ms]
const FINDINGS = ["tf", "scan", "laser", "clock", "map", "odometry", "nodes", "camera", "topics", "diagnostics"];
const LAYERS = ["slam", "localization", "fsd", "words", "gr2to", "topo_engine", "semantic_localization", "object_engine", "map_server"];
const TECHNICAL = /[_/]|:=/; // words that only technicians know
const SIGNS = {ok: "✓", warn: "!", error: "✗", stale: "…", WRONG: "✗", note: "!"};

export class RobotPanel {
  // actions: tool(kind), themeChanged(), logout()
  constructor(model, connection, may, actions) {
    Object.assign(this, {model, connection, may, actions});
    this.panel = byId("panel-robot");
    model.on(["status", "here", "places", "camera", "layers", "can", "pose", "way", "arrived", "following", "refused", "learning"], () => {
      this.showWhere();
      this.showState();
    });
    onLanguage(() => this.build());
    this.build();
  }

  build() {
    this.state = make("div");
    this.findings = make("ul", {class: "list"});
    const actions = make("div", {class: "actions"});
    const add = (key, role, action) => {
      if (this.may(role)) actions.append(button(t(key), action, {id: "do-" + key}));
    };
    add("set_pose", "drive", () => this.actions.tool("pose"));
    add("draw_wall", "drive", () => this.actions.tool("wall"));
    add("check", "look", (event) => this.check(event.target));
    if (this.model.values.can?.save) add("save", "drive", (event) => this.save(event.target));
    if (this.model.tables.layers.semantic_localization) add(this.learning() ? "unlearn" : "learn", "drive", (event) => this.learn(event.target));
    const page = make("div", {class: "actions"});
    if (canSpeak()) {
      page.append(button(t("speak"), (event) => {
        setAloud(!speaksAloud());
        event.target.setAttribute("aria-pressed", String(speaksAloud()));
      }, {"aria-pressed": String(speaksAloud())}));
    }
    page.append(button(t("theme"), () => {
      const now = document.documentElement.dataset.theme ?? (matchMedia("(prefers-color-scheme: dark)").matches ? "dark" : "light");
      document.documentElement.dataset.theme = now === "dark" ? "light" : "dark";
      remember("theme", document.documentElement.dataset.theme);
      this.actions.themeChanged();
    }));
    if (this.actions.login()) page.append(button(t("logout"), () => this.actions.logout()));
    this.panel.replaceChildren(...(this.connection.replays ? [] : [make("h2", {}, t("do_title")), actions, this.findings]), this.state, make("h3", {}, t("page_title")), page);
    this.key = "";
    this.showWhere();
    this.showState();
  }

  showWhere() {
    const {here, status, way, arrived, following} = this.model.values;
    const {replays} = this.connection;
    const known = here?.place ? this.model.nameOf(here.place) : null;
    const name = known ? this.model.labelOf(here.place) : "";
    const parts = [here?.place ? t(here.door ? "in_doorway" : "in_place", {name}) : this.model.values.pose ? t("nowhere") : t("title")];
    if (status && status.phase !== "sure") parts.push(t(`phase_${status.phase}`));
    if (!arrived) this.arrivedAt = null; // there once more is news again
    if (following) parts.push(t("following"));
    else if (way?.length) parts.push(t("going"));
    else if (arrived && this.isNews(arrived)) parts.push(t("arrived"));
    const trouble = !replays && this.hasTrouble();
    if (trouble) parts.push(t("trouble"));
    if (replays) parts.unshift(t("replay_at", {time: this.time ?? ""}));
    const text = parts.join(" · ");
    // What is played is not how it is: no colour.
    const kind = replays ? "" : trouble ? "lost" : status?.phase ?? (here?.place ? "sure" : "");
    const box = byId("where");
    if (box.dataset.text === text + kind) return;
    box.dataset.text = text + kind;
    box.replaceChildren(make("span", {class: `dot ${kind}`, "aria-hidden": "true"}), make("span", {class: "text"}, text));
  }

  // That it has arrived is told for a while.
  isNews(arrived) {
    const key = JSON.stringify(arrived);
    if (this.arrivedAt?.key !== key) {
      this.arrivedAt = {key, since: performance.now()};
      setTimeout(() => this.showWhere(), FADES + 50);
    }
    return performance.now() - this.arrivedAt.since < FADES;
  }

  // Of the day that is played.
  showTime(text) {
    this.time = text;
    this.showWhere();
  }

  // A part does not work, or the last look found something wrong.
  hasTrouble() {
    return this.foundWrong || Object.values(this.model.tables.layers).some((each) => each.level === "error");
  }

  showState() {
    const {status, camera, refused} = this.model.values;
    const layers = this.model.tables.layers;
    const known = Object.keys(layers).includes("semantic_localization") + String(this.model.values.can?.save) + this.learning();
    if (known !== this.builtFor) {
      this.builtFor = known;
      this.build();
      return;
    }
    const key = JSON.stringify([status?.phase, status?.text, camera, layers, refused]);
    if (key === this.key) return;
    this.key = key;
    const parts = [];
    if (refused) parts.push(make("p", {class: "error"}, t("map_refused")));
    if (status) parts.push(make("h3", {}, t("pose_title")), make("p", {}, t(`phase_${status.phase}`)));
    if (camera) {
      parts.push(make("h3", {}, t("camera_title")));
      if (!camera.seen) parts.push(make("p", {class: "note"}, t("camera_nothing")));
      for (const [name, p] of camera.top) {
        const bar = make("i");
        bar.style.width = `${Math.round(100 * p)}%`;
        parts.push(make("div", {class: "meter"}, make("span", {}, name), make("span", {}, bar), make("span", {}, `${Math.round(100 * p)} %`)));
      }
    }
    parts.push(make("h3", {}, t("layers_title")));
    const lines = Object.entries(layers).map(([name, each]) => make("li", {}, make("span", {class: `level ${each.level}`, "aria-hidden": "true"}, SIGNS[each.level]),
      this.layer(name, each)));
    parts.push(lines.length ? make("ul", {class: "list"}, ...lines) : make("p", {class: "note"}, t("no_layers")));
    const technical = [...(refused ? [refused] : []), ...(status ? [status.text] : []), ...Object.entries(layers).map(([name, each]) => `${name}: ${each.text}`)];
    if (technical.length) parts.push(this.details("state", technical));
    this.state.replaceChildren(...parts);
  }

  // One that has something to say says it when it is tapped.
  layer(name, each) {
    const title = [LAYERS.includes(name) ? t(`layer_${name}`) : name.replaceAll("_", " "), make("span", {class: "sub"}, t(`level_${each.level}`))];
    if (each.level === "ok" || !each.text) return make("span", {}, ...title);
    const said = TECHNICAL.test(each.text) ? t("see_technical") : each.text;
    this.opened ??= new Set();
    const details = make("details", {"data-layer": name, class: "rest"}, make("summary", {}, make("span", {}, ...title)), make("p", {class: "note"}, said));
    details.open = this.opened.has(`layer ${name}`);
    details.addEventListener("toggle", () => (details.open ? this.opened.add(`layer ${name}`) : this.opened.delete(`layer ${name}`)));
    return details;
  }

  // What technicians want to read; it stays open while its lines change.
  details(key, lines) {
    this.opened ??= new Set();
    const details = make("details", {}, make("summary", {}, t("technical")), ...lines.filter(Boolean).map((line) => make("p", {class: "note"}, line)));
    details.open = this.opened.has(key);
    details.addEventListener("toggle", () => (details.open ? this.opened.add(key) : this.opened.delete(key)));
    return details;
  }

  async busy(element, text, action) {
    const before = element.textContent;
    element.disabled = true;
    element.textContent = text;
    try {
      await action();
    } catch (error) {
      toast(reasonOf(error), true);
    }
    element.disabled = false;
    element.textContent = before;
  }

  check(element) {
    return this.busy(element, t("checking"), async () => {
      const {findings} = await this.connection.ask("doctor", {}, 70000);
      const bad = findings.filter((each) => each.level !== "ok");
      this.foundWrong = bad.some((each) => each.level === "WRONG");
      this.showWhere();
      const lines = [];
      for (const {level, name} of bad) {
        const text = t(`found_${level === "note" ? "note" : "WRONG"}`, {what: t(`about_${FINDINGS.includes(name) ? name : "other"}`)});
        if (lines.some((line) => line.dataset.text === text)) continue;
        const advice = t(`advice_${FINDINGS.includes(name) ? name : "other"}`);
        lines.push(make("li", {"data-text": text}, make("span", {class: `level ${level === "note" ? "note-level" : level}`, "aria-hidden": "true"}, SIGNS[level]), make("span", {}, text, make("span", {class: "sub"}, advice))));
      }
      if (!lines.length) lines.push(make("li", {}, make("span", {class: "level ok", "aria-hidden": "true"}, "✓"), t("all_right")));
      else lines.push(make("li", {}, this.details("findings", bad.map((each) => `${each.name}: ${each.text}${each.hint ? ` → ${each.hint}` : ""}`))));
      this.findings.replaceChildren(...lines);
    });
  }

  save(element) {
    return this.busy(element, t("saving"), async () => {
      await this.connection.ask("save", {}, 70000);
      toast(t("saved"));
    });
  }

  async learn(element) {
    await this.busy(element, "…", async () => {
      const on = !this.learning();
      const result = await this.connection.ask("learn", {on});
      toast(result.message || t(on ? "learning" : "not_learning"));
    });
    this.build();
  }

  // As all pages know it: another one may have asked for it.
  learning() {
    return Boolean(this.model.values.learning);
  }
}
