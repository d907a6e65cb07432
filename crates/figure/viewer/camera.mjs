/**
 * A camera that turns about the origin; the meshes of a view are scaled to fit
 * a ball of radius 1 about it. Angles as in the printed figures: azimuth from
 * the front (+z, or −y where z is up) towards +x, elevation above the horizon.
 */
export class Camera {
  constructor(azimuth, elevation, zUp = false) {
    this.zUp = zUp;
    this.home = {azimuth, elevation, distance: 3.4, x: 0, y: 0};
    this.reset();
  }

  reset() {
    Object.assign(this, this.home);
  }

  turn(dx, dy) {
    this.azimuth -= dx;
    this.elevation = Math.max(-90, Math.min(90, this.elevation + dy));
  }

  move(dx, dy) {
    this.x += dx * this.distance;
    this.y += dy * this.distance;
  }

  zoom(factor) {
    this.distance = Math.max(0.3, Math.min(40, this.distance * factor));
  }

  /** From the scaled mesh to the eye, by columns. */
  view() {
    const a = (this.azimuth * Math.PI) / 180;
    const e = (this.elevation * Math.PI) / 180;
    const [sa, ca, se, ce] = [Math.sin(a), Math.cos(a), Math.sin(e), Math.cos(e)];
    const side = [ca, -sa * se, sa * ce, 0];
    const up = [0, ce, se, 0];
    const front = [-sa, -ca * se, ca * ce, 0];
    const [y, z] = this.zUp ? [front.map((x) => -x), up] : [up, front];
    return [...side, ...y, ...z, this.x, this.y, -this.distance, 1];
  }

  /** Perspective with 36° from top to bottom, more in a tall picture. */
  projection(aspect) {
    const zoom = 1 / Math.tan((18 * Math.PI) / 180);
    const [fx, fy] = aspect < 1 ? [zoom, zoom * aspect] : [zoom / aspect, zoom];
    const near = Math.max(0.02, this.distance - 8);
    const far = this.distance + 40;
    return [
      fx, 0, 0, 0,
      0, fy, 0, 0,
      0, 0, (far + near) / (near - far), -1,
      0, 0, (2 * far * near) / (near - far), 0,
    ];
  }

  /** Where a point of the scaled mesh is seen, in pixels from the top left. */
  place(point, width, height) {
    const m = this.view();
    const p = this.projection(width / height);
    const at = (row) => m[row] * point[0] + m[4 + row] * point[1] + m[8 + row] * point[2] + m[12 + row];
    const depth = -at(2);
    return [
      (0.5 + (0.5 * p[0] * at(0)) / depth) * width,
      (0.5 - (0.5 * p[5] * at(1)) / depth) * height,
    ];
  }

  toText() {
    const short = (x) => String(Number(x.toFixed(3)));
    return [this.azimuth, this.elevation, this.distance, this.x, this.y].map(short).join('~');
  }

  fromText(text) {
    const numbers = text.split('~').map(Number);
    if (numbers.length !== 5 || numbers.some((x) => !Number.isFinite(x))) return;
    [this.azimuth, this.elevation, this.distance, this.x, this.y] = numbers;
    this.turn(0, 0);
    this.zoom(1);
  }
}
