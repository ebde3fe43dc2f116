/* What is seen of a page: where its focus is, and how well its words can be read. */
function focusSeen() {
  const there = document.activeElement, style = getComputedStyle(there), box = there.getBoundingClientRect();
  return {
    name: there === document.body ? "" : there.getAttribute("aria-label") || there.textContent.trim(),
    ring: there.matches(":focus-visible") ? parseFloat(style.outlineWidth) : 0,
    inside: box.left >= 0 && box.top >= 0 && box.right <= innerWidth && box.bottom <= innerHeight
  };
}

const numbersOf = color => (color.match(/[\d.]+/g) || [0, 0, 0, 0]).map(Number);
const laidOver = ([r, g, b, a = 1], under) => [r, g, b].map((each, i) => a * each + (1 - a) * under[i]);

/* The luminance of an sRGB colour (WCAG 2). */
function luminance(color) {
  const linear = color.map(each => each / 255).map(each => each <= .03928 ? each / 12.92 : ((each + .055) / 1.055) ** 2.4);
  return linear[0] * .2126 + linear[1] * .7152 + linear[2] * .0722;
}

/* The colour behind an element; of a gradient its last one, which is the darkest of ours. */
function behind(element) {
  if (!element) return [255, 255, 255];
  const {backgroundImage, backgroundColor} = getComputedStyle(element), colors = backgroundImage.match(/rgb\([^)]*\)/g);
  return colors ? numbersOf(colors.at(-1)) : laidOver(numbersOf(backgroundColor), behind(element.parentElement));
}

/* The contrast of all words that are there to be read (WCAG 2), by the words. */
function contrastsSeen() {
  const found = {};
  for (const each of document.querySelectorAll("body *")) {
    const words = [...each.childNodes].filter(node => node.nodeType === 3).map(node => node.textContent.trim()).join("");
    if (!words || getComputedStyle(each).clipPath !== "none" || each.closest("[aria-hidden=true],script,style") || !each.checkVisibility({opacityProperty: true})) continue;
    const under = behind(each), over = laidOver(numbersOf(getComputedStyle(each).color), under);
    const [low, high] = [luminance(under), luminance(over)].sort((a, b) => a - b);
    found[words] = (high + .05) / (low + .05);
  }
  return found;
}
