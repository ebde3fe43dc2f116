/* What every page needs: its parts, its address, and words in its language. */
const $ = id => document.getElementById(id);
const now = () => performance.now() / 1000;
const query = new URLSearchParams(location.search), token = location.hash.slice(1) || "none";
const ask = (path, more) => fetch(path, {cache: "no-store", headers: {Authorization: `Bearer ${token}`}, ...more});
addEventListener("hashchange", () => location.reload()); // a new link in the same tab
