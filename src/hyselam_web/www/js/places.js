// Places: the list of all, and the card of the one that was tapped, with what can be done there.
import {byId, make, button, toast} from "./dom.js";
import {t, onLanguage, currentLanguage} from "./i18n.js";
import {reasonOf} from "./talk.js";
import {called, folded, meant, plain} from "./wording.js";
import {behind, plainWalls, shutBy, sidesOf} from "./building.js";

const ONE_THING = /^[\p{L}\p{N}' -]{1,60}$/u; // a name that can be put into a sentence without becoming another one,
const JOINING = ["and", "then", "or", "but", "also", "plus", "e", "depois", "ou", "mas", "entao", "tambem", "nem"]; // unless it has one of these,
const MAX_WORDS = 4; // or more words: those are rather a sentence

// "pen", but neither "pen. Follow me" nor "pen and follow me".
function isOneThing(name) {
  const words = folded(name).split(/[\s-]+/).filter(Boolean);
  return ONE_THING.test(name) && words.length > 0 && words.length <= MAX_WORDS && !words.some((word) => JOINING.includes(word));
}

// "Where are you?", typed where a name belongs.
function isRatherSaid(name) {
  return /[?？]$/.test(name) || name.split(/\s+/).length > MAX_WORDS;
}

export class Places {
  // actions: showOnMap(id), say(text), openTalk()
  constructor(model, connection, may, actions) {
    Object.assign(this, {model, connection, may, actions});
    this.card = byId("card");
    this.list = byId("panel-places");
    this.open = null; // {kind: "place" or "object", id}
    this.naming = false;
    this.sure = null; // what was asked for and is asked about: {key, text, act}
    this.filter = "";
    model.on(["places", "doors", "told", "objects", "here", "asked", "marked"], () => {
      this.showList();
      if (this.open && !this.naming) this.showCard();
    });
    onLanguage(() => {
      this.buildList();
      if (this.open) this.showCard();
    });
    this.card.addEventListener("keydown", (event) => {
      if (event.key === "Escape") this.close();
    });
    this.buildList();
  }

  // ---- The card ----

  show(kind, id, focus = false) {
    this.open = {kind, id: String(id)};
    this.naming = false;
    this.sure = null;
    this.showCard();
    if (focus) (this.card.querySelector(".foot button") ?? this.card.querySelector("button"))?.focus();
  }

  close() {
    const was_inside = this.card.contains(document.activeElement);
    this.open = null;
    this.naming = false;
    this.sure = null;
    this.card.hidden = true;
    this.actions.selected(null);
    if (was_inside) byId("map").focus();
  }

  showCard() {
    const {kind, id} = this.open;
    const content = this.sure ? this.surely(id) : kind === "place" ? this.placeCard(id) : this.objectCard(id);
    if (!content) {
      this.close();
      return;
    }
    const holder = make("div", {"data-of": `${kind} ${id}`}, ...content.filter(Boolean), button("×", () => this.close(), {class: "close", "aria-label": t("close"), "data-key": "close"}));
    // What is the same stays: a finger may be on it.
    if (this.card.hidden || !this.shownCard?.isEqualNode(holder)) {
      this.shownCard = holder.cloneNode(true);
      const inside = this.card.contains(document.activeElement) && document.activeElement.dataset.key;
      this.card.replaceChildren(...holder.childNodes);
      if (inside) this.card.querySelector(`[data-key="${inside}"]`)?.focus();
    }
    this.card.hidden = false;
    this.actions.selected(kind === "place" ? id : null);
  }

  describe(id) {
    const {model} = this;
    const place = model.place(id);
    const name = model.nameOf(id);
    const parts = name.none ? [] : [t("place_of", {n: id}) + "."];
    if (model.values.asked?.place === Number(id)) parts.push(t("asked_here"));
    parts.push(t(name.none ? "unnamed" : name.sure ? "named_sure" : "named_guess"));
    if (place.s) parts.push(t("about", {kind: t(`kind_${place.k}`), area: Math.round(place.s)}));
    if (place.n.length > 1) parts.push(place.n.slice(1).map((word) => word[0]).join(", ") + ".");
    for (const [key, ids] of [["beside", model.neighbours(id)], ["behind", behind(model, id)]]) {
      const names = ids.map((each) => model.labelOf(each));
      if (names.length) parts.push(t(key, {names: names.slice(0, 5).join(", ") + (names.length > 5 ? "…" : "")}));
    }
    const things = Object.values(model.tables.objects).filter((each) => each.c && model.placeAt(...each.c) === String(id)).map((each) => each.k);
    if (things.length) parts.push(t("things", {names: [...new Set(things)].slice(0, 6).join(", ")}));
    if (model.values.here?.place === Number(id)) parts.push(t("robot_is_here"));
    return parts.join(" ").replace(/([?…])\.(?= |$)/g, "$1"); // "library?", not "library?."
  }

  placeCard(id) {
    const {model} = this;
    const place = model.place(id);
    if (!place) return null;
    const name = model.nameOf(id);
    const title = make("h2", {id: "card-title"}, model.titleOf(id));
    if (this.naming) return [title, this.nameForm(id, name), this.driveRow()];
    const [row, drives] = [make("div", {class: "row"}), this.driveRow()];
    const add = (to, key, action, properties = {}) => to.append(button(t(key), action, {"data-key": key, ...properties}));
    const guess = !name.none && !name.sure;
    const {marked} = model;
    if (this.may("talk") && marked?.ids.includes(Number(id)) && marked.name !== name.text) {
      row.append(button(t("this_is", {name: called(marked.name)}), () => {
        this.close();
        this.actions.give(id, marked.name);
      }, {"data-key": "this_is", class: "primary"}));
    }
    if (this.may("talk") && guess) {
      add(row, "right_name", () => this.name(id, [name.text]), {class: "primary"});
      add(row, "wrong_name", () => this.startNaming());
    }
    if (this.may("talk") && !guess) add(row, name.none ? "name_it" : "rename_it", () => this.startNaming(), name.none ? {class: "primary"} : {});
    if (this.may("talk")) add(row, "ask_about", () => {
      this.close();
      this.actions.openTalk();
      // Never by a name that somebody gave: it could hold another sentence.
      this.actions.say(t("what_next", {name: place.e})); // shown as "place 5"
    });
    if (this.may("drive")) {
      add(drives, "go_there", () => {
        this.close();
        this.actions.openTalk(); // the answer comes there
        this.ask("go", {place: Number(id), language: currentLanguage()}, null);
      }, {"data-settles": `go ${id}`, class: name.sure ? "primary" : ""});
      add(drives, "here_you_are", () => this.askSurely(t("here_sure", {name: model.titleOf(id)}), "here_yes", () => this.ask("here", {place: Number(id)}, t("pose_sent"))));
    }
    return [title, make("p", {}, this.describe(id)), this.doorsOf(id), make("div", {class: "foot"}, row, drives)];
  }

  // The lowest row of each card of a place, at the same spot of the screen: what sets the robot going is there, and nothing else ever is.
  driveRow() {
    return this.may("drive") ? make("div", {class: "row drives"}) : null;
  }

  // Asks before something is done that is not easily taken back.
  askSurely(text, yes, act) {
    this.sure = {text, yes, act};
    this.showCard();
    this.card.querySelector("button")?.focus();
  }

  surely(id) {
    if (!this.model.place(id)) return null;
    const {text, yes, act} = this.sure;
    const end = () => {
      this.sure = null;
      if (this.open) this.showCard();
    };
    return [make("h2", {id: "card-title"}, this.model.titleOf(id)), make("p", {}, text), make("div", {class: "row"}, button(t(yes), () => {
      end();
      act();
    }, {class: "primary", "data-key": "sure"}), button(t("cancel"), end, {"data-key": "unsure"})), this.driveRow()];
  }

  doorsOf(id) {
    const {model} = this;
    const walls = plainWalls(model).filter((wall) => sidesOf(model, wall).includes(String(id)));
    const doors = Object.entries(this.model.tables.doors).filter(([, door]) => door.r && (door.a === Number(id) || door.b === Number(id)));
    if (!(doors.length || walls.length) || !this.may("drive")) return null;
    const was_open = this.card.querySelector("details")?.open && this.doorsOpenFor === id;
    const details = make("details", {}, make("summary", {}, t(walls.length ? "doors_and_walls" : "doors")));
    details.open = Boolean(was_open);
    details.addEventListener("toggle", () => { this.doorsOpenFor = id; });
    const list = make("ul", {class: "list"});
    for (const [number, door] of doors) {
      const other = door.a === Number(id) ? door.b : door.a;
      const wall = shutBy(model, door);
      const state = wall ? t("door_shut") : door.st === 2 ? t("door_closed") : "";
      list.append(make("li", {}, make("span", {class: "rest"}, t("door_to", {name: model.labelOf(other)}), state ? make("span", {class: `sub${wall ? " error" : ""}`}, state) : null),
        wall ? button(t("unshut"), () => this.actions.unwall(wall, t("unshut_done")), {"data-key": "open" + number})
          : button(t("shut"), () => this.ask("shut", {door: Number(number)}, t("shut_done")), {"data-key": "shut" + number})));
    }
    for (const wall of walls) {
      list.append(make("li", {}, make("span", {class: "rest"}, t(wall.v ? "virtual_wall" : "glass_wall")), button(t("unwall"), () => this.actions.unwall(wall, t("unwalled")), {"data-key": `wall${wall.ax}`})));
    }
    details.append(list);
    return details;
  }

  objectCard(id) {
    const each = this.model.tables.objects[id];
    if (!each) return null;
    const place = each.c ? this.model.placeAt(...each.c) : null;
    const where = place ? this.model.labelOf(place) : each.at ? plain(each.at.join(" ")) : "";
    const about = [where, ...each.p, t(each.c ? "thing_seen" : "thing_told")].filter(Boolean).join(" · ");
    // The robot finds it by the talk, and could take another one of the kind.
    const alike = Object.values(this.model.tables.objects).filter((other) => folded(other.k) === folded(each.k));
    const forget = this.may("talk") && isOneThing(each.k) && alike.length === 1 ? button(t("forget_thing"), () => {
      this.close();
      this.actions.openTalk(); // the answer comes there
      const at = place ? this.model.labelOf(place) : each.at?.[1];
      this.actions.say(t("forget_this", {name: each.k}), at && isOneThing(at) ? t("there_again", {name: each.k, place: at}) : "");
    }, {"data-key": "forget_thing"}) : null;
    return [make("h2", {id: "card-title"}, each.k), make("p", {}, about), forget ? make("div", {class: "row"}, forget) : null];
  }

  // ---- Names ----

  startNaming() {
    this.naming = true;
    this.typed = undefined; // kept when the form is made again, in another language
    this.showCard();
    this.card.querySelector("input").focus();
  }

  nameForm(id, name) {
    const input = make("input", {type: "text", maxlength: 80, id: "new-name", "data-key": "new-name", placeholder: t("examples"), autocomplete: "off", autocapitalize: "off", enterkeyhint: "done"});
    input.value = this.typed ?? (name.sure ? name.text : "");
    input.addEventListener("input", () => { this.typed = input.value; });
    const hint = make("p", {class: "hint"}); // its room is there before it is: nothing moves under the finger
    const hints = () => {
      const right = input.value.replace(/\p{L}+/gu, (word) => meant(word, this.model.values.names ?? []) || word);
      hint.replaceChildren(...(right === input.value ? [] : [t("did_you_mean") + " ", button(right, () => {
        input.value = this.typed = right;
        hints();
        input.focus();
      })]));
    };
    input.addEventListener("input", hints);
    const form = make("form", {class: "row", onsubmit: (event) => {
      event.preventDefault();
      // Not to the map when the form goes: the next Enter would open a card there.
      document.activeElement?.blur();
      if (input.value.trim()) this.rename(id, input.value.trim());
    }}, make("label", {for: "new-name", class: "unseen"}, t("name_label")), input, make("button", {type: "submit", class: "primary"}, t("save_name")),
    name.none ? null : button(t("forget_name"), () => this.name(id, [])),
    name.none || name.sure ? null : button(t("show_where", {name: name.text}), () => this.actions.pick(name.text)),
    button(t("cancel"), () => {
      this.naming = false;
      this.showCard();
    }));
    hints();
    return make("div", {}, form, hint);
  }

  // What is no name is asked about,
  rename(id, name) {
    this.naming = false;
    if (!isRatherSaid(name)) {
      this.move(id, name);
      return;
    }
    this.askSurely(t("name_doubted", {name}), "name_anyway", () => this.move(id, name));
    this.card.querySelector("[data-key=unsure]")?.focus(); // a second Enter makes it no name
  }

  // and one in use elsewhere, which would be gone there.
  move(id, name) {
    const holder = this.model.holderOf(name, id);
    if (holder === null) this.name(id, [name]);
    else this.askSurely(t("name_taken", {name, place: t("place_number", {n: holder})}), "move_name", () => this.name(id, [name]));
  }

  // The map and the talk show it: the card is done with.
  name(id, names) {
    this.close();
    this.ask("name", {place: Number(id), names}, "");
  }

  async ask(what, fields, done = undefined) {
    try {
      const result = await this.connection.ask(what, what === "here" ? fields : {language: currentLanguage(), ...fields});
      const answer = done ?? plain(result.message || "");
      if (answer) toast(answer);
    } catch (error) {
      toast(reasonOf(error), true);
    }
  }

  // ---- The list ----

  // What was looked for is over when another panel is opened.
  clearSearch() {
    if (!this.filter) return;
    this.filter = "";
    this.buildList();
  }

  buildList() {
    this.places = make("ul", {class: "list"});
    this.objects = make("ul", {class: "list"});
    const search = make("input", {type: "search", "aria-label": t("search_places"), placeholder: t("search_places"), class: "whole", maxlength: 80, value: this.filter});
    search.addEventListener("input", () => {
      this.filter = search.value;
      this.showList();
    });
    this.list.replaceChildren(search, this.places, make("h3", {}, t("objects")), this.objects);
    this.showList();
  }

  showList() {
    const {model} = this;
    const wanted = this.filter.trim().toLowerCase();
    const order = (id) => {
      const name = model.nameOf(id);
      return [name.none ? 1 : 0, name.text.toLowerCase()];
    };
    const ids = Object.keys(model.tables.places).filter((id) => !wanted || model.nameOf(id).text.toLowerCase().includes(wanted))
      .sort((a, b) => order(a)[0] - order(b)[0] || order(a)[1].localeCompare(order(b)[1], undefined, {numeric: true}));
    const objects = Object.entries(model.tables.objects).filter(([, each]) => !wanted || [each.k, ...(each.at ?? [])].some((word) => word.toLowerCase().includes(wanted)));
    const key = JSON.stringify([wanted, ids.map((id) => [id, model.labelOf(id), model.place(id).s, model.values.here?.place === Number(id)]), objects, document.documentElement.lang]);
    if (key === this.listKey && this.places.children.length) return;
    this.listKey = key;
    this.places.replaceChildren(...ids.map((id) => this.placeLine(id)));
    if (!ids.length) this.places.append(make("li", {class: "note"}, t(wanted ? "no_match" : "no_places")));
    this.objects.replaceChildren(...objects.map(([id, each]) => make("li", {}, button("", () => {
      if (each.c) this.actions.showOnMap(...each.c);
      this.show("object", id, true);
    }, {}), make("span", {class: "sub"}, t(each.c ? "seen" : "told")))));
    objects.forEach(([, each], i) => this.objects.children[i].firstChild.append(each.k, make("span", {class: "sub"}, plain([...(each.at ?? []), ...each.p].join(" ")))));
    if (!objects.length) this.objects.append(make("li", {class: "note"}, t(wanted ? "no_match" : "no_objects")));
  }

  placeLine(id) {
    const place = this.model.place(id);
    const name = this.model.nameOf(id);
    const about = [name.none ? t("no_name") : t("place_number", {n: id}), place.s ? `${Math.round(place.s)} m²` : "", this.model.values.here?.place === Number(id) ? t("robot_is_here") : ""];
    return make("li", {}, make("button", {type: "button", onclick: () => {
      if (place.c) this.actions.showOnMap(...place.c);
      this.show("place", id, true);
    }}, this.model.titleOf(id), make("span", {class: "sub"}, about.filter(Boolean).join(" · "))));
  }
}
