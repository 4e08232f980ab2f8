// What can be pressed next after an answer that leaves something open: a word that was meant, where a name belongs.
import {byId, make, button, toast} from "./dom.js";
import {t, onLanguage, currentLanguage} from "./i18n.js";
import {besides, called, corrected, isMany, isYes, placeOnly, told} from "./wording.js";
import {reasonOf} from "./talk.js";

const UNSURE = /^I think |^Acho que |not sure where|places fit|answers fit|have not found|certeza onde|respostas servem|servem muitos lugares|não encontrei/i;
const NOT_UNDERSTOOD = /^(I did not understand|I have not taken|Did you mean|I know of no|Não compreendi|Não anotei|Queria dizer|Não sei nada)/;
const NAME_SETTLED = /^(Thank you\. |Obrigad[oa]\. )/; // a name was settled
const TAKEN_DOWN = /^(Noted:|Anotado:)/;
const NO = /^(no|não|nao)\b/i;
const MAX_BUTTONS = 5;
const LONGEST = 200; // characters of a sentence that the server tries

export class NextStep {
  // actions: say(text), pick(name, places) lets a place be tapped, marked(places or null) marks places on the map
  constructor(model, connection, may, actions) {
    Object.assign(this, {model, connection, may, actions});
    this.box = byId("next");
    this.denied = null; // {name, place, at}: "no, that is not the kitchen", said in that entry of the talk
    this.dismissed = 0; // the entry of the talk whose next step nobody wants
    this.leftOpen = new Set(); // guesses, "name place", about which nobody wants to be asked
    this.key = "";
    this.tried = new Map(); // sentence: whether it would be understood
    model.on(["talk", "candidates", "places", "names", "asked"], () => this.show());
    onLanguage(() => this.show());
  }

  // Before a sentence is said: a "no" to "is this the kitchen?" leaves open where that is.
  heard(text) {
    const {asked} = this.model.values;
    const guess = asked?.place && this.model.place(asked.place) ? this.model.nameOf(asked.place) : null;
    const about_name = asked?.yes && guess && !guess.none && !guess.sure && asked.text.includes(guess.text);
    this.denied = about_name && NO.test(text) ? {name: guess.text, place: asked.place, after: this.newest()} : null;
    this.show();
  }

  // Nothing is offered that would not be understood; until that is known it is not offered.
  isUnderstood(sentence) {
    if (sentence.length > LONGEST) return false;
    if (!this.tried.has(sentence)) {
      this.tried.set(sentence, false);
      this.connection.ask("try", {text: told(sentence, this.model)}).then(({understood}) => {
        this.tried.set(sentence, understood === true);
        this.show();
      }, () => this.tried.delete(sentence));
    }
    return this.tried.get(sentence);
  }

  // What the robot is told where a place, or a yes, is all that is said to what is asked here: that this is the kitchen.
  answer(text) {
    const {kind, name, ids} = this.shown ?? {};
    if (!name || /["“”«»]/.test(name)) return text;
    const more = besides(text);
    const place = kind === "guess" && isYes(text) ? this.model.place(ids[0]) : placeOnly(more?.first ?? text, this.model);
    if (!place) {
      // "Yes, the toilet is number 2": where the robot did not ask for a yes.
      if (this.model.values.asked?.yes) return text;
      const bare = text.replace(/^\s*(yes|yeah|sim)\b[\s,.!]*/i, "");
      return told(bare, this.model) === bare ? text : bare;
    }
    const portuguese = /[ãõçêôáíóúéà]|\b(lugar|fica|na|no|numero|sim)\b/i.test(text) || (currentLanguage() === "pt" && !/\b(it|is|the|in|at|yes)\b/i.test(text));
    const settled = `${place.e} ${portuguese ? "é" : "is"} "${name}".`;
    return more ? `${settled} ${place.e} ${portuguese ? "fica" : "is"} ${more.rest}.` : settled;
  }

  newest() {
    const {talk} = this.model;
    return talk.length ? talk[talk.length - 1].i : 0;
  }

  // Somebody has said where it is; that it may be elsewhere, too, is nothing to ask about.
  isPlaced(name) {
    return Object.keys(this.model.tables.places).some((id) => this.model.confirmedNames(id).includes(name));
  }

  // Where a name may be: of the dialogue's candidates those that are there, have no other confirmed name and were not denied.
  places(name, but = 0) {
    const {pose} = this.model.values;
    const far = (id) => (pose && this.model.place(id).c ? Math.hypot(this.model.place(id).c[0] - pose.x, this.model.place(id).c[1] - pose.y) : 0);
    return (this.model.values.candidates?.[name] ?? []).filter((id) => id !== but && this.model.place(id) && !this.model.nameOf(id).sure)
      .sort((a, b) => far(a) - far(b) || a - b);
  }

  // {kind, at, ...} or null.
  step() {
    if (!this.may("talk") || this.connection.replays) return null;
    const {talk} = this.model;
    let last = talk.map((entry) => entry.w).lastIndexOf("human");
    let answers = talk.slice(last + 1).filter((entry) => entry.w === "robot");
    const at = this.newest();
    // With the answer, so that nothing moves under the finger once it is there.
    const denies = this.denied && last >= 0 && talk[last].i > this.denied.after && NO.test(talk[last].s);
    if (denies && answers.length) {
      return {kind: "denied", at: this.denied.after + 1, name: this.denied.name, ids: this.places(this.denied.name, this.denied.place)};
    }
    if (last < 0 || !answers.length) return null;
    if (!answers.some((entry) => TAKEN_DOWN.test(entry.s))) {
      const doubted = (word) => answers.some((entry) => entry.s.toLowerCase().includes(word.toLowerCase()));
      const right = corrected(talk[last].s, this.model.values.names ?? [], doubted);
      if (right && this.isUnderstood(right)) return {kind: "meant", at: talk[last].i, right, ids: []};
    }
    // An answer that is not understood leaves open what was.
    while (answers.length && answers.every((entry) => NOT_UNDERSTOOD.test(entry.s)) && !answers.some((entry) => UNSURE.test(entry.s))) {
      const before = talk.slice(0, last).map((entry) => entry.w).lastIndexOf("human");
      if (before < 0) break;
      answers = talk.slice(before + 1, last).filter((entry) => entry.w === "robot");
      last = before;
    }
    if (this.model.values.asked?.yes) return null; // one question at a time
    const unsure = answers.some((entry) => UNSURE.test(entry.s));
    const name = unsure && Object.keys(this.model.values.candidates ?? {}).find((each) => this.places(each).length > 0 && !this.isPlaced(each));
    if (name) return {kind: "unsure", at: talk[last].i, name, ids: this.places(name)};
    return unsure || answers.some((entry) => NAME_SETTLED.test(entry.s)) ? this.guess(talk[last].i) : null;
  }

  // A name that is still a guess on the map when another one was settled.
  guess(at) {
    for (const id of Object.keys(this.model.tables.places).map(Number)) {
      const {text, sure, none} = this.model.nameOf(id);
      if (!sure && !none && !this.isPlaced(text) && !this.leftOpen.has(`${text} ${id}`)) return {kind: "guess", at, name: text, ids: [id]};
    }
    return null;
  }

  show() {
    const step = this.step();
    const wanted = step && step.at > this.dismissed ? step : null;
    // Where a yes or a no is asked for, it is among what can be said instead.
    const offered = wanted?.kind === "meant" && this.model.values.asked?.yes ? wanted.right : null;
    const shown = offered ? null : wanted;
    if (offered !== (this.model.offered ?? null)) {
      this.model.offered = offered;
      this.model.tell(["offered"]);
    }
    const key = JSON.stringify([shown, shown?.ids.map((id) => this.model.labelOf(id)), document.documentElement.lang]);
    if (key === this.key) return;
    this.key = key;
    this.shown = shown;
    this.box.hidden = !shown;
    this.box.replaceChildren(...(shown ? this.parts(shown) : []));
    this.actions.marked(shown?.name ? {name: shown.name, ids: shown.ids} : null);
  }

  parts(step) {
    const row = make("div", {class: "row"});
    const close = button("×", () => this.dismiss(step.at), {class: "close", "aria-label": t("not_now"), title: t("not_now")});
    if (step.kind === "meant") {
      row.append(button(step.right, () => this.actions.say(step.right), {class: "primary", "data-settles": `say ${step.right}`}));
      return [make("p", {}, t("did_you_mean")), row, close];
    }
    const titleOf = (id) => (step.kind === "guess" ? t("right_place", {place: t("place_number", {n: id})}) : this.titleOf(id, step.name));
    for (const id of step.ids.slice(0, MAX_BUTTONS)) row.append(button(titleOf(id), () => this.give(id, step.name), {"data-place": id}));
    row.append(button(t(step.ids.length ? "other_place" : "tap_place"), () => this.actions.pick(step.name, step.ids), {class: "pick"}));
    const key = step.kind === "denied" ? (isMany(step.name) ? "where_are_then" : "where_then") : isMany(step.name) ? "where_are_they" : "where_is_it";
    if (step.kind === "guess") return [make("p", {}, t("is_it", {n: step.ids[0], name: called(step.name)})), row, close];
    return [make("p", {}, t(key, {name: called(step.name)})), row, close];
  }

  // By its number, as on the map; what else it may be, too.
  titleOf(id, name) {
    const guess = this.model.nameOf(id);
    return t("place_of", {n: id}) + (guess.none || guess.text === name ? "" : ` (${this.model.labelOf(id)})`);
  }

  dismiss(at) {
    if (this.shown?.kind === "guess") this.leftOpen.add(`${this.shown.name} ${this.shown.ids[0]}`);
    this.dismissed = Math.max(at, this.newest());
    this.denied = null;
    this.show();
  }

  // A person says that a place has this name; those that others have confirmed stay.
  async give(id, name) {
    const names = [...this.model.confirmedNames(id).filter((each) => each !== name), name];
    try {
      await this.connection.ask("name", {place: Number(id), names, language: currentLanguage()});
      if (this.denied?.name === name) this.denied = null;
    } catch (error) {
      toast(reasonOf(error), true);
    }
    this.show();
  }
}
