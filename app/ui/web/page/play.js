/* The games, and what this page is. */
const BUTTONS = {
  games: () => { listGames(); $("games").showModal(); },
  again: () => { say({do: "again"}); HEARD.words({said: {words: T.again, language: LANGUAGE}}); },
  photo: () => say({do: "snapshot"}),
  turn: turnCamera,
  sound: toggleSound,
  record: () => say({do: "record"}),
  mark: () => say({do: "mark"})
};
addButtons(BUTTONS);
bar.sound.setAttribute("aria-pressed", true);

$("go").onclick = () => {
  stored("sessionStorage", "playing", () => "yes");
  playing = true;
  begin();
};

/* How late the picture is, if it was taken here, and not before the page was loaded again. */
const delays = [];
HEARD.pictured = ({taken}) => {
  if (!taken || taken > now()) return;
  delays.push(now() - taken);
  if (delays.length > 31) delays.shift();
  const median = [...delays].sort((a, b) => a - b)[delays.length >> 1];
  $("delay").textContent = `${Math.round(1000 * median)} ms`;
};

/* The games, by their pictures. The cube in view may play another one: that is there to be touched. */
const tiles = {}, games = () => welcome?.scenarios || [];
HEARD.tile = ({id, body}) => {
  tiles[id] = URL.createObjectURL(new Blob([body], {type: "image/jpeg"}));
  listGames();
};

function listGames() {
  $("games").lastElementChild.replaceChildren(...games().map((game, number) => {
    const made = document.createElement("button"), picture = new Image(), name = document.createElement("span");
    name.textContent = game.title.words;
    made.setAttribute("aria-label", `${game.title.words}: ${game.summary.words}`);
    picture.alt = "";
    if (tiles[number]) picture.src = tiles[number];
    made.append(picture, name);
    made.onclick = () => { say({do: "play", name: game.name}); $("games").close(); };
    return made;
  }));
  show();
}

parts.push(() => {
  const of = name => games().findIndex(game => game.name === name), offered = of(session.offer);
  const there = offered in tiles && playing && role !== "camera", chosen = of(session.scenario || "companion");
  $("offer").hidden = !there;
  if (there) {
    $("offer").firstElementChild.src = tiles[offered];
    $("offer").setAttribute("aria-label", `${T.go}: ${games()[offered].title.words}`);
  }
  [...$("games").lastElementChild.children].forEach((each, number) => each.setAttribute("aria-pressed", each.autofocus = number === chosen));
  const shot = tiles[Math.max(chosen, 0)];
  if (shot) $("shot").style.backgroundImage = `url(${shot})`;
});
$("offer").onclick = () => {
  say({do: "play", name: session.offer});
  $("offer").hidden = true;
};

/* What is typed is said to a character that listens; it falls silent as soon as that begins. */
const line = $("talk").firstElementChild;
line.oninput = () => line.value.length === 1 && say({do: "type"});
$("talk").onsubmit = event => {
  event.preventDefault();
  if (line.value.trim()) say({do: "type", name: line.value});
  line.value = "";
};
parts.push(() => { $("talk").hidden = !playing || role === "camera" || !session.listens; });

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
  show();
}

parts.push(() => {
  const seen = isScreen() ? "window" : role, label = T[seen] + (elsewhere() ? `: ${T.other}` : "");
  $("start").hidden = playing;
  if (place !== "yours" || role === "camera") $("delay").textContent = "";
  $("role").hidden = !welcome;
  if ($("role").textContent !== label) {
    $("role").innerHTML = icon(seen);
    $("role").append(label);
  }
  for (const [name, each] of Object.entries(roles)) {
    each.setAttribute("aria-pressed", each.autofocus = name === seen);
    each.hidden = !welcome?.camera && name !== "window";
  }
  $("invitation").textContent = isScreen() ? T.watch : T.invite;
  const recording = session.recording != null;
  for (const [name, each] of Object.entries(bar)) if (name !== "turn") each.hidden = role === "camera" || (name === "mark" && !recording);
  bar.record.classList.toggle("on", recording);
  bar.record.setAttribute("aria-pressed", recording);
  $("roles").lastElementChild.hidden = !welcome?.code;
  if (welcome?.code) $("code").src = welcome.code;
});
$("role").onclick = () => $("roles").showModal();
for (const each of [$("games"), $("roles")]) each.onclick = event => event.target === each && each.close();

check();
