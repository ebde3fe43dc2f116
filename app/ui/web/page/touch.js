/* What is touched, and what is said of it. */
let playing = role === "view" || stored("sessionStorage", "playing", () => "") !== "", muted = false;

const BUTTONS = {
  games: () => { listGames(); $("games").showModal(); },
  again: () => { say({do: "again"}); toast(T.again); },
  photo: () => say({do: "snapshot"}),
  turn: turnCamera,
  sound(pressed) {
    mute(muted = !muted);
    pressed.innerHTML = icon(muted ? "silent" : "sound");
    pressed.setAttribute("aria-pressed", !muted);
  },
  record: () => say({do: "record"}),
  mark: () => say({do: "mark"})
};
const bar = {};
for (const [name, act] of Object.entries(BUTTONS)) bar[name] = button(name, T[name], act, $("bar"));
bar.sound.setAttribute("aria-pressed", true);

/* The page begins, or goes on: after a cut, and as it was before it was loaded again. */
function begin() {
  $("start").hidden = playing;
  if (playing) awake();
  showRole();
  listGames();
  followPlace();
}

$("go").onclick = () => {
  stored("sessionStorage", "playing", () => "yes");
  playing = true;
  begin();
};
document.addEventListener("click", () => playing && openSound()); // browsers want a touch first
$("retry").onclick = () => {
  taking = troubles.has("taken");
  connect();
};

function showStatus() {
  const recording = session.recording != null;
  bar.record.classList.toggle("on", recording);
  bar.record.setAttribute("aria-pressed", recording);
  bar.mark.hidden = !recording;
  if (session.notice && place !== "yours") toast(session.notice.join(". "));
  $("picture").setAttribute("aria-label", `${T.picture}: ${session.scenario || ""}`);
  if ($("said").textContent !== (session.hint || "")) $("said").textContent = session.hint || "";
  offerGame();
  markGame();
}

/* The cube in view plays another game: its picture is there to be touched. */
function offerGame() {
  const place = (welcome?.scenarios || []).findIndex(game => game.name === session.offer);
  const there = place >= 0 && place in tiles && playing && role !== "camera";
  if (there) $("offer").firstElementChild.src = tiles[place];
  $("offer").hidden = !there || role === "view";
  $("offer").setAttribute("aria-label", `${T.go}: ${session.offer}`);
}
$("offer").onclick = () => {
  say({do: "play", name: session.offer});
  $("offer").hidden = true;
};

/* The games, by their pictures. */
function listGames() {
  $("games").lastElementChild.replaceChildren(...(welcome?.scenarios || []).map((game, place) => {
    const made = document.createElement("button"), picture = new Image(), name = document.createElement("span");
    made.dataset.name = name.textContent = game.name;
    made.setAttribute("aria-label", `${game.name}: ${T.about[game.name] || game.summary}`);
    picture.alt = "";
    if (tiles[place]) picture.src = tiles[place];
    made.append(picture, name);
    made.onclick = () => { say({do: "play", name: game.name}); $("games").close(); };
    return made;
  }));
  markGame();
}

function markGame() {
  const chosen = session.scenario || "companion", games = [...$("games").lastElementChild.children];
  for (const each of games) each.setAttribute("aria-pressed", each.autofocus = each.dataset.name === chosen);
  const place = Math.max(games.findIndex(each => each.dataset.name === chosen), 0);
  if (tiles[place]) $("shot").style.backgroundImage = `url(${tiles[place]})`;
}

/* What this page is: camera, screen or both. */
const roles = {};
for (const each of ["play", "window", "camera"]) {
  roles[each] = button(each, T[each], () => becomes(each), $("roles").children[1]);
  roles[each].append(T[each]);
}

function becomes(chosen) {
  $("roles").close();
  role = chosen;
  history.replaceState(null, "", PATHS[role] + location.search + location.hash); // kept if reloaded
  taking = hasCamera();
  connect();
  showRole();
}

function showRole() {
  const screen = !hasCamera() || (role === "play" && place === "other" && !taking);
  const seen = screen ? "window" : role, elsewhere = place === "other" && welcome?.camera && !taking;
  $("role").innerHTML = icon(seen);
  $("role").append(T[seen] + (elsewhere ? `: ${T.other}` : ""));
  $("role").hidden = role === "view" || !welcome;
  document.body.dataset.role = role;
  trouble("taken", Boolean(role === "camera" && playing && elsewhere));
  for (const [name, each] of Object.entries(roles)) {
    each.setAttribute("aria-pressed", each.autofocus = name === seen);
    each.hidden = !welcome?.camera && name !== "window";
  }
  $("invitation").textContent = screen ? T.watch : T.invite;
  for (const [name, each] of Object.entries(bar)) if (name !== "mark") each.hidden = role === "camera" && name !== "turn";
  bar.turn.hidden = screen;
  $("bar").hidden = !playing || role === "view";
  $("roles").lastElementChild.hidden = !welcome?.code;
  if (welcome?.code) $("code").src = welcome.code;
}
$("role").onclick = () => $("roles").showModal();
for (const each of ["games", "roles"]) {
  $(each).firstElementChild.textContent = T[each];
  $(each).onclick = event => event.target === $(each) && $(each).close();
}

/* What the page needs of who plays, the most important first. */
const TROUBLES = {code: "code", full: "wait", lost: "wait", taken: "camera", insecure: "nocamera", denied: "nocamera", gone: "nocamera"};
const troubles = new Set();
function trouble(name, there = true) {
  there ? troubles.add(name) : troubles.delete(name);
  const first = Object.keys(TROUBLES).find(each => troubles.has(each)), box = $("trouble");
  box.hidden = !first || role === "view";
  if (!first) return;
  box.querySelector("use").setAttribute("href", `#i-${TROUBLES[first]}`);
  [box.querySelector("h2").textContent, box.querySelector("p").textContent] = T[first];
}

document.documentElement.lang = language;
$("go").setAttribute("aria-label", T.go);
$("retry").setAttribute("aria-label", T.again);
$("more").textContent = T.more;
$("picture").setAttribute("aria-label", T.picture);
document.body.classList.toggle("clear", clear);
$("delay").title = T.delay;
$("delay").hidden = role === "view";
connect();
