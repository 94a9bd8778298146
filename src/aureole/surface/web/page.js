const SHAPES = { plane: 0, disc: 1, cylinder: 2 };
const BACKGROUND = [0.0035, 0.0035, 0.0045];
const text = (id) => document.getElementById(id).textContent;
const canvas = document.getElementById("view");
const panel = document.getElementById("panel").elements;
const table = JSON.parse(text("table"));
// A page opened as page.html#{"shape":"disc","bare":true,"size":[960,540]} starts from there.
const asked = location.hash.length > 1 ? JSON.parse(decodeURIComponent(location.hash.slice(1))) : {};
const start = { ...JSON.parse(text("state")), ...asked };
let state = structuredClone(start);
document.body.classList.toggle("bare", Boolean(state.bare));

function complain(message) {
  const place = document.getElementById("trouble");
  place.textContent = message;
  place.classList.add("told");
  document.getElementById("panel").hidden = true;
  document.documentElement.dataset.ready = "no";
}

function compiled(gl, kind, source) {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
  return shader;
}

function linked(gl) {
  const head = "#version 300 es\nprecision highp float;\nprecision highp int;\n";
  const corners = "void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }";
  const program = gl.createProgram();
  gl.attachShader(program, compiled(gl, gl.VERTEX_SHADER, head + corners));
  gl.attachShader(program, compiled(gl, gl.FRAGMENT_SHADER, head + text("diffraction") + text("scene")));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  gl.useProgram(program);
  return program;
}

async function texels() {
  const packed = Uint8Array.from(atob(text("texels")), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint16Array(await new Response(stream).arrayBuffer());
}

function upload(gl, halves) {
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 2);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB16F, table.columns, table.rows, 0, gl.RGB, gl.HALF_FLOAT, halves);
  for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
    gl.texParameteri(gl.TEXTURE_2D, side, gl.NEAREST);
  }
}

const times = (a, b) => a.map((row) => b[0].map((_, k) => row.reduce((sum, value, m) => sum + value * b[m][k], 0)));

// Rows of: the object's own axes, then pitch about x, then yaw about y. Its axes are a row each, so columns here.
function turned({ yaw, pitch, axes }) {
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  const own = axes[0].map((_, k) => axes.map((axis) => axis[k]));
  return times([[cy, 0, sy], [0, 1, 0], [-sy, 0, cy]], times([[1, 0, 0], [0, cp, -sp], [0, sp, cp]], own));
}

function uniforms(gl, program, width, height, wider = 1) {
  const at = (name) => gl.getUniformLocation(program, name);
  const numbers = {
    view_slope: wider * Math.tan(state.field_of_view / 2), sweep: state.sweep, exposure: 2 ** state.exposure,
    specular: state.specular, roughness: state.roughness, diffraction: state.diffraction,
    aureole_scale: table.scale, aureole_half_range: table.half_range, aureole_warp: table.warp,
  };
  for (const [name, value] of Object.entries(numbers)) gl.uniform1f(at(name), value);
  const whole = {
    shape: SHAPES[state.shape], radial: Number(state.radial), lamp_distant: Number(state.lamp_distant),
    stam: Number(state.geometry === "stam"), samples: state.samples,
    soft: Number(!state.bare),
  };
  for (const [name, value] of Object.entries(whole)) gl.uniform1i(at(name), value);
  gl.uniform2f(at("view_size"), width, height);
  gl.uniform2f(at("extent"), ...state.extents[state.shape]);
  gl.uniform2f(at("inverse_window"), ...state.inverse_window);
  gl.uniform3f(at("eye"), ...state.pan, state.distance);
  gl.uniform3f(at("lamp"), ...state.lamp);
  gl.uniform3f(at("lamp_light"), ...state.lamp_colour.map((part) => part * state.lamp_power));
  gl.uniform3f(at("diffuse"), ...state.diffuse);
  gl.uniform3f(at("background"), ...(state.bare ? [0, 0, 0] : BACKGROUND));
  gl.uniform3fv(at("fresnel"), state.fresnel);
  gl.uniformMatrix3fv(at("turn"), true, turned(state).flat());
}

function draw(gl, program) {
  const ratio = state.bare ? 1 : Math.min(window.devicePixelRatio, 2);
  const [width, height] = state.size ?? [window.innerWidth, window.innerHeight];
  canvas.width = Math.max(1, Math.round(width * ratio));
  canvas.height = Math.max(1, Math.round(height * ratio));
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  gl.viewport(0, 0, canvas.width, canvas.height);
  // A window that is higher than it is wide shows as much to each side as above and below.
  uniforms(gl, program, canvas.width, canvas.height, state.size ? 1 : Math.max(1, canvas.height / canvas.width));
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}

// Whether a small picture of the object is too bright: by the mean of its pixels' largest channels, or by how many
// are burnt out.
function bright(gl, program, pixels) {
  uniforms(gl, program, 160, 90);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
  gl.readPixels(0, 0, 160, 90, gl.RGBA, gl.UNSIGNED_BYTE, pixels);
  let [sum, burnt, count] = [0, 0, 0];
  for (let k = 0; k < pixels.length; k += 4) {
    if (pixels[k + 3] < 255) continue;
    const largest = Math.max(pixels[k], pixels[k + 1], pixels[k + 2]);
    sum += largest / 255;
    burnt += Number(largest === 255);
    count += 1;
  }
  return sum > 0.42 * count || burnt > 0.01 * count;
}

// The exposure at which the object is neither dark nor burnt out.
function exposed(gl, program) {
  const [frame, buffer, pixels] = [gl.createFramebuffer(), gl.createRenderbuffer(), new Uint8Array(160 * 90 * 4)];
  gl.bindFramebuffer(gl.FRAMEBUFFER, frame);
  gl.bindRenderbuffer(gl.RENDERBUFFER, buffer);
  gl.renderbufferStorage(gl.RENDERBUFFER, gl.RGBA8, 160, 90);
  gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, buffer);
  gl.viewport(0, 0, 160, 90);
  let [low, high] = [-24, 24];
  for (let k = 0; k < 10; k++) {
    state.exposure = (low + high) / 2;
    if (bright(gl, program, pixels)) high = state.exposure; else low = state.exposure;
  }
  gl.bindFramebuffer(gl.FRAMEBUFFER, null);
  return Math.abs(state.exposure) > 23 ? 0 : state.exposure;
}

const encoded = (part) => (part <= 0.0031308 ? 12.92 * part : 1.055 * part ** (1 / 2.4) - 0.055);
const decoded = (part) => (part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4);
const hex = (colour) => "#" + colour.map(
  (part) => Math.round(255 * encoded(Math.min(1, part))).toString(16).padStart(2, "0")).join("");

// Sliders say how far the state is from where it started.
function show() {
  panel.shape.value = state.shape;
  panel.exposure.value = state.exposure - start.exposure;
  panel.lamp_away.value = Math.log2(Math.hypot(...state.lamp) / Math.hypot(...start.lamp));
  panel.lamp_away.disabled = state.lamp_distant;
  panel.eye_away.value = Math.log2(state.distance / start.distance);
  panel.colour.value = hex(state.lamp_colour);
}

function taken(name) {
  if (name === "shape") state.shape = panel.shape.value;
  if (name === "exposure") state.exposure = start.exposure + Number(panel.exposure.value);
  if (name === "eye_away") state.distance = start.distance * 2 ** panel.eye_away.value;
  if (name === "lamp_away") {
    const scale = (2 ** panel.lamp_away.value * Math.hypot(...start.lamp)) / Math.hypot(...state.lamp);
    state.lamp = state.lamp.map((part) => part * scale);
  }
  if (name === "colour") {
    state.lamp_colour = [1, 3, 5].map((k) => decoded(parseInt(panel.colour.value.slice(k, k + 2), 16) / 255));
  }
}

function moved(x, y, lamp) {
  if (lamp) {
    const wide = state.lamp_distant ? Math.hypot(...state.lamp) : 2 * state.distance * Math.tan(state.field_of_view / 2);
    state.lamp[0] += wide * x;
    state.lamp[1] -= wide * y;
  } else {
    state.yaw += Math.PI * x;
    state.pitch = Math.max(-1.5, Math.min(1.5, state.pitch + Math.PI * y));
  }
}

function closer(stops) {
  const near = Math.log2(state.distance / start.distance) + stops;
  state.distance = start.distance * 2 ** Math.max(-1.5, Math.min(1.5, near));
}

const fingers = new Map();
const span = () => {
  const [one, other] = [...fingers.values()];
  return Math.hypot(one.x - other.x, one.y - other.y);
};

// One finger or the mouse turns or moves; two come closer.
function dragged(event) {
  const before = fingers.get(event.pointerId);
  if (!before) return false;
  const wide = fingers.size === 2 ? span() : 0;
  fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  if (wide > 0) closer(Math.log2(wide / Math.max(span(), 1)));
  else {
    const [x, y] = [event.clientX - before.x, event.clientY - before.y];
    moved(x / canvas.clientHeight, y / canvas.clientHeight, panel.drag.value === "lamp" || event.shiftKey);
  }
  return true;
}

function listen(redraw) {
  const changed = () => { show(); redraw(); };
  document.getElementById("panel").addEventListener("input", (event) => { taken(event.target.name); redraw(); });
  document.getElementById("panel").addEventListener("submit", (event) => event.preventDefault());
  panel.reset.addEventListener("click", () => { state = structuredClone(start); changed(); });
  canvas.addEventListener("pointerdown", (event) => {
    canvas.setPointerCapture(event.pointerId);
    fingers.set(event.pointerId, { x: event.clientX, y: event.clientY });
  });
  for (const name of ["pointerup", "pointercancel"]) {
    canvas.addEventListener(name, (event) => fingers.delete(event.pointerId));
  }
  canvas.addEventListener("pointermove", (event) => { if (dragged(event)) changed(); });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    closer(event.deltaY / 1000);
    changed();
  }, { passive: false });
  canvas.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] }[event.key];
    if (!way) return;
    event.preventDefault();
    moved(way[0] / 60, way[1] / 60, panel.drag.value === "lamp" || event.shiftKey);
    changed();
  });
  window.addEventListener("resize", redraw);
}

async function begin() {
  const gl = canvas.getContext("webgl2", { antialias: false, alpha: false, preserveDrawingBuffer: true });
  if (!gl) return complain("This page needs WebGL 2, which this browser does not offer.\nA current browser with graphics acceleration shows it.");
  if (!window.DecompressionStream) return complain("This browser is too old for this page.\nA current one shows it.");
  canvas.addEventListener("webglcontextlost", () => complain("The graphics card took the picture away.\nLoad the page again."));
  try {
    const program = linked(gl);
    upload(gl, await texels());
    if (state.exposure === null) start.exposure = state.exposure = exposed(gl, program);
    let asleep = true;
    const redraw = () => {
      if (asleep) requestAnimationFrame(() => { asleep = true; draw(gl, program); });
      asleep = false;
    };
    document.querySelector("details").open = window.innerWidth > 700;
    show();
    listen(redraw);
    draw(gl, program);
    document.documentElement.dataset.exposure = state.exposure;
    document.documentElement.dataset.ready = "yes";
  } catch (error) {
    complain(`This page's picture cannot be drawn here.\n${error.message}`);
  }
}

begin();
