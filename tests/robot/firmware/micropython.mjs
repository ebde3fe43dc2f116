// Runs the firmware in MicroPython itself, compiled to WebAssembly.
//
//     node micropython.mjs INTERPRETER FOLDER SCRIPT
//
// copies FOLDER/dino into the interpreter's file system and runs SCRIPT there. If the script leaves a
// function `again`, that is called until it returns False. If it leaves `turn`, the robot is put behind a TCP port on this machine, whose number is printed: then
// `host.next()` gives the next byte that has come, or -1, and `host.write(hex)` sends bytes.
// It ends when standard input does.
import fs from 'node:fs';
import net from 'node:net';
import path from 'node:path';

const [interpreter, folder, script] = process.argv.slice(2);
const { loadMicroPython } = await import(path.resolve(interpreter));
// As little memory as an RP2040 leaves to a program.
const mp = await loadMicroPython({ heapsize: 160 * 1024 });
mp.FS.mkdir('/dino');
for (const name of fs.readdirSync(path.join(folder, 'dino'))) {
  if (name.endsWith('.py')) {
    mp.FS.writeFile('/dino/' + name, fs.readFileSync(path.join(folder, 'dino', name)));
  }
}

const waiting = [];
let client = null;
mp.registerJsModule('host', {
  next: () => (waiting.length ? waiting.shift() : -1),
  write: (hex) => { client?.write(Buffer.from(hex, 'hex')); },
  milliseconds: () => Math.floor(performance.now()),
});
mp.runPython("import sys\nsys.path.insert(0, '/')");
mp.runPython(fs.readFileSync(script, 'utf8'));

// Between two calls it collects its garbage, and only then.
const again = mp.globals.get('again');
while (again?.()) ;

const turn = mp.globals.get('turn');
if (turn) {
  const server = net.createServer({ noDelay: true }, (socket) => {
    client = socket;
    socket.on('data', (data) => { waiting.push(...data); turn(); });
    socket.on('error', () => {});
    socket.on('close', () => { if (client === socket) client = null; });
  });
  server.listen(0, '127.0.0.1', () => console.log(server.address().port));
  setInterval(() => turn(), 5);
  process.stdin.on('end', () => process.exit(0));
  process.stdin.resume();
}
