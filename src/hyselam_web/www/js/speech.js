// Hearing and speaking by the browser, where it can; the phone's own language.
import {currentLanguage} from "./i18n.js";
import {remembered, remember} from "./dom.js";

const Recognition = globalThis.SpeechRecognition ?? globalThis.webkitSpeechRecognition;

// "pt-BR" of a phone in Brazil, "pt-PT" where nothing is known.
function region() {
  const language = currentLanguage();
  const own = (navigator.languages ?? []).find((each) => each.slice(0, 2).toLowerCase() === language && each.length > 2);
  return own ?? (language === "pt" ? "pt-PT" : "en-US");
}

// Browsers give the microphone to pages of this machine and of https only.
export function canListen() {
  return Boolean(Recognition) && isSecureContext;
}

// What the browser says of its refusals, in the page's words.
const REFUSALS = {"not-allowed": "mic_refused", "service-not-allowed": "mic_service", network: "mic_service", "language-not-supported": "mic_service", "audio-capture": "mic_missing", "no-speech": "mic_nothing"};

// events: onText(text, final), onEnd(), onRefused(key of why). Returns how to end it.
export function listen(events) {
  if (!canListen()) {
    events.onRefused(Recognition ? "mic_insecure" : "mic_service");
    events.onEnd();
    return () => {};
  }
  const recognition = new Recognition();
  recognition.lang = region();
  recognition.interimResults = true;
  recognition.onresult = (event) => {
    const result = event.results[event.results.length - 1];
    events.onText(result[0].transcript, result.isFinal);
  };
  recognition.onerror = (event) => {
    if (event.error !== "aborted") events.onRefused(REFUSALS[event.error] ?? "mic_service");
  };
  recognition.onend = () => events.onEnd();
  recognition.start();
  return () => recognition.stop();
}

export function canSpeak() {
  return "speechSynthesis" in globalThis;
}

let aloud = remembered("speak") === "1";

export function speaksAloud() {
  return aloud && canSpeak();
}

export function setAloud(on) {
  aloud = on;
  remember("speak", on ? "1" : "0");
  if (!on && canSpeak()) speechSynthesis.cancel();
}

export function speak(text) {
  if (!speaksAloud()) return;
  const saying = new SpeechSynthesisUtterance(text);
  saying.lang = region();
  speechSynthesis.speak(saying);
}
