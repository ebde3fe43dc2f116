/* What those who play and those who are asked touch, and what is said of it. */
let playing = stored("sessionStorage", "playing", () => "") !== "", muted = false;
const icon = name => `<svg viewBox="0 0 24 24" aria-hidden="true"><use href="#i-${name}"/></svg>`;

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

const bar = {};
function addButtons(acts) {
  for (const [name, act] of Object.entries(acts)) bar[name] = button(name, T[name], act, $("bar"));
}

function toggleSound(pressed) {
  mute(muted = !muted);
  pressed.innerHTML = icon(muted ? "silent" : "sound");
  pressed.setAttribute("aria-pressed", !muted);
}
document.addEventListener("click", () => playing && openSound()); // browsers want a touch first

let silent;
function put(id, {words, language}) {
  if ($(id).textContent !== words) $(id).textContent = words;
  $(id).lang = language;
}
HEARD.words = ({said}) => {
  put("words", said);
  $("words").classList.add("on");
  clearTimeout(silent);
  silent = setTimeout(() => $("words").classList.remove("on"), 3000);
};

/* What is seen follows from what is known: each part of the page shows its own. */
const elsewhere = () => place === "other" && welcome?.camera && !taking;
const isScreen = () => !hasCamera() || (role === "play" && elsewhere());
const parts = [() => {
  document.body.dataset.role = role;
  trouble("taken", Boolean(role === "camera" && playing && elsewhere()));
  bar.turn.hidden = isScreen();
  $("bar").hidden = !playing;
}];
const show = () => parts.forEach(part => part());

/* The page begins, or goes on: after a cut, and as it was before it was loaded again. */
HEARD.welcome = message => {
  welcome = message;
  begin();
};
function begin() {
  if (playing) awake();
  show();
  followPlace();
}

HEARD.status = message => {
  session = message;
  if (session.notice && place !== "yours") HEARD.words({said: {...session.notice[0], words: session.notice.map(each => each.words).join(". ")}});
  $("picture").setAttribute("aria-label", `${T.picture}: ${session.title.words}`);
  put("said", session.hint);
  show();
};

/* What the page needs of who plays, the most important first. */
const TROUBLES = {code: "code", full: "wait", lost: "wait", taken: "camera", insecure: "nocamera", denied: "nocamera", gone: "nocamera"};
const troubles = new Set();
function trouble(name, there = true) {
  there ? troubles.add(name) : troubles.delete(name);
  const first = Object.keys(TROUBLES).find(each => troubles.has(each)), box = $("trouble");
  box.hidden = !first;
  if (!first) return;
  const [title, advice] = T[first];
  if (box.querySelector("h2").textContent === title) return;
  box.querySelector("use").setAttribute("href", `#i-${TROUBLES[first]}`);
  box.querySelector("h2").textContent = title;
  box.querySelector("p").textContent = advice;
}
HEARD.blame = ({why}) => ["lost", "code", "full"].forEach(each => trouble(each, each === why));

$("retry").onclick = () => {
  taking = troubles.has("taken");
  refused = looked = -1;
  check();
  followPlace();
};
