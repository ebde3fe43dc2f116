/* The connection: each message shows that it is alive, and a silent one is opened again. */
const PATHS = {play: "/", window: "/window", camera: "/camera", view: "/view"};
const SILENT_S = 2, TRY_S = 1, AGAIN_MS = 250, LOST_S = 3;
const REASONS = {403: "code", 503: "full"};
const clear = query.get("background") === "none";
let role = Object.keys(PATHS).find(each => PATHS[each] === location.pathname) || "play";
let page = stored("sessionStorage", "page", () => random(16));
let socket, attempt = 0, tried = 0, heard = 0, over = false, welcome, session = {};

/* Asks first whether there is a server: it says why not, and browsers delay WebSockets that fail. */
async function connect() {
  if (socket) {
    socket.onmessage = socket.onclose = null;
    socket.close();
    socket = null;
  }
  inFlight.clear();
  place = "";
  tried = now();
  const mine = attempt = Math.max(Date.now(), attempt + 1);
  const answer = await ask(`/token?page=${page}`, {signal: AbortSignal.timeout(1000 * TRY_S)}).catch(() => { });
  if (mine !== attempt) return;
  if (answer?.status !== 204) return again(REASONS[answer?.status] || "lost");
  const scheme = location.protocol === "https:" ? "wss" : "ws";
  const asked = `role=${role}&page=${page}&attempt=${mine}${clear ? "&background=none" : ""}`;
  socket = new WebSocket(`${scheme}://${location.host}/socket?${asked}`, ["cubeling", token]);
  socket.binaryType = "arraybuffer";
  tried = now();
  socket.onmessage = event => {
    heard = now();
    typeof event.data === "string" ? told(JSON.parse(event.data)) : received(event.data);
  };
  socket.onclose = event => {
    if (event.reason === "this page is connected again") page = random(16); // a copy of this tab
    again("lost");
  };
}

function again(why) {
  const mine = attempt;
  if (why !== "lost" || now() - heard > LOST_S) for (const each of ["lost", "code", "full"]) trouble(each, each === why);
  setTimeout(() => mine === attempt && !over && connect(), now() - tried > TRY_S ? 0 : AGAIN_MS);
}

function say(message) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
}

setInterval(() => {
  const waits = socket?.readyState === WebSocket.CONNECTING;
  if (socket && !over && now() - Math.max(heard, tried) > (waits ? TRY_S : SILENT_S)) connect();
  else say({do: "tick"});
}, 500);

const HEARD = {
  welcome(message) {
    welcome = message;
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
