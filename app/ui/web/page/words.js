/* What the page says, in the browser's language. */
const WORDS = {
  en: {
    go: "Play", invite: "Tap to play. Then show the cube to the camera.", watch: "Tap to see and hear.",
    games: "What would you like to play?", again: "Start over", photo: "Keep a picture",
    turn: "The other camera", sound: "Sound", record: "Record", mark: "Mark this moment", done: "I have finished",
    picture: "The camera's picture with the character", delay: "How late the picture is",
    roles: "What is this device?", play: "Camera and screen", window: "Screen", camera: "Camera",
    other: "another one is the camera", more: "One more phone or tablet? Scan this.",
    code: ["Scan the code again", "This link no longer opens the door. The new code is on the computer."],
    lost: ["Looking for the computer …", "It goes on by itself."],
    full: ["Too many pages are open", "Close one of them. It goes on by itself."],
    taken: ["Another one is the camera", "Tap the arrow to be it again."],
    denied: ["May I use the camera?", "Allow the camera in the browser: tap the sign beside the address."],
    gone: ["There is no camera", "Does another program use it? Close that, and tap the arrow."],
    insecure: ["The camera needs a safe address", "Open the address with https:// or http://localhost that the computer shows."],
    about: {}
  },
  es: {
    go: "Jugar", invite: "Pulsa para jugar. Luego muestra el cubo a la cámara.", watch: "Pulsa para ver y oír.",
    games: "¿A qué jugamos?", again: "Empezar de nuevo", photo: "Guardar una foto",
    turn: "La otra cámara", sound: "Sonido", record: "Grabar", mark: "Marcar este momento", done: "He terminado",
    picture: "Imagen de la cámara con el personaje", delay: "Retraso de la imagen",
    roles: "¿Qué es este aparato?", play: "Cámara y pantalla", window: "Pantalla", camera: "Cámara",
    other: "otro es la cámara", more: "¿Otro teléfono o tableta? Escanea esto.",
    code: ["Escanea el código otra vez", "Este enlace ya no abre la puerta. El código nuevo está en el ordenador."],
    lost: ["Buscando el ordenador…", "Sigue por sí solo en cuanto haya conexión."],
    full: ["Hay demasiadas páginas abiertas", "Cierra una de ellas. Sigue por sí solo."],
    taken: ["Otro es la cámara", "Toca la flecha para volver a serlo."],
    denied: ["¿Puedo usar la cámara?", "Permite la cámara en el navegador: toca el icono junto a la dirección."],
    gone: ["No hay cámara", "¿La usa otro programa? Ciérralo y toca la flecha."],
    insecure: ["La cámara necesita una dirección segura", "Abre la dirección https:// o http://localhost que muestra el ordenador."],
    about: {
      follow: "El personaje sigue al cubo", sketch: "El cubo dibuja un camino", companion: "Vleo besa o grita",
      reach: "El personaje alcanza el cubo", talk: "Habla con el personaje"
    }
  }
};
const language = navigator.language.toLowerCase().startsWith("es") ? "es" : "en", T = WORDS[language];
