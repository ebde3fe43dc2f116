// Runs the firmware in MicroPython itself, compiled to WebAssembly.
//
//     node micropython.mjs INTERPRETER FOLDER SCRIPT
//
// copies FOLDER/dino into the interpreter's file system and runs SCRIPT there. If the script leaves a
// function `again`, that is called until it returns False. If it leaves `exchange`, that is called
// with every line of standard input, and what it returns is a line of standard output.
import fs from 'node:fs';
import path from 'node:path';

// Node would print the whole interpreter, which is one line, around the error's message.
process.on('uncaughtException', (error) => {
  console.error(error.message);
  process.exit(1);
});

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
mp.runPython("import sys\nsys.path.insert(0, '/')");
mp.runPython(fs.readFileSync(script, 'utf8'));

// Between two calls the interpreter collects its garbage, and only then.
const again = mp.globals.get('again');
while (again?.()) ;

const exchange = mp.globals.get('exchange');
const block = Buffer.alloc(4096);
let text = '';
while (exchange) {
  const count = fs.readSync(0, block);
  if (!count) break;
  const lines = (text + block.toString('latin1', 0, count)).split('\n');
  text = lines.pop();
  for (const line of lines) fs.writeSync(1, exchange(line) + '\n');
}
