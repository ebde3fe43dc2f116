"use strict";
const es = navigator.language.toLowerCase().startsWith("es");
const T = es ? {
  go: "Jugar", invite: "Pulsa para jugar. Luego muestra el cubo a la cámara.", window: "Pulsa para ver y oír.",
  games: "¿A qué jugamos?", again: "Empezar de nuevo", photo: "Guardar una foto", turn: "La otra cámara",
  sound: "Sonido", record: "Grabar", mark: "Marcar este momento", picture: "Imagen de la cámara con el personaje",
  code: ["Escanea el código otra vez", "Este enlace ya no abre la puerta. El código nuevo está en el ordenador."],
  lost: ["Buscando el ordenador…", "Sigue por sí solo en cuanto haya conexión."],
  denied: ["¿Puedo usar la cámara?", "Permite la cámara en el navegador: toca el candado junto a la dirección."],
  gone: ["No hay cámara", "¿La usa otro programa? Ciérralo y toca la flecha."],
  insecure: ["La cámara necesita una dirección segura", "Abre la dirección https:// o http://localhost que muestra el ordenador."],
  other: "Otro teléfono es la cámara", full: ["Hay demasiadas páginas abiertas", "Cierra una de ellas."],
  about: {follow: "El personaje sigue al cubo", sketch: "El cubo dibuja un camino", companion: "Vleo besa o grita", reach: "El personaje alcanza el cubo"}
} : {
  go: "Play", invite: "Tap to play. Then show the cube to the camera.", window: "Tap to see and hear.",
  games: "What would you like to play?", again: "Start over", photo: "Keep a picture", turn: "The other camera",
  sound: "Sound", record: "Record", mark: "Mark this moment", picture: "The camera's picture with the character",
  code: ["Scan the code again", "This link no longer opens the door. The new code is on the computer."],
  lost: ["Looking for the computer …", "It goes on by itself."],
  denied: ["May I use the camera?", "Allow the camera in the browser: tap the lock beside the address."],
  gone: ["There is no camera", "Does another program use it? Close that, and tap the arrow."],
  insecure: ["The camera needs a safe address", "Open the address with https:// or http://localhost that the computer shows."],
  other: "Another phone is the camera", full: ["Too many pages are open", "Close one of them."], about: {}
};
const $ = id => document.getElementById(id), now = () => performance.now() / 1000;
const query = new URLSearchParams(location.search), token = location.hash.slice(1);
const role = {"/view": "view", "/window": "window", "/camera": "camera"}[location.pathname] || "play";
const random = n => Array.from(crypto.getRandomValues(new Uint8Array(n)), b => "abcdefghijklmnopqrstuvwxyz234567"[b & 31]).join("");
const clear = query.get("background") === "none";
// A store may be forbidden, as in a private window.
const store = (kind, key, make) => { try { return window[kind][key] ||= make(); } catch { return make(); } };
let page = store("sessionStorage", "page", () => random(16));
const device = store("localStorage", "camera", () => random(8));
const MAX_SIDE = Math.min(+query.get("size") || 1280, 1920), IN_FLIGHT = 2, SILENT_S = 2, TRY_S = 1.5;

/* The connection: each message or tick shows that it is alive; a silent one is opened again. */
let socket, heard = 0, opened = 0, failures = 0, welcome, playing = role === "view", tiles = {};
function connect() {
  const old = socket;
  if (old) { old.onmessage = old.onclose = null; old.close(); }
  inFlight.clear();
  opened = heard = now();
  const s = socket = new WebSocket(`${location.protocol === "https:" ? "wss" : "ws"}://${location.host}/socket?role=${role}&page=${page}${clear ? "&background=none" : ""}`, ["cubeling", token || "none"]);
  s.binaryType = "arraybuffer";
  s.onmessage = e => { heard = now(); typeof e.data === "string" ? told(JSON.parse(e.data)) : got(e.data); };
  s.onclose = e => {
    if (e.reason === "this page is connected again") page = random(16); // a copy of this tab
    failures++;
    if (failures > 2) find();
    setTimeout(() => s === socket && connect(), 400);
  };
}
async function find() {
  let answer;
  try { answer = await fetch("/", {method: "GET", cache: "no-store"}); } catch { }
  if (failures > 2) trouble(answer?.ok ? "code" : "lost");
}
setInterval(() => {
  const waiting = socket?.readyState === 0;
  if (now() - (waiting ? opened : heard) > (waiting ? TRY_S : SILENT_S)) { failures++; if (failures > 2) find(); connect(); }
  else say({do: "tick"});
}, 500);
const say = message => socket?.readyState === 1 && socket.send(JSON.stringify(message));

const HEARD = {
  welcome(m) {
    welcome = m; failures = 0;
    trouble("lost", false); trouble("code", false);
    if (!playing) $("start").hidden = false;
    offer();
  },
  tick(m) { if (m.camera === "other" && sends()) { $("delay").textContent = T.other; offer(); } },
  got(m) { inFlight.delete(m.id); },
  words(m) { toast(m.words); },
  status(m) {
    if (!m.scenario) return;
    scenario = m.scenario;
    for (const b of document.querySelectorAll("#games button")) b.classList.toggle("on", b.dataset.name === scenario);
    const rec = m.recording != null;
    $("bar").querySelector(".record")?.classList.toggle("on", rec);
    const mark = $("bar").querySelector(".mark"); if (mark) mark.hidden = !rec;
    if (m.notice && !sends()) toast(m.notice.join(". "));
    $("picture").setAttribute("aria-label", `${T.picture}: ${scenario}`);
    cover();
  }
};
const told = m => HEARD[m.do]?.(m);
let scenario = "";

/* Pictures down: the newest is drawn, and the server is told so. */
let shown = 0; const delays = [];
async function got(data) {
  const view = new DataView(data), kind = view.getUint8(0), id = view.getUint32(4, true), taken = view.getFloat64(8, true), body = data.slice(16);
  if (kind === 2) return hear(body);
  if (kind === 3) { tiles[id] = URL.createObjectURL(new Blob([body], {type: "image/jpeg"})); return list(); }
  let bitmap;
  try { bitmap = await createImageBitmap(new Blob([body])); } catch { }
  if (bitmap && id > shown - 1e6) {
    const c = $("picture");
    if (c.width !== bitmap.width || c.height !== bitmap.height) [c.width, c.height] = [bitmap.width, bitmap.height];
    const g = c.getContext("2d");
    if (clear) g.clearRect(0, 0, c.width, c.height);
    g.drawImage(bitmap, 0, 0); bitmap.close(); shown = id;
    if (taken) {
      delays.push(now() - taken); if (delays.length > 31) delays.shift();
      $("delay").textContent = `${Math.round(1000 * [...delays].sort((a, b) => a - b)[delays.length >> 1])} ms`;
    }
    window.onpicture?.(id, taken);
  }
  say({do: "shown", id});
}

/* The camera up: the newest frame, at most two on their way. */
// A canvas of the page encodes when the page is idle; one that is not of it does so at once.
const video = $("camera"), grab = window.OffscreenCanvas ? new OffscreenCanvas(2, 2) : document.createElement("canvas"), inFlight = new Map();
let stream, facing = store("localStorage", "facing", () => "environment"), encoding = false, number = 0;
const sends = () => welcome?.camera && (role === "play" || role === "camera");
async function camera() {
  if (!sends()) return;
  if (!navigator.mediaDevices) return trouble("insecure");
  stream?.getTracks().forEach(t => { t.onended = null; t.stop(); });
  try {
    stream = await navigator.mediaDevices.getUserMedia({audio: false, video: {facingMode: {ideal: facing}, width: {ideal: 1280}, height: {ideal: 720}, frameRate: {ideal: 30}}});
  } catch (e) { return trouble(e.name === "NotAllowedError" ? "denied" : "gone"); }
  for (const name of ["denied", "gone"]) trouble(name, false);
  const track = stream.getVideoTracks()[0];
  track.onended = () => trouble("gone");
  facing = track.getSettings().facingMode || (navigator.maxTouchPoints ? facing : "user");
  video.srcObject = stream;
  await video.play().catch(() => { });
  offer();
}
function offer() {
  if (!stream || !sends()) return;
  say({do: "camera", name: `${device}-${facing === "user" ? "front" : "back"}`});
  say({do: "mirror", on: facing === "user"});
}
function frame(time, meta) {
  next();
  const w = video.videoWidth, h = video.videoHeight;
  if (!w || encoding || socket?.readyState !== 1 || inFlight.size >= IN_FLIGHT) return;
  const scale = Math.min(1, MAX_SIDE / Math.max(w, h)), taken = (meta?.captureTime || time) / 1000;
  const size = [Math.round(w * scale / 2) * 2, Math.round(h * scale / 2) * 2];
  if (grab.width !== size[0] || grab.height !== size[1]) [grab.width, grab.height] = size;
  grab.getContext("2d", {alpha: false}).drawImage(video, 0, 0, ...size);
  encoding = true;
  const jpeg = {type: "image/jpeg", quality: .85};
  (grab.convertToBlob ? grab.convertToBlob(jpeg) : new Promise(done => grab.toBlob(done, jpeg.type, jpeg.quality))).catch(() => { }).then(blob => {
    encoding = false;
    if (!blob || socket?.readyState !== 1) return;
    const head = new DataView(new ArrayBuffer(16));
    head.setUint8(0, 1); head.setUint32(4, ++number, true); head.setFloat64(8, taken, true);
    inFlight.set(number, now());
    socket.send(new Blob([head.buffer, blob]));
  });
}
const next = () => video.requestVideoFrameCallback ? video.requestVideoFrameCallback(frame) : requestAnimationFrame(t => frame(t));
next();
document.addEventListener("visibilitychange", () => {
  if (document.hidden || !playing) return;
  heard = Math.min(heard, now() - SILENT_S / 2);
  if (stream?.getVideoTracks()[0].readyState === "ended") camera(); else video.play().catch(() => { });
  awake();
});
navigator.mediaDevices?.addEventListener?.("devicechange", () => playing && !$("trouble").hidden && camera());
const awake = () => navigator.wakeLock?.request("screen").catch(() => { });

/* Sound: blocks are played one after the other, a little later than they come. */
let audio, mute = false, due = 0;
function hear(body) {
  if (!audio || mute || audio.state !== "running") return;
  const pcm = new Int16Array(body), count = pcm.length / 2, buffer = audio.createBuffer(2, count, welcome.rate);
  for (const side of [0, 1]) { const to = buffer.getChannelData(side); for (let i = 0; i < count; i++) to[i] = pcm[2 * i + side] / 32768; }
  const t = audio.currentTime;
  if (due < t + .01 || due > t + .3) due = t + .06;
  const source = audio.createBufferSource(); source.buffer = buffer; source.connect(audio.destination); source.start(due);
  due += buffer.duration;
}

/* What is touched. */
const icon = name => `<svg aria-hidden="true"><use href="#i-${name}"/></svg>`;
const BUTTONS = {
  games: () => { list(); $("games").showModal(); }, again: () => { say({do: "again"}); toast(T.again); },
  photo: () => say({do: "snapshot"}), turn: () => { facing = facing === "user" ? "environment" : "user"; try { localStorage.facing = facing; } catch { } camera(); },
  sound: b => { mute = !mute; b.innerHTML = icon(mute ? "silent" : "sound"); b.setAttribute("aria-pressed", !mute); },
  record: () => say({do: "record"}), mark: () => say({do: "mark"})
};
for (const [name, act] of Object.entries(BUTTONS)) {
  const b = document.createElement("button");
  b.className = name; b.innerHTML = icon(name); b.setAttribute("aria-label", T[name]); b.title = T[name];
  if (name === "sound") b.setAttribute("aria-pressed", true);
  if (name === "mark" || (name === "turn" && role === "window")) b.hidden = true;
  b.onclick = () => act(b); $("bar").append(b);
}
function list() {
  const box = $("games").lastElementChild;
  $("games").firstElementChild.textContent = T.games;
  box.replaceChildren(...(welcome?.scenarios || []).map((s, i) => {
    const b = document.createElement("button"), img = new Image(), span = document.createElement("span");
    b.dataset.name = s.name; b.classList.toggle("on", s.name === scenario);
    b.setAttribute("aria-label", `${s.name}: ${T.about[s.name] || s.summary}`);
    img.alt = ""; if (tiles[i]) img.src = tiles[i];
    span.textContent = s.name; b.append(img, span);
    b.onclick = () => { say({do: "play", name: s.name}); $("games").close(); };
    return b;
  }));
  cover();
}
function cover() {
  const place = Math.max((welcome?.scenarios || []).findIndex(s => s.name === (scenario || "companion")), 0);
  if (tiles[place]) $("shot").style.backgroundImage = `url(${tiles[place]})`;
}
$("games").onclick = e => e.target === $("games") && $("games").close();
$("go").setAttribute("aria-label", T.go);
$("invitation").textContent = role === "window" ? T.window : T.invite;
$("go").onclick = () => {
  playing = true;
  $("start").hidden = true; $("bar").hidden = role === "camera";
  try { audio ||= new AudioContext(); audio.resume(); } catch { }
  awake(); camera();
};
$("retry").onclick = () => { connect(); if (playing) camera(); };
const troubles = new Set();
function trouble(name, there = true) {
  there ? troubles.add(name) : troubles.delete(name);
  const first = ["code", "insecure", "denied", "gone", "lost"].find(n => troubles.has(n)), box = $("trouble");
  box.hidden = !first || role === "view";
  if (!first) return;
  box.querySelector("use").setAttribute("href", `#i-${{code: "code", lost: "wait"}[first] || "nocamera"}`);
  [box.querySelector("h2").textContent, box.querySelector("p").textContent] = T[first];
}
let silent;
function toast(words) {
  $("words").textContent = words; $("words").classList.add("on");
  clearTimeout(silent); silent = setTimeout(() => $("words").classList.remove("on"), 3000);
}
document.documentElement.lang = es ? "es" : "en";
$("picture").setAttribute("aria-label", T.picture);
document.body.classList.toggle("clear", clear);
if (role === "view") $("delay").hidden = true;
connect();
