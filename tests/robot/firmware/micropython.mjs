// Runs the firmware in MicroPython itself, compiled to WebAssembly.
//
// node micropython.mjs INTERPRETER FOLDER SCRIPT [pin=value …]
//
// Copies FOLDER/dino into the interpreter's file system and runs SCRIPT there. If the script leaves a
// function `turn`, that is called for as long as standard input is open; then bytes go both ways:
// `host.read()` gives what has come, `host.write(bytes)` sends.
import fs from 'node:fs';
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
const start = performance.now();
mp.registerJsModule('host', {
  next: () => (waiting.length ? waiting.shift() : -1),
  write: (hex) => { fs.writeSync(1, Buffer.from(hex, 'hex')); },
  milliseconds: () => Math.floor(performance.now() - start),
});
mp.runPython("import sys\nsys.path.insert(0, '/')");
mp.runPython(fs.readFileSync(script, 'utf8'));

const turn = mp.globals.get('turn');
if (turn) {
  process.stdin.on('data', (data) => { waiting.push(...data); turn(); });
  process.stdin.on('end', () => process.exit(0));
  setInterval(() => turn(), 5);
}
