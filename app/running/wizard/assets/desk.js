"use strict";
const find = id => document.getElementById(id);
const STATE_MS = 250, PICTURE_MS = 500;
let state = {}, built = "";

async function ask(request) {
  show(await (await fetch(location.pathname, { method: "POST", body: JSON.stringify(request) })).json());
}

function make(tag, text, more = {}) {
  return Object.assign(document.createElement(tag), { textContent: text, ...more });
}

function button(text, request) {
  return make("button", text, { onclick: () => ask(request) });
}

function words(name) {
  return name === name.toUpperCase() ? name.toLowerCase().replaceAll("_", " ") : name;
}

function group(kind, title, names) {
  const box = make("div", "", { className: "group" }), row = make("div", "", { className: "row" });
  box.append(make("h2", title));
  if (kind === "say") {
    const field = make("input", "", { placeholder: "Say something else: Enter says it", maxLength: 500 });
    field.onkeydown = event => {
      if (event.key === "Enter" && field.value.trim()) {
        ask({ do: "say", name: field.value.trim() });
        field.value = "";
      }
    };
    box.append(field);
  } else if (names.length > 24) {
    const field = make("input", "", { placeholder: "Search " + title.toLowerCase() });
    field.oninput = () => {
      for (const each of row.children)
        each.hidden = !each.textContent.toLowerCase().includes(field.value.toLowerCase());
    };
    box.append(field);
  }
  names.forEach((name, at) => {
    const label = kind === "say" && at < 9 ? `${at + 1}  ${name}` : words(name);
    row.append(button(label, { do: kind, name }));
  });
  if (kind === "emotion") row.append(button("as the scenario wants", { do: "emotion" }));
  if (kind === "action") row.append(button("end it", { do: "action", name: "idle" }));
  box.append(row);
  return box;
}

function build() {
  const now = JSON.stringify([state.groups, state.robot, state.cues, state.places]);
  if (now === built) return;
  built = now;
  const robot = { kind: "play", title: "Robot", names: state.robot || [] };
  const shown = [...state.groups, robot].filter(each => each.names.length || each.kind === "say");
  find("buttons").replaceChildren(...shown.map(each => group(each.kind, each.title, each.names)));
  find("cues").replaceChildren(...state.cues.map(name => button("Cue: " + name, { do: "cue", name })));
  find("places").replaceChildren(...state.places.map(([name, x, z]) => {
    const mark = document.createElementNS("http://www.w3.org/2000/svg", "g");
    mark.innerHTML = '<circle r="1"></circle><text y="-1.6"></text>';
    mark.setAttribute("transform", `translate(${100 * x} ${100 * z})`);
    mark.lastChild.textContent = name;
    mark.onclick = event => {
      event.stopPropagation();
      ask({ do: "go", name, place: [x, z] });
    };
    return mark;
  }));
}

function put(id, place) {
  find(id).toggleAttribute("hidden", !place);
  if (place) find(id).setAttribute("transform", `translate(${100 * place[0]} ${100 * place[1]})`);
}

function show(found) {
  state = found;
  build();
  const says = state.says ? ` · says “${state.says}”` : "";
  find("doing").textContent = state.playing
    ? `${state.scenario} · ${state.activity} · ${state.emotion}${says}` : "Nothing is played now";
  find("problem").textContent = state.problem;
  find("cue").textContent = state.cue ? `${state.cue[0]}: ${state.cue[1].toFixed(1)} s ago` : "";
  put("figure", state.character);
  put("cubemark", state.cube);
  find("acts").replaceChildren(...[...state.acts].reverse().map(act => {
    const line = make("li", "", { className: act.undone ? "undone" : "" });
    const what = make("span", "", { className: "what" });
    what.append(make("span", act.kind + " ", { className: act.kind === "cue" ? "cue" : "kind" }), words(act.name));
    line.append(what);
    if (act.delay_s !== null)
      line.append(make("span", `+${act.delay_s.toFixed(2)} s`, { className: "delay", title: act.cue }));
    if (!act.undone) line.append(button("error", { do: "undo", number: act.number }));
    return line;
  }));
}

find("table").onclick = event => {
  const at = new DOMPoint(event.clientX, event.clientY).matrixTransform(find("table").getScreenCTM().inverse());
  ask({ do: "go", place: [at.x / 100, at.y / 100] });
};
find("tocube").onclick = find("cubemark").onclick = event => {
  event.stopPropagation();
  ask({ do: "go", name: "cube" });
};
find("stay").onclick = () => ask({ do: "go" });

document.onkeydown = event => {
  if (event.target.tagName === "INPUT" || event.ctrlKey || event.metaKey || event.altKey) return;
  const say = (state.groups || []).find(each => each.kind === "say");
  const last = [...(state.acts || [])].reverse().find(act => !act.undone);
  if (event.key === " ") ask({ do: "cue", name: state.cues[0] });
  else if (event.key === "z" && last) ask({ do: "undo", number: last.number });
  else if (/^[1-9]$/.test(event.key) && say && say.names[event.key - 1])
    ask({ do: "say", name: say.names[event.key - 1] });
  else return;
  event.preventDefault();
};

async function follow() {
  try {
    show(await (await fetch(location.pathname + "/state")).json());
  } catch {
    find("doing").textContent = "The program has ended";
  }
  setTimeout(follow, STATE_MS);
}

function look() {
  const picture = new Image();
  picture.onload = () => {
    find("picture").src = picture.src;
    find("picture").hidden = false;
    setTimeout(look, PICTURE_MS);
  };
  picture.onerror = () => setTimeout(look, 4 * PICTURE_MS);
  picture.src = `${location.pathname}/picture?${Date.now()}`;
}

follow();
look();
