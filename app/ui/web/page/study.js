/* A study: sheets to read and to answer lie over the picture, and tasks are played between them. */
const sheet = document.createElement("section"), loaded = [];
let asked = {};
sheet.id = "sheet";
sheet.hidden = true;
document.querySelector("main").append(sheet);
const done = button("done", T.done, () => say({do: "done"}), $("bar"));

HEARD.sheet = message => {
  over = Boolean(message.over);
  playing = !message.html;
  done.hidden = !message.ends;
  begin();
  if (message.html === asked.html && message.number === asked.number) return; // connected again
  asked = message;
  sheet.hidden = playing;
  sheet.innerHTML = message.html;
  sheet.scrollTop = 0;
  loaded.splice(0).forEach(URL.revokeObjectURL);
  sheet.querySelectorAll("[data-from]").forEach(load);
  const title = sheet.firstElementChild?.querySelector("h1, h2, .text") || sheet.firstElementChild;
  if (title) title.tabIndex = -1;
  title?.focus(); // so that it is read
};

async function load(shown) {
  try {
    const answer = await ask(shown.dataset.from);
    if (answer.ok) loaded.push(shown.src = URL.createObjectURL(await answer.blob()));
  } catch { asked = {}; } // once more when it is connected again
}

sheet.oninput = sheet.onclick = ({target}) => { // a slider that nobody touched has no answer
  if (target.type === "range") target.name = "answer";
};

sheet.onsubmit = event => {
  event.preventDefault();
  say({do: "answer", id: asked.number, name: new FormData(event.target).get("answer") || ""});
  openSound();
};
