// Checks of a page's layout: contrast of texts, names and sizes of controls, nothing outside the window.
const kContrast = 4.5;   // AA of WCAG 2.2 for normal text
const kTargetPx = 24;    // AA of WCAG 2.2 for pointer targets

// Runs in the page; returns a list of faults.
function faults({ contrast, targetPx }) {
  const found = [];
  const isShown = (element) => element.checkVisibility({ opacityProperty: true, visibilityProperty: true }) &&
    element.getClientRects().length > 0 && !element.closest('.unseen');
  const canvas = new OffscreenCanvas(1, 1), context = canvas.getContext('2d', { willReadFrequently: true });
  const rgba = (colour) => {
    context.clearRect(0, 0, 1, 1);
    context.fillStyle = colour;
    context.fillRect(0, 0, 1, 1);
    return [...context.getImageData(0, 0, 1, 1).data];
  };
  const luminance = ([r, g, b]) => [r, g, b].map((v) => v / 255)
    .map((v) => (v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4))
    .reduce((sum, v, k) => sum + v * [0.2126, 0.7152, 0.0722][k], 0);
  const groundOf = (element) => {
    for (let e = element; e; e = e.parentElement) {
      const colour = rgba(getComputedStyle(e).backgroundColor);
      if (colour[3] === 255) return colour;
    }
    return rgba('Canvas');
  };
  const labelsOf = (e) => [...(e.labels ?? [])].map((label) => label.textContent).join(' ');
  const nameOf = (e) => (e.getAttribute('aria-label') ?? labelsOf(e) + e.textContent).trim();
  const called = (e) => `${e.tagName.toLowerCase()}${e.id ? '#' + e.id : ''} "${nameOf(e).slice(0, 24)}"`;

  const texts = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  for (let node = texts.nextNode(); node; node = texts.nextNode()) {
    const element = node.parentElement;
    if (!node.data.trim() || !isShown(element) || element.closest(':disabled, option, dialog:not([open])')) continue;
    const a = luminance(rgba(getComputedStyle(element).color)), b = luminance(groundOf(element));
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < contrast) found.push(`contrast ${ratio.toFixed(2)}: ${called(element)}`);
  }
  for (const element of document.querySelectorAll('button, input, select, summary, a, [tabindex]')) {
    if (!isShown(element)) continue;
    if (!nameOf(element)) found.push(`without a name: ${called(element)}`);
    const box = (element.closest('label') ?? element).getBoundingClientRect(), least = Math.min(box.width, box.height);
    if (least < targetPx) found.push(`only ${least.toFixed()} px: ${called(element)}`);
    if (box.left < -0.5 || box.right > innerWidth + 0.5) found.push(`outside the window: ${called(element)}`);
  }
  if (document.documentElement.scrollWidth > innerWidth) found.push('wider than the window');
  return found;
}

export const looksOf = (page) => page.evaluate(faults, { contrast: kContrast, targetPx: kTargetPx });
