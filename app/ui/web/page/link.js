/* The connection: each message shows that it is alive, and a silent one is opened again. */
const PATHS = {play: "/", window: "/window", camera: "/camera", view: "/view"};
const SILENT_S = 2, TRY_S = 1.5, AGAIN_MS = 250, PATIENCE = 2;
const clear = query.get("background") === "none";
let role = Object.keys(PATHS).find(each => PATHS[each] === location.pathname) || "play";
let page = stored("sessionStorage", "page", () => random(16));
let socket, opened = 0, heard = 0, failures = 0, welcome, session = {};

function connect() {
  if (socket) {
    socket.onmessage = socket.onclose = null;
    socket.close();
  }
  inFlight.clear();
  place = "";
  opened = heard = now();
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  const asked = `role=${role}&page=${page}${clear ? "&background=none" : ""}`;
  const mine = socket = new WebSocket(`${scheme}://${location.host}/socket?${asked}`, ["cubeling", token || "none"]);
  mine.binaryType = "arraybuffer";
  mine.onmessage = event => {
    heard = now();
    typeof event.data === "string" ? told(JSON.parse(event.data)) : received(event.data);
  };
  mine.onclose = event => {
    if (event.reason === "this page is connected again") page = random(16); // a copy of this tab
    failed();
    setTimeout(() => mine === socket && connect(), AGAIN_MS);
  };
}

function say(message) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
}

/* Says why there is no connection: a WebSocket is not told. */
async function failed() {
  if (++failures <= PATIENCE) return;
  let answer;
  try { answer = await fetch("/token", {cache: "no-store", headers: {Authorization: `Bearer ${token}`}}); } catch { }
  if (failures <= PATIENCE) return;
  const why = !answer ? "lost" : answer.status === 403 ? "code" : answer.status === 503 ? "full" : "lost";
  for (const each of ["lost", "code", "full"]) trouble(each, each === why);
}

setInterval(() => {
  const waits = socket?.readyState === WebSocket.CONNECTING;
  if (now() - (waits ? opened : heard) > (waits ? TRY_S : SILENT_S)) {
    failed();
    connect();
  } else say({do: "tick"});
}, 500);

const HEARD = {
  welcome(message) {
    welcome = message;
    failures = 0;
    for (const each of ["lost", "code", "full"]) trouble(each, false);
    begin();
  },
  place(message) { placed(message.camera); },
  got(message) { acknowledged(message.id); },
  words(message) { toast(message.words); },
  status(message) {
    session = message;
    showStatus();
  }
};
const told = message => HEARD[message.do]?.(message);
