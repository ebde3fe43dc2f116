/* The connection. A socket that is silent for QUIET_S is doubted: the server is asked every ASK_S
   whether it is there, each time by a connection of its own, and its first answer opens another
   socket, unless the silent one speaks within GRACE_MS. docs/phone.md adds up what that takes. */
const PATHS = {play: "/", window: "/window", camera: "/camera", view: "/view"};
const EVERY_MS = 100, QUIET_S = .3, GRACE_MS = 50, ASK_S = .2, ANSWER_MS = 800, SLOW_MS = 4000, REFUSED_S = 1, LOST_S = 3;
const REASONS = {403: "code", 503: "full"};
let role = Object.keys(PATHS).find(each => PATHS[each] === location.pathname) || "play";
let page = stored("sessionStorage", "page", () => random(16));
let socket, attempt = 0, opened = 0, patience = 0, heard = 0, looks = 0, looked = -1, refused = -1, blamed = "";
let over = false, welcome, session = {};

function random(length) {
  const bytes = crypto.getRandomValues(new Uint8Array(length));
  return Array.from(bytes, byte => "abcdefghijklmnopqrstuvwxyz234567"[byte & 31]).join("");
}

// A store may be forbidden, as in a private window.
function stored(kind, key, make) {
  try { return window[kind][key] ||= make(); } catch { return make(); }
}

/* What the server tells, and the parts of the page each other: each part adds what it hears. */
const HEARD = {welcome(message) { welcome = message; }};
const told = message => HEARD[message.do]?.(message);

function blame(why) {
  if (why !== blamed) told({do: "blame", why: blamed = why});
}

/* `took` is what an answer takes on this line: a handshake that takes thrice as long is lost. */
function connect(took = 0) {
  if (socket) {
    socket.onmessage = socket.onclose = null;
    socket.close();
  }
  told({do: "cut"});
  opened = now();
  patience = Math.max(QUIET_S, 3 * took);
  attempt = Math.max(Date.now(), attempt + 1);
  const scheme = location.protocol === "https:" ? "wss" : "ws", clear = query.get("background") || "";
  const what = `role=${role}&page=${page}&attempt=${attempt}&background=${clear}&language=${LANGUAGE}`;
  socket = new WebSocket(`${scheme}://${location.host}/socket?${what}`, ["cubeling", token]);
  socket.binaryType = "arraybuffer";
  socket.onmessage = event => {
    heard = now();
    blame("");
    typeof event.data === "string" ? told(JSON.parse(event.data)) : received(event.data);
  };
  socket.onclose = event => {
    if (event.reason === "this page is connected again") page = random(16); // a copy of this tab
    socket = null;
  };
}

/* Asks by HTTP: that says why not, and browsers delay WebSockets that fail. Some of it is asked more
   patiently, over a slow line; a browser has six connections at a time. */
async function look() {
  const began = looked = now(), limit = AbortSignal.timeout(looks++ % 16 ? ANSWER_MS : SLOW_MS);
  const answer = await ask(`/token?page=${page}`, {signal: limit}).catch(() => { });
  const took = now() - began;
  if (answer?.status === 204) {
    if (socket?.readyState === WebSocket.OPEN) await new Promise(done => setTimeout(done, GRACE_MS));
    if (Math.max(heard, opened) < began) connect(took);
  } else if (heard < began && REASONS[answer?.status]) {
    refused = now();
    blame(REASONS[answer.status]);
  } else if (now() - heard > LOST_S) blame("lost");
}

function say(message) {
  if (socket?.readyState === WebSocket.OPEN) socket.send(JSON.stringify(message));
}

function check() {
  if (over) return;
  const waits = socket?.readyState === WebSocket.CONNECTING, silent = socket ? now() - Math.max(heard, opened) : Infinity;
  if (silent > QUIET_S / 3) say({do: "tick"});
  if (silent > (waits ? patience : QUIET_S) && now() - looked >= ASK_S && now() - refused > REFUSED_S) look();
}
setInterval(check, EVERY_MS);
