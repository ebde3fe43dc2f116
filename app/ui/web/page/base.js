"use strict";
/* What every page needs: its parts, its address, a store, and words that pass. */
const $ = id => document.getElementById(id);
const now = () => performance.now() / 1000;
const query = new URLSearchParams(location.search), token = location.hash.slice(1) || "none";
const icon = name => `<svg viewBox="0 0 24 24" aria-hidden="true"><use href="#i-${name}"/></svg>`;
const ask = (path, more) => fetch(path, {cache: "no-store", headers: {Authorization: `Bearer ${token}`}, ...more});

function random(length) {
  const bytes = crypto.getRandomValues(new Uint8Array(length));
  return Array.from(bytes, byte => "abcdefghijklmnopqrstuvwxyz234567"[byte & 31]).join("");
}

// A store may be forbidden, as in a private window.
function stored(kind, key, make) {
  try { return window[kind][key] ||= make(); } catch { return make(); }
}

function button(name, label, act, parent) {
  const made = document.createElement("button");
  made.className = name;
  made.innerHTML = icon(name);
  made.title = label;
  made.setAttribute("aria-label", label);
  made.onclick = () => act(made);
  parent.append(made);
  return made;
}

let silent;
function toast(words) {
  $("words").textContent = words;
  $("words").classList.add("on");
  clearTimeout(silent);
  silent = setTimeout(() => $("words").classList.remove("on"), 3000);
}
addEventListener("hashchange", () => location.reload()); // a new link in the same tab
