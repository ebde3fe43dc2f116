/* The desk: what is played, and buttons that make character and robot act. */
const STATE_MS = 250, PICTURE_MS = 500;
let state = {}, built = "";

async function act(request) {
  show(await (await ask("/desk", { method: "POST", body: JSON.stringify(request) })).json());
}

function make(tag, text, more = {}) {
  return Object.assign(document.createElement(tag), { textContent: text, ...more });
}

function push(text, request) {
  return make("button", text, { onclick: () => act(request) });
}

function words(name = "") {
  return T.words[name] || (name === name.toUpperCase() ? name.toLowerCase().replaceAll("_", " ") : name);
}

function group(kind, names) {
  const title = T[kind];
  const box = make("div", "", { className: "group" }), row = make("div", "", { className: "row" });
  box.append(make("h2", title));
  if (kind === "say") {
    const field = make("input", "", { placeholder: T.free, ariaLabel: T.free, maxLength: 500 });
    field.onkeydown = event => {
      if (event.key === "Enter" && field.value.trim()) {
        act({ do: "say", name: field.value.trim() });
        field.value = "";
      }
    };
    box.append(field);
  } else if (names.length > 24) {
    const field = make("input", "", { placeholder: `${T.search}: ${title.toLowerCase()}`, ariaLabel: `${T.search}: ${title.toLowerCase()}` });
    field.oninput = () => {
      for (const each of row.children)
        each.hidden = !each.textContent.toLowerCase().includes(field.value.toLowerCase());
    };
    box.append(field);
  }
  names.forEach((name, at) => {
    const label = kind === "say" && at < 9 ? `${at + 1}  ${name}` : words(name);
    row.append(push(label, { do: kind, name }));
  });
  if (kind === "emotion") row.append(push(T.scenarios, { do: "emotion" }));
  if (kind === "action") row.append(push(T.end, { do: "action", name: "idle" }));
  box.append(row);
  return box;
}

function build() {
  const now = JSON.stringify([state.groups, state.robot, state.cues, state.places]);
  if (now === built) return;
  built = now;
  const robot = { kind: "play", names: state.robot || [] };
  const shown = [...state.groups, robot].filter(each => each.names.length || each.kind === "say");
  $("buttons").replaceChildren(...shown.map(each => group(each.kind, each.names)));
  $("cues").replaceChildren(...state.cues.map(name => push(`${T.cue}: ${name}`, { do: "cue", name })));
  $("places").replaceChildren(...state.places.map(([name, x, z]) => {
    const mark = document.createElementNS("http://www.w3.org/2000/svg", "g");
    mark.innerHTML = '<circle r="1"></circle><text y="-1.6"></text>';
    mark.setAttribute("transform", `translate(${100 * x} ${100 * z})`);
    mark.lastChild.textContent = name;
    mark.onclick = event => {
      event.stopPropagation();
      act({ do: "go", name, place: [x, z] });
    };
    return mark;
  }));
}

function put(id, place) {
  $(id).toggleAttribute("hidden", !place);
  if (place) $(id).setAttribute("transform", `translate(${100 * place[0]} ${100 * place[1]})`);
}

function show(found) {
  state = found;
  build();
  const says = state.says ? ` · ${T.says} “${state.says}”` : "";
  $("doing").textContent = state.playing
    ? `${words(state.scenario)} · ${words(state.activity)} · ${words(state.emotion)}${says}` : T.nothing;
  $("problem").textContent = words(state.problem);
  $("cue").textContent = state.cue ? `${state.cue[0]}: ${state.cue[1].toFixed(1)} ${T.ago}` : "";
  put("figure", state.character);
  put("cubemark", state.cube);
  $("acts").replaceChildren(...[...state.acts].reverse().map(done => {
    const line = make("li", "", { className: done.undone ? "undone" : "" });
    const what = make("span", "", { className: "what" });
    what.append(make("span", `${T.kinds[done.kind] || done.kind} `, { className: done.kind === "cue" ? "cue" : "kind" }), words(done.name));
    line.append(what);
    if (done.delay_s !== null)
      line.append(make("span", `+${done.delay_s.toFixed(2)} s`, { className: "delay", title: done.cue }));
    if (!done.undone) line.append(push(T.error, { do: "undo", number: done.number }));
    return line;
  }));
}

$("table").onclick = event => {
  const at = new DOMPoint(event.clientX, event.clientY).matrixTransform($("table").getScreenCTM().inverse());
  act({ do: "go", place: [at.x / 100, at.y / 100] });
};
$("tocube").onclick = $("cubemark").onclick = event => {
  event.stopPropagation();
  act({ do: "go", name: "cube" });
};
$("stay").onclick = () => act({ do: "go" });

document.onkeydown = event => {
  if (event.target.tagName === "INPUT" || event.ctrlKey || event.metaKey || event.altKey) return;
  const say = (state.groups || []).find(each => each.kind === "say");
  const last = [...(state.acts || [])].reverse().find(each => !each.undone);
  if (event.key === " ") act({ do: "cue", name: state.cues[0] });
  else if (event.key === "z" && last) act({ do: "undo", number: last.number });
  else if (/^[1-9]$/.test(event.key) && say && say.names[event.key - 1])
    act({ do: "say", name: say.names[event.key - 1] });
  else return;
  event.preventDefault();
};

async function follow() {
  try {
    const answer = await ask("/desk/state");
    if (answer.ok) show(await answer.json());
    else $("doing").textContent = T.closed;
  } catch {
    $("doing").textContent = T.ended;
  }
  setTimeout(follow, STATE_MS);
}

async function look() {
  try {
    const answer = await ask("/desk/picture");
    if (answer.ok) {
      URL.revokeObjectURL($("picture").src);
      $("picture").src = URL.createObjectURL(await answer.blob());
      $("picture").hidden = false;
    }
  } catch { }
  setTimeout(look, PICTURE_MS);
}

follow();
look();
