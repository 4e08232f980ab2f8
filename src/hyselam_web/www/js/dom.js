// Elements are made with text nodes only: whatever people or robots say never becomes HTML.

export function byId(id) {
  return document.getElementById(id);
}

export function make(tag, properties = {}, ...children) {
  const element = document.createElement(tag);
  for (const [name, value] of Object.entries(properties)) {
    if (name === "class") element.className = value;
    else if (name.startsWith("on")) element.addEventListener(name.slice(2), value);
    else if (typeof value === "boolean" && name in element) element[name] = value;
    else if (value !== null && value !== undefined) element.setAttribute(name, value);
  }
  element.append(...children.filter((child) => child !== null && child !== undefined));
  return element;
}

export function button(text, onclick, properties = {}) {
  return make("button", {type: "button", onclick, ...properties}, text);
}

let toastTimer = 0;
// With [word, what it does], a button to take back what was done.
export function toast(text, bad = false, action = null) {
  const box = byId("toast");
  const hide = () => { box.hidden = true; };
  box.replaceChildren(text, ...(action ? [button(action[0], () => {
    hide();
    action[1]();
  })] : []));
  box.classList.toggle("bad", bad);
  box.hidden = false;
  clearTimeout(toastTimer);
  toastTimer = setTimeout(hide, bad || action ? 7000 : 3500);
}

// What was chosen before, on this device; private windows may forbid it.
export function remembered(key) {
  try {
    return localStorage.getItem("hyselam." + key);
  } catch {
    return null;
  }
}

export function remember(key, value) {
  try {
    localStorage.setItem("hyselam." + key, value);
  } catch { /* then it is chosen again next time */ }
}
