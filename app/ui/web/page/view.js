/* The picture alone. OBS lets it sound at once, a browser after a touch. */
openSound();
document.addEventListener("click", openSound);
check();
