/* Sound: blocks are played one after the other, a little later than they come. */
const EARLY_S = .01, AHEAD_S = .06, LATE_S = .3;
let audio, loudness, due = 0;

function openSound() {
  try {
    if (!audio) {
      audio = new AudioContext();
      loudness = audio.createGain();
      loudness.connect(audio.destination);
    }
    audio.resume();
  } catch { }
}

function mute(on) { if (loudness) loudness.gain.value = on ? 0 : 1; }

function hear(body) {
  if (audio?.state !== "running") return;
  const samples = new Int16Array(body), count = samples.length / 2;
  const block = audio.createBuffer(2, count, welcome.rate);
  for (const side of [0, 1]) {
    const to = block.getChannelData(side);
    for (let i = 0; i < count; i++) to[i] = samples[2 * i + side] / 32768;
  }
  if (due < audio.currentTime + EARLY_S || due > audio.currentTime + LATE_S) due = audio.currentTime + AHEAD_S;
  const source = audio.createBufferSource();
  source.buffer = block;
  source.connect(loudness);
  source.start(due);
  due += block.duration;
}
