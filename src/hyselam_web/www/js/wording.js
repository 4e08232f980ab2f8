// What the robot says and hears, in words for people: places by their numbers instead of the map's own names (SS05), and slips of the pen.
import {currentLanguage, t} from "./i18n.js";

const CODE = /\b(?:SS|CC|VV)0*(\d+)\b/g;
const PORTUGUESE = /[ãõçêôáíóúéà]|\b(?:estou|vou|para|lugar|lado|nome|obrigad[oa]|sim|não|qual|onde|isso|vá|há)\b/i;
const ENGLISH = /\b(?:the|is|am|are|of|to|you|this|what|where|name|noted|place|next|yes|no)\b/i;
// "place 5" as it is said; in Portuguese with the article, which goes.
const SAID = /\b(?:(?:the )?place(?: number)?|(?:(n|d|a)?o )?lugar(?: n[uú]mero)?) 0*(\d{1,6})\b/gi;
// "Number 5 is the library", "o 5 é a biblioteca", "... and number 7 the kitchen": what is said of it is its name, not where it lies.
const NAMED = new RegExp("(^\\s*|[.!?;]\\s*|\\s*,?\\s+(?:and|e)\\s+)" +
  "((?:the |o |a )?(?:place|room|number|no\\.?|lugar|sala|n[uú]mero|n\\.º)(?: number| n[uú]mero)? |[oa] )?0*(\\d{1,6})" +
  "(\\s+(?:is|é|chama-se|se chama)\\s+|\\s+)(?=(?:called |named )?(?:(?:the|my|our|a|o|as|os)\\s+|\\p{L}+['’]s\\s)" +
  "(?!(?:first|second|third|last|next|only|big|small|large|primeir|segund|terceir|últim|maior|room\\b|sala\\b(?!\\s+d)|one\\b))" +
  "(?![^.!?;]*\\b(?:left|right|opposite|beside|between|behind|next to|esquerda|direita|frente|entre|atrás|lado)\\b))", "giu");
const CONTRACTED = {n: "em ", d: "de ", a: "a "}; // no, do, ao
const MIN_KIND = 5; // letters of a word that may be meant for a usual kind of place; shorter ones are like too many others
const MIN_NAME = 4; // for a name that the robot knows
const TWO_SLIPS = 8; // letters of a word in which two slips are understood

function languageOf(text) {
  const [portuguese, english] = [PORTUGUESE.test(text), ENGLISH.test(text)];
  return portuguese === english ? currentLanguage() : portuguese ? "pt" : "en";
}

// A name within an English sentence: "the kitchen", but "room A", "Ana's office". The gender of Portuguese ones is not known.
export function called(name) {
  return currentLanguage() === "en" && /^\p{Ll}[\p{Ll} -]*$/u.test(name) && !/^(the|my|our) /.test(name) ? `the ${name}` : name;
}

// "Toilets", "as casas de banho"; not "class", "campus", "Ana's".
export function isMany(name) {
  const word = name.trim().split(" ")[currentLanguage() === "en" ? name.trim().split(" ").length - 1 : 0];
  return /^\p{Ll}{3,}$/u.test(word) && /[^isu]s$/.test(word);
}

// A sentence as it is shown: "Go to place 5."
export function plain(text) {
  const language = languageOf(text);
  return text.replace(CODE, (_, number, at) => {
    const begins = at === 0 || /[.!?:]["'“]?\s*$/.test(text.slice(0, at));
    return t(begins ? "place_of" : "place_number", {n: number}, language);
  });
}

// "place seven", as it is heard; behind such a word only.
const NUMBERS = {en: "one two three four five six seven eight nine ten eleven twelve thirteen fourteen fifteen sixteen seventeen eighteen nineteen twenty".split(" "),
  pt: "um dois três quatro cinco seis sete oito nove dez onze doze treze catorze quinze dezasseis dezassete dezoito dezanove vinte".split(" ")};
const SPELT = new RegExp(`\\b(place|number|lugar|n[uú]mero) (${[...NUMBERS.en, ...NUMBERS.pt].join("|")})(?![\\p{L}])`, "giu");
// "The kitchen is place 7", "a cozinha fica no lugar 7": all that the sentence says.
const AT_NUMBER = /^\s*((?:the|my|our|a|o|as|os)\s+)?([^.!?;:,"“”«»\d]{2,60}?)\s+(is|são|é|fica|está)\s+(?:(?:in|at|em|o|a|no|na|the)\s+)?((?:place|room|number|lugar|sala|n[uú]mero)(?:\s+(?:number|n[uú]mero))?\s+0*(\d{1,6}))\s*[.!]?\s*$/iu;
const NO_NAME = /^(?:it|this|that|here|there|where|what|isto|isso|aqui|ali|onde|qual|ela|ele)\b|\b(?:not|não|nao|and|e|or|ou|between|entre|next|opposite)\b/iu;

// A sentence as the robot is told it: its map knows no "place 5", but SS05.
export function told(sentence, model) {
  const names = (model.values.names ?? []).map((name) => name.toLowerCase());
  let named = false; // one before it
  sentence = sentence.replace(SPELT, (_, before, word) => `${before} ${1 + Math.max(NUMBERS.en.indexOf(word.toLowerCase()), NUMBERS.pt.indexOf(word.toLowerCase()))}`);
  const [, , name, verb, whole, at] = sentence.match(AT_NUMBER) ?? [];
  if (name && model.place(Number(at)) && !NO_NAME.test(name) && !names.includes(whole.toLowerCase())) return `${model.place(Number(at)).e} ${verb.toLowerCase() === "is" ? "is" : "é"} "${name.trim()}".`;
  const text = sentence.replace(NAMED, (whole, before, what, number, verb) => {
    const [said, place] = [whole.slice(before.length, whole.length - verb.length).trim().toLowerCase(), model.place(Number(number))];
    const is_and = /^(and|e)\s/i.test(before.trim() + " ");
    if (!place || names.includes(said)) return whole; // one that people call so
    if (verb.trim() === "") return is_and && named ? `. ${place.e} ${/\sis\s/i.test(sentence) ? "is" : "é"} ` : whole;
    named = true;
    return (is_and ? ". " : before) + place.e + verb;
  });
  return text.replace(SAID, (whole, contracted, number) => {
    const place = names.some((name) => whole.toLowerCase().endsWith(name)) ? null : model.place(Number(number));
    return place ? (CONTRACTED[contracted?.toLowerCase()] ?? "") + place.e : whole;
  });
}

// Words around the place in "It's the first one, place 6", "Acho que é no lugar 7".
const AROUND = new RegExp("^(it|its|that|thats|this|here|is|s|in|at|the|a|o|as|so|i|think|guess|believe|one|place|number|no|door|room|on|left|right|side|yes|ok|well|e|que|isso|ali|aqui|acho|penso|creio|" +
  "fica|esta|na|em|lugar|numero|porta|sala|sim|bem|do|da|lado|big|bigger|biggest|large|larger|largest|small|smaller|smallest|long|narrow|wide|middle|other|next|grande|maior|pequeno|pequena|menor|comprid[oa]|estreit[oa]|larg[oa]|meio|outr[oa]|seguinte|esquerda|esquerdo|direita|direito|first|second|third|fourth|fifth|sixth|last|primeir[ao]|segund[ao]|terceir[ao]|quart[ao]|quint[ao]|sext[ao]|ultim[ao])$");

// The place that is all that a sentence names, and only by its number; null: there is none, or more is said.
export function placeOnly(sentence, model) {
  const words = folded(sentence).replace(/\b(ss|cc|vv)0*(\d+)\b/g, "$2").match(/[\p{L}\p{N}]+/gu) ?? [];
  const numbers = words.filter((word) => /^\d+$/.test(word));
  return numbers.length === 1 && words.every((word) => word === numbers[0] || AROUND.test(word)) ? model.place(Number(numbers[0])) ?? null : null;
}

// "Yes", "yeah, that's right", "sim, é isso": a yes, and nothing else.
const YES = /^(yes|yeah|yep|yup|sure|correct|exactly|right|sim|certo|claro|exato|exatamente|pois|mesmo)$/;
const WITH_YES = /^(that|thats|it|its|this|is|s|so|of|course|please|e|isso|esta|que|ok|okay)$/;
export function isYes(sentence) {
  if (sentence.includes("?")) return false;
  const words = folded(sentence).match(/[\p{L}\p{N}]+/gu) ?? [];
  return words.some((word) => YES.test(word)) && words.every((word) => YES.test(word) || WITH_YES.test(word));
}

// "It is place 7, between the lab and the office": what is told besides the number.
const BESIDES = /^((?:[^,;.!?]|\.(?=\d))+)[,;.]\s*((?:between|next to|opposite|across from|beside|behind|entre|ao lado d[aeo]|em frente|atrás d[aeo]|junto a[os]?)(?![\p{L}]).+?)\s*[.!]?\s*$/iu;
export function besides(sentence) {
  const [, first, rest] = sentence.match(BESIDES) ?? [];
  return rest ? {first, rest} : null;
}

export function folded(word) {
  return word.normalize("NFD").replace(/\p{M}/gu, "").toLowerCase();
}

// Letters to be changed, added, left out or exchanged with their neighbours.
export function slips(a, b) {
  let [before, last] = [[], Array.from({length: b.length + 1}, (_, j) => j)];
  for (let i = 1; i <= a.length; ++i) {
    const row = [i];
    for (let j = 1; j <= b.length; ++j) {
      row[j] = Math.min(last[j] + 1, row[j - 1] + 1, last[j - 1] + (a[i - 1] === b[j - 1] ? 0 : 1));
      if (i > 1 && j > 1 && a[i - 1] === b[j - 2] && a[i - 2] === b[j - 1]) row[j] = Math.min(row[j], before[j - 2] + 1);
    }
    [before, last] = [last, row];
  }
  return last[b.length];
}

function wordsOf(text) {
  return text.match(/\p{L}+/gu) ?? [];
}

export function kinds() {
  return [...t("kinds", {}, "en").split(", "), ...t("kinds", {}, "pt").split(", ")];
}

// The word that was meant by one that is none: of a name that the robot knows, or of a usual kind of place; "": it is one, or like none.
export function meant(word, names) {
  const [wrong, known] = [folded(word), names.flatMap(wordsOf)];
  let [best, distance] = ["", Infinity];
  for (const [least, each] of [...known.map((one) => [MIN_NAME, one]), ...kinds().flatMap(wordsOf).map((one) => [MIN_KIND, one])]) {
    const right = folded(each);
    if (right === wrong) return "";
    const allowed = wrong.length < least || right.length < least ? 0 : Math.min(wrong.length, right.length) < TWO_SLIPS ? 1 : 2;
    const far = Math.abs(right.length - wrong.length) > 2 ? Infinity : slips(wrong, right);
    if (far <= allowed && far < distance) [best, distance] = [each, far];
  }
  return best;
}

// A sentence with the words that were meant; "": nothing is to be changed. `doubted` says which words of it are looked at.
export function corrected(sentence, names, doubted = () => true) {
  let changed = false;
  const right = sentence.replace(/\p{L}+/gu, (word) => {
    const better = doubted(word) ? meant(word, names) : "";
    changed ||= better !== "";
    return better || word;
  });
  return changed ? right : "";
}
