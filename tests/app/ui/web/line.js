/* A simulated line, server and clock for link.js: what a browser and its network do, in no time. */
async function simulate(source, {kind, begin, seconds, latency, trips, answers_s, quick}) {
  let time = 0, order = 0, page;
  const events = [], settled = () => new Promise(done => queueMicrotask(done));
  const at = (when, act) => { const event = {when, order: order++, act}; events.push(event); return event; };
  const drop = event => { const place = events.indexOf(event); if (place >= 0) events.splice(place, 1); };

  /* The line. A connection that is forgotten is silent for ever, and nobody is told. */
  const end = begin + seconds, connections = new Set();
  const during = () => time >= begin && time < end;
  function carry(connection, act, hops = 1) {
    if (during() && kind === "forgotten") connection.dead = true;
    if (connection.dead) return;
    if (kind === "stalled" && time + hops * latency >= begin && time < end) return at(Math.max(end, time) + hops * latency, () => connection.closed || act());
    at(time + hops * latency, () => connection.dead || connection.closed || (during() && kind === "forgotten" ? connection.dead = true : act()));
  }
  at(begin, () => {
    for (const each of [...connections]) {
      if (kind === "cut") each.fail();
      if (kind === "forgotten") each.dead = true;
    }
  });

  /* A connection is made in some round trips; the server answers, at the latest after answers_s. */
  const busy = () => answers_s * ((order * 7) % 10) / 9;
  const handshake = 2 * trips;

  function fetchToken(_, {signal}) {
    return new Promise((done, fail) => {
      const connection = {fail: () => finish(() => fail(new Error("cut")))};
      const finish = act => { if (!connection.closed) { connection.closed = true; connections.delete(connection); act(); } };
      connections.add(connection);
      signal.act = () => finish(() => fail(new Error("too late")));
      if (kind === "cut" && during()) return at(time + latency, connection.fail);
      carry(connection, () => at(time + busy(), () => carry(connection, () => finish(() => done({status: 204})))), handshake + 1);
    });
  }

  let first = Infinity;
  class FakeSocket {
    static CONNECTING = 0;
    static OPEN = 1;
    readyState = 0;
    constructor() {
      connections.add(this);
      if (kind === "cut" && during()) return void at(time + latency, () => this.fail());
      carry(this, () => at(time + busy(), () => carry(this, () => this.opens())), handshake + 1);
    }
    opens() {
      this.readyState = 1;
      this.hear("welcome");
      if (quick) this.film();
    }
    hear(what) { this.onmessage?.({data: JSON.stringify({do: what, at: time})}); }
    film() { // the server's pictures
      if (this.closed || this.dead) return;
      carry(this, () => this.hear("picture"));
      at(time + 1 / 30, () => this.film());
    }
    send() { if (this.readyState === 1) carry(this, () => at(time + busy(), () => carry(this, () => this.hear("tick")))); }
    close() { this.closed = true; this.readyState = 3; connections.delete(this); }
    fail() { if (!this.closed) { this.close(); this.onclose?.({reason: ""}); } }
  }

  const made = new Function("ask", "now", "WebSocket", "AbortSignal", "setInterval", "setTimeout", "query", "token", "LANGUAGE", "location", "window",
    `${source}; return {HEARD, check, sockets: () => attempt, told};`);
  const signals = {timeout(ms) { const signal = {}; at(time + ms / 1000, () => signal.act?.()); return signal; }};
  const every = (act, ms) => at(time + ms / 1000, () => { every(act, ms); act(); });
  page = made(fetchToken, () => time, FakeSocket, signals, every, (act, ms) => at(time + ms / 1000, act), new Map(), "t", "en",
    {pathname: "/", protocol: "http:", host: "h"}, {});
  let opened = 0;
  page.HEARD.cut = () => { opened++; };
  const heard = message => { if (time >= end && message.at !== undefined && first === Infinity) first = time; };
  for (const each of ["welcome", "tick", "picture"]) page.HEARD[each] = heard;
  page.check();
  while (events.length && time < end + 10 && first === Infinity) {
    let next = events[0];
    for (const each of events) if (each.when < next.when || (each.when === next.when && each.order < next.order)) next = each;
    drop(next);
    time = Math.max(time, next.when);
    next.act();
    for (let turn = 0; turn < 6; turn++) await settled();
  }
  return {back: first - end, opened};
}
