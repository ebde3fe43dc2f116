/* A study: sheets to read and to answer lie over the picture, and tasks are played between them. */
const sheet = $("sheet"), loaded = [];
let asked = {};
addButtons({turn: turnCamera, sound: toggleSound, done: () => say({do: "done"})});
bar.sound.setAttribute("aria-pressed", true);
const done = bar.done;

HEARD.sheet = message => {
  over = Boolean(message.over);
  playing = !message.html;
  done.hidden = !message.ends;
  begin();
  if (JSON.stringify(message) === JSON.stringify(asked)) return; // connected again
  asked = message;
  sheet.hidden = playing;
  sheet.innerHTML = message.html;
  sheet.lang = ""; // the study's own language
  for (const [name, words] of Object.entries(message.words || {})) put(name, words);
  sheet.querySelector("form button")?.setAttribute("aria-label", T.onward);
  for (const each of sheet.querySelectorAll("figcaption")) each.textContent = T[each.textContent] || each.textContent;
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
