'use strict';
(async () => {
  const state = await (await fetch('/api/state')).json();
  document.getElementById('state').textContent = `${state.title}: ${state.gaussians} Gaussians`;
  const frame = await fetch('/api/frame', {
    method: 'POST',
    headers: { 'Content-Type': 'application/json' },
    body: JSON.stringify({ camera: state.start, layer: 'both' }),
  });
  document.getElementById('frame').src = URL.createObjectURL(await frame.blob());
})();
