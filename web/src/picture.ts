// SPDX-License-Identifier: Apache-2.0
/** What the page shows as one picture: the 3D view with its labels, and the images beside it. */
export function makePicture(world: HTMLElement, images: HTMLCanvasElement[], isDark: boolean): HTMLCanvasElement {
  const drawing = world.querySelector("canvas");
  const picture = document.createElement("canvas");
  const context = picture.getContext("2d");
  if (!drawing || !context) throw new Error("there is nothing to export");
  const side = Math.max(0, ...images.map((image) => image.width));
  picture.width = drawing.width + side;
  picture.height = Math.max(
    drawing.height,
    images.reduce((sum, image) => sum + image.height, 0),
  );
  context.fillStyle = isDark ? "#10151b" : "#eef1f4";
  context.fillRect(0, 0, picture.width, picture.height);
  context.drawImage(drawing, 0, 0);
  const ratio = drawing.width / (world.clientWidth || 1);
  drawLabels(context, world, ratio);
  drawMarker(context, world, ratio);
  let top = 0;
  for (const image of images) {
    context.drawImage(image, drawing.width, top);
    top += image.height;
  }
  return picture;
}

function drawLabels(context: CanvasRenderingContext2D, world: HTMLElement, ratio: number): void {
  const origin = world.getBoundingClientRect();
  context.font = `600 ${11 * ratio}px system-ui, sans-serif`;
  context.textBaseline = "middle";
  for (const label of world.querySelectorAll<HTMLElement>(".labels3d span")) {
    if (label.hidden) continue;
    const box = label.getBoundingClientRect();
    const [x, y] = [(box.left - origin.left) * ratio, (box.top - origin.top) * ratio];
    context.fillStyle = "rgba(10, 14, 20, 0.78)";
    context.fillRect(x, y, box.width * ratio, box.height * ratio);
    context.fillStyle = label.style.getPropertyValue("--label-color");
    context.fillText(label.textContent ?? "", x + 5 * ratio, y + 0.5 * box.height * ratio);
  }
}

function drawMarker(context: CanvasRenderingContext2D, world: HTMLElement, ratio: number): void {
  const marker = world.querySelector<HTMLElement>(".labels3d .marker");
  if (!marker || marker.hidden) return;
  const origin = world.getBoundingClientRect();
  const box = marker.getBoundingClientRect();
  const [x, y] = [box.left + 0.5 * box.width - origin.left, box.top + 0.5 * box.height - origin.top];
  context.fillStyle = getComputedStyle(marker).backgroundColor;
  context.beginPath();
  context.arc(x * ratio, y * ratio, 0.5 * box.width * ratio, 0, 2 * Math.PI);
  context.fill();
}
