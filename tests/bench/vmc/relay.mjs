// Hears OSC by node-osc, and serves it, the libraries and the models to a page.
// Run in a folder with node_modules: node relay.mjs FOLDER_OF_PAGE FOLDER_OF_MODELS
import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import { join, normalize } from "node:path";

const { Server } = createRequire(join(process.cwd(), "relay.cjs"))("node-osc");
const [pages, models] = process.argv.slice(2);
const FOLDERS = { node_modules: join(process.cwd(), "node_modules"), models, page: pages };
const TYPES = { html: "text/html", js: "text/javascript", mjs: "text/javascript" };

let waiting = [];
const osc = new Server(0, "127.0.0.1");
osc.on("bundle", (bundle) => waiting.push(...bundle.elements));
osc.on("message", (message) => waiting.push(message));

const http = createServer(async (request, response) => {
  const [folder, ...rest] = normalize(request.url).slice(1).split("/");
  if (folder === "messages") {
    response.writeHead(200, { "Content-Type": "application/json" });
    response.end(JSON.stringify(waiting));
    waiting = [];
    return;
  }
  try {
    const data = await readFile(join(FOLDERS[folder], ...rest));
    const type = TYPES[request.url.split(".").pop()] ?? "application/octet-stream";
    response.writeHead(200, { "Content-Type": type });
    response.end(data);
  } catch {
    response.writeHead(404);
    response.end();
  }
});
osc.on("listening", () =>
  http.listen(0, "127.0.0.1", () =>
    console.log(JSON.stringify({ http: http.address().port, osc: osc._sock.address().port })),
  ),
);
