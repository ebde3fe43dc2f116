/* The camera up: the newest frame, at most two on their way. One page's camera is that of the game. */
const MAX_SIDE = Math.min(+query.get("size") || 1280, 1920), IN_FLIGHT = 2, RETRY_MS = 2000;
const device = stored("localStorage", "camera", () => random(8)), inFlight = new Set();
const video = $("camera");
// A canvas of the page encodes when the page is idle; one that is not of it does so at once.
const grab = window.OffscreenCanvas ? new OffscreenCanvas(2, 2) : document.createElement("canvas");
let facing = stored("localStorage", "facing", () => "environment");
const QUALITIES = [.85, .7, .5, .35], TOO_MANY = .3, PATIENCE_S = 5;
let stream, opening = false, encoding = false, number = 0;
let place = "", taking = false; // "yours", "other", "free"; "" until the server has said it

const hasCamera = () => welcome?.camera && (role === "play" || role === "camera");
const live = () => stream?.getVideoTracks()[0]?.readyState === "live";

HEARD.place = ({camera}) => {
  place = camera;
  if (place === "yours") taking = false;
  show();
  followPlace();
};
HEARD.cut = () => {
  inFlight.clear();
  place = "";
};

/* Open the camera if this page's is wanted, and close it if another one's is. */
function followPlace() {
  if (!place) return;
  if (playing && hasCamera() && (taking || place !== "other")) {
    if (!live()) openCamera();
    else if (place !== "yours" && !document.hidden) offer();
  } else closeCamera();
}

function closeCamera() {
  stream?.getTracks().forEach(track => { track.onended = null; track.stop(); });
  stream = video.srcObject = null;
  for (const each of ["denied", "gone", "insecure"]) trouble(each, false);
}

async function openCamera() {
  if (opening) return;
  if (!navigator.mediaDevices) return trouble("insecure");
  closeCamera();
  opening = true;
  const size = {width: {ideal: 1280}, height: {ideal: 720}, frameRate: {ideal: 30}};
  try {
    stream = await navigator.mediaDevices.getUserMedia({audio: false, video: {facingMode: {ideal: facing}, ...size}});
  } catch (error) {
    return error.name === "NotAllowedError" ? trouble("denied") : lostCamera();
  } finally { opening = false; }
  const track = stream.getVideoTracks()[0];
  track.onended = lostCamera;
  facing = track.getSettings().facingMode || (navigator.maxTouchPoints ? facing : "user");
  video.srcObject = stream;
  video.classList.toggle("mirror", facing === "user");
  if (!hasCamera()) return closeCamera(); // it has become a window meanwhile
  offer();
  await video.play().catch(() => { });
}

/* It may be there again at any moment. */
function lostCamera() {
  trouble("gone");
  setTimeout(lookAgain, RETRY_MS);
}

function offer() {
  const front = facing === "user";
  say({do: "camera", name: `${device}-${front ? "front" : "back"}`, mirror: front, take: taking});
}

function turnCamera() {
  facing = facing === "user" ? "environment" : "user";
  try { localStorage.facing = facing; } catch { }
  openCamera();
}

/* Coarser pictures, where a line carries no more: many find two of them still on their way. */
let level = 0, seen = 0, late = 0, arrived = 0, counted = now(), fine = now();
HEARD.got = ({id}) => {
  inFlight.delete(id);
  arrived++;
};

function judge() {
  if (now() - counted < 1) return;
  if (late || !arrived) fine = now();
  if (arrived && late > TOO_MANY * seen) level = Math.min(level + 1, QUALITIES.length - 1);
  else if (level && now() - fine > PATIENCE_S) {
    level--;
    fine = now();
  }
  seen = late = arrived = 0;
  counted = now();
}

const nextFrame = () => video.requestVideoFrameCallback
  ? video.requestVideoFrameCallback(frame) : requestAnimationFrame(time => frame(time));

function frame(time, meta) {
  nextFrame();
  const width = video.videoWidth, height = video.videoHeight;
  if (!width || place !== "yours") return;
  seen++;
  judge();
  if (inFlight.size >= IN_FLIGHT) late++;
  if (encoding || inFlight.size >= IN_FLIGHT) return;
  const scale = Math.min(1, MAX_SIDE / Math.max(width, height)), taken = (meta?.captureTime || time) / 1000;
  const size = [width, height].map(side => Math.round(side * scale / 2) * 2);
  if (grab.width !== size[0] || grab.height !== size[1]) [grab.width, grab.height] = size;
  grab.getContext("2d", {alpha: false}).drawImage(video, 0, 0, ...size);
  encoding = true;
  toJpeg().catch(() => { }).then(jpeg => {
    encoding = false;
    if (jpeg && place === "yours") send(jpeg, taken);
  });
}

function toJpeg() {
  const type = "image/jpeg", quality = QUALITIES[level];
  return grab.convertToBlob ? grab.convertToBlob({type, quality}) : new Promise(done => grab.toBlob(done, type, quality));
}

function send(jpeg, taken) {
  if (socket?.readyState !== WebSocket.OPEN) return;
  const head = new DataView(new ArrayBuffer(HEAD_BYTES));
  head.setUint8(0, PICTURE);
  head.setUint32(4, ++number, true);
  head.setFloat64(8, taken, true);
  inFlight.add(number);
  socket.send(new Blob([head.buffer, jpeg]));
}

/* Back from another tab, with another camera, or allowed to use it. */
const awake = () => navigator.wakeLock?.request("screen").catch(() => { });
document.addEventListener("visibilitychange", () => {
  if (document.hidden || !playing) return;
  check();
  if (live()) video.play().catch(() => { });
  followPlace();
  awake();
});
const lookAgain = () => live() || followPlace();
navigator.mediaDevices?.addEventListener?.("devicechange", lookAgain);
navigator.permissions?.query({name: "camera"}).then(allowed => { allowed.onchange = lookAgain; }, () => { });
nextFrame();
