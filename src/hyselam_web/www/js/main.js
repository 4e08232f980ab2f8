// The page: its parts, and what joins them.
import {byId, make, button, toast, remembered} from "./dom.js";
import {t, setLanguage, currentLanguage, firstLanguage, onLanguage, missingTexts} from "./i18n.js";
import {Model} from "./model.js";
import {Connection, postStop} from "./connection.js";
import {MapView} from "./map_view.js";
import {Talk, reasonOf} from "./talk.js";
import {Places} from "./places.js";
import {NextStep} from "./next_step.js";
import {RobotPanel} from "./robot_panel.js";
import {LookBack} from "./look_back.js";
import {thingsOn} from "./map_things.js";
import {told} from "./wording.js";
import {Fingers} from "./fingers.js";
import {Replay, entriesOf} from "./replay.js";

const ROLES = ["look", "talk", "drive"];
const LIT = 8000; // [ms] that a place stays marked
const TABS = ["talk", "places", "robot", "back"];

class Page {
  constructor() {
    const theme = remembered("theme");
    if (theme === "dark" || theme === "light") document.documentElement.dataset.theme = theme;
    this.session = {role: "", login: false, language: "en", recording: false};
    this.model = new Model();
    this.fingers = new Fingers();
    const recorded = globalThis.HYSELAM_RECORDING;
    this.replay = Boolean(recorded) || new URLSearchParams(location.search).has("replay");
    setLanguage(firstLanguage("en"));
    if (this.replay) this.source = {replays: true, ask: () => Promise.reject({code: "not_connected"}), stop: postStop};
    else this.source = new Connection(this.model, {onState: (on) => this.onState(on), onSession: (session) => this.onSession(session), onTiles: () => this.map.tilesChanged()});
    this.build();
    if (this.replay) this.startReplay(recorded);
    else this.source.start();
  }

  may(role) {
    return !this.replay && ROLES.indexOf(this.session.role) >= ROLES.indexOf(role);
  }

  build() {
    const {model, source} = this;
    const may = (role) => this.may(role);
    this.map = new MapView(byId("map"), model, {
      onTap: (x, y, place, object) => this.onTap(place, this.picking ? null : object),
      onLine: (from, to) => this.onLine(from, to),
      onFirstEnd: () => this.showTool("tool_second"),
      onUserMove: () => byId("follow").setAttribute("aria-pressed", "false"),
      onEscape: () => (this.map.tool || this.picking ? this.setTool(null) : this.places.close()),
    });
    this.talk = new Talk(model, source, may, (text) => this.next.heard(text), (text) => this.next.answer(text), (id, brings) => this.light(id, brings));
    this.next = new NextStep(model, source, may, {
      say: (text, undo) => this.talk.say(text, undo),
      pick: (name, ids) => this.pick(name, ids),
      marked: (marked) => {
        model.marked = marked;
        model.tell(["marked"]);
      },
    });
    this.places = new Places(model, source, may, {
      showOnMap: (x, y) => this.map.show(x, y),
      say: (text, undo) => this.talk.say(text, undo),
      openTalk: () => this.openTab("talk"),
      pick: (name) => this.pick(name, []),
      give: (id, name) => this.next.give(id, name),
      unwall: (wall, done) => this.unwall(wall, done),
      selected: (id) => {
        this.map.selected = id;
        this.map.invalidate();
      },
    });
    this.robot = new RobotPanel(model, source, may, {
      tool: (kind) => this.setTool(kind),
      themeChanged: () => this.map.themeChanged(),
      login: () => this.session.login,
      logout: async () => {
        await fetch("logout", {method: "POST"}).catch(() => {});
        location.reload();
      },
    });
    this.back = new LookBack(source);
    byId("zoom-in").onclick = () => this.map.zoom(1.5);
    byId("zoom-out").onclick = () => this.map.zoom(1 / 1.5);
    byId("fit").onclick = () => this.map.fit();
    byId("follow").onclick = (event) => {
      this.map.setFollow(!this.map.follows);
      event.currentTarget.setAttribute("aria-pressed", String(this.map.follows));
    };
    byId("stop").onclick = () => this.stop();
    byId("language").onclick = () => setLanguage(currentLanguage() === "en" ? "pt" : "en", true);
    byId("login-form").onsubmit = (event) => this.login(event);
    for (const name of TABS) byId(`tab-${name}`).onclick = () => this.openTab(name, true);
    byId("tabs").addEventListener("keydown", (event) => this.moveTab(event));
    // Cards stand above the foot of the page, however high that is.
    new ResizeObserver(([{target}]) => document.body.style.setProperty("--foot", `${target.offsetHeight}px`)).observe(document.querySelector("footer"));
    model.on(["map", "places"], () => this.showEmpty());
    model.on(["reach"], () => this.showLost());
    model.on(["way", "arrived"], () => {
      const {way, arrived} = model.values;
      if (arrived && this.going && !way?.length && !this.replay) {
        const place = model.placeAt(...arrived);
        const values = {name: place === null ? "" : model.nameOf(place).sure || model.nameOf(place).none ? model.titleOf(place) : `${t("place_of", {n: place})} (${model.labelOf(place)})`};
        toast(t("arrived_at", values));
        this.talk.note("arrived_at", values);
      }
      this.going = Boolean(way?.length);
    });
    const named = () => { byId("language").textContent = t("other_language"); };
    onLanguage(() => {
      named();
      this.showLost();
      this.showEmpty();
      if (this.map.tool || this.picking) this.showTool();
      this.map.invalidate();
    });
    named();
    this.showEmpty();
  }

  // Whether there is a map is known to those who may look.
  showEmpty() {
    const {values, tables} = this.model;
    const known = this.replay || this.session.run !== undefined;
    byId("map-empty").hidden = !known || Boolean(values.map) || Object.keys(tables.places).length > 0;
    byId("map-empty").textContent = t(this.replay || this.session.role ? "map_empty" : "map_login");
  }

  // ---- Connection ----

  onSession(session) {
    const changed = JSON.stringify(session) !== JSON.stringify(this.session);
    const first = this.session.run === undefined;
    this.session = session;
    this.source.allowed = session.role !== "";
    this.showEmpty();
    if (first && !remembered("language")) setLanguage(firstLanguage(session.language));
    byId("login").hidden = session.role !== "";
    byId("tabs").inert = session.role === "";
    if (session.role === "" && first) byId("token").focus();
    this.back.recording = session.recording;
    if (changed) {
      this.robot.build();
      this.talk.showAsked();
      this.next.show();
      byId("say-form").hidden = byId("chips").hidden = !this.may("talk");
      if (this.places.open) this.places.showCard();
    }
  }

  onState(connected) {
    this.connected = connected;
    document.body.classList.toggle("unconnected", !connected);
    this.showLost();
  }

  showLost() {
    const bar = byId("lost");
    const text = this.replay ? "" : this.connected === false ? t("lost_connection") : this.model.values.reach?.master === false ? t("lost_master") : "";
    if (bar.textContent !== text) bar.textContent = text;
    bar.hidden = !text;
  }

  async login(event) {
    event.preventDefault();
    const answer = await fetch("login", {method: "POST", headers: {"Content-Type": "application/json"}, body: JSON.stringify({token: byId("token").value})}).catch(() => null);
    byId("login-error").textContent = !answer ? t("not_connected") : answer.ok ? "" : t(answer.status === 429 ? "login_often" : "login_wrong");
    if (!answer?.ok) return;
    byId("token").value = "";
    this.source.start();
  }

  async stop() {
    const sent = await this.source.stop();
    toast(t(this.replay && sent === "sent" ? "stop_real" : `stop_${sent}`), sent !== "sent");
  }

  // ---- Map ----

  onTap(place, object) {
    if (this.picking) {
      if (place === null) return;
      const {name} = this.picking;
      this.setTool(null);
      this.next.give(place, name);
    } else if (object !== null) this.places.show("object", object);
    else if (place !== null) {
      this.places.show("place", place, this.map.keys);
    } else this.places.close();
  }

  // A place that was told of is marked for a moment.
  light(id, brings) {
    const {model} = this;
    const of = model.place(id);
    if (!of) return;
    if (brings) {
      document.body.classList.remove("folded");
      if (of.c) this.map.show(...of.c);
    }
    model.lit = Number(id);
    model.tell(["marked"]);
    clearTimeout(this.lightTimer);
    this.lightTimer = setTimeout(() => {
      model.lit = null;
      model.tell(["marked"]);
    }, LIT);
  }

  // The next place that is tapped gets the name.
  pick(name, ids) {
    this.setTool(null);
    this.picking = {name, ids};
    if (ids.length) this.map.fit();
    byId("map").classList.add("picking");
    byId("tool-bar").hidden = false;
    this.showTool();
    byId("map").focus({preventScroll: true});
  }

  setTool(kind) {
    this.picking = null;
    byId("map").classList.remove("picking");
    this.map.setTool(kind);
    this.places.close();
    byId("tool-bar").hidden = !kind;
    if (kind) {
      this.showTool();
      byId("map").focus({preventScroll: true});
    }
  }

  showTool(key = this.picking ? "tool_pick" : `tool_${this.map.tool.kind}`) {
    const keys = t(this.picking ? "tool_pick_keys" : "tool_keys");
    byId("tool-bar").replaceChildren(t(key, this.picking ?? {}), make("div", {class: "row"}, button(t("cancel"), () => this.setTool(null)), make("span", {class: "note"}, keys)));
  }

  async onLine(from, to) {
    const {kind} = this.map.tool;
    try {
      if (kind === "pose") {
        await this.source.ask("pose", {x: from[0], y: from[1], yaw: Math.atan2(to[1] - from[1], to[0] - from[0])});
        toast(t("pose_sent"));
      } else {
        const wall = {ax: from[0], ay: from[1], bx: to[0], by: to[1]};
        await this.source.ask("wall", {...wall, language: currentLanguage()});
        toast(t("wall_sent"), false, [t("undo"), () => this.unwall({...wall, v: false}, t("unwalled"))]);
      }
      this.setTool(null);
    } catch (error) {
      toast(reasonOf(error), true);
    }
  }

  // A wall that somebody told of, or a shut door, is there no more.
  async unwall({ax, ay, bx, by, v}, done) {
    try {
      await this.source.ask("unwall", {ax, ay, bx, by, virtual: v, language: currentLanguage()});
      toast(done);
    } catch (error) {
      toast(reasonOf(error), true);
    }
  }

  // ---- Tabs ----

  openTab(name, may_fold = false) {
    if (may_fold && (this.map.tool || this.picking)) this.setTool(null);
    const was_open = byId(`tab-${name}`).getAttribute("aria-selected") === "true";
    if (may_fold && !was_open) this.places.close(); // it would lie on what was asked for
    if (!was_open) this.places.clearSearch();
    // Once more on the open tab of a phone: the whole screen for the map.
    document.body.classList.toggle("folded", may_fold && was_open && innerWidth < 900 && !document.body.classList.contains("folded"));
    for (const each of TABS) {
      const tab = byId(`tab-${each}`);
      tab.setAttribute("aria-selected", String(each === name));
      tab.tabIndex = each === name ? 0 : -1;
      byId(`panel-${each}`).hidden = each !== name;
    }
    if (name === "back") this.back.show();
    if (name === "talk") this.talk.showNewest();
  }

  moveTab(event) {
    const tabs = TABS.filter((name) => !byId(`tab-${name}`).hidden);
    const at = tabs.findIndex((name) => byId(`tab-${name}`) === document.activeElement);
    const to = {ArrowRight: at + 1, ArrowLeft: at - 1, Home: 0, End: tabs.length - 1}[event.key];
    if (at < 0 || to === undefined) return;
    const name = tabs[(to + tabs.length) % tabs.length];
    this.openTab(name);
    byId(`tab-${name}`).focus();
    event.preventDefault();
  }

  // ---- A recorded day ----

  async startReplay(recorded) {
    document.body.classList.add("replay");
    byId("stop").hidden = Boolean(recorded); // a file has no robot behind it; the server that plays its day has
    byId("tab-back").hidden = Boolean(recorded); // nor has a file reports, or a present to go back to
    byId("stop").dataset.t = "stop_robot";
    byId("stop").textContent = t("stop_robot");
    byId("player").hidden = false;
    let entries = recorded;
    if (!entries) {
      const answer = await fetch("recording").catch(() => null);
      entries = answer?.ok ? entriesOf(await answer.text()) : [];
    }
    if (!entries.length) {
      toast(t("no_recording"), true);
      return;
    }
    const replay = new Replay(this.model, entries, () => this.map.tilesChanged(), (time) => this.robot.showTime(time));
    this.replayer = replay;
    replay.showButton();
    this.source.live = !recorded;
    replay.goTo(replay.begin);
    replay.play(!matchMedia("(prefers-reduced-motion: reduce)").matches);
  }
}

globalThis.hyselam = new Page();
globalThis.hyselam.missingTexts = missingTexts;
globalThis.hyselam.thingsOn = thingsOn;
globalThis.hyselam.told = (text) => told(text, globalThis.hyselam.model);
