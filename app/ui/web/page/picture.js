/* Pictures down: the newest is drawn, and the server is told so. */
const PICTURE = 1, SOUND = 2, TILE = 3, HEAD_BYTES = 16;
const clear = query.get("background") === "none";
let shown = 0;
document.body.classList.toggle("clear", clear);

async function received(data) {
  const head = new DataView(data), kind = head.getUint8(0), id = head.getUint32(4, true);
  const taken = head.getFloat64(8, true), body = data.slice(HEAD_BYTES);
  if (kind === SOUND) return hear(body);
  if (kind === TILE) return told({do: "tile", id, body});
  let bitmap;
  try { bitmap = await createImageBitmap(new Blob([body])); } catch { }
  if (bitmap) {
    draw(bitmap);
    shown = id;
    told({do: "pictured", taken});
    window.onpicture?.(id, taken);
  }
  say({do: "shown", id});
}

function draw(bitmap) {
  const canvas = $("picture"), context = canvas.getContext("2d");
  if (canvas.width !== bitmap.width || canvas.height !== bitmap.height) [canvas.width, canvas.height] = [bitmap.width, bitmap.height];
  if (clear) context.clearRect(0, 0, canvas.width, canvas.height);
  context.drawImage(bitmap, 0, 0);
  bitmap.close();
}
