const SHAPES = { plane: 0, disc: 1, cylinder: 2 };
const text = (id) => document.getElementById(id).textContent;
const canvas = document.getElementById("view");
const panel = document.getElementById("panel").elements;
const table = JSON.parse(text("table"));
const state = JSON.parse(text("state"));
// A page opened as page.html#{"shape":"disc","bare":true} starts from there.
if (location.hash.length > 1) Object.assign(state, JSON.parse(decodeURIComponent(location.hash.slice(1))));
document.body.classList.toggle("bare", Boolean(state.bare));

const gl = canvas.getContext("webgl2", { antialias: false, alpha: false, preserveDrawingBuffer: true });
const complain = (message) => { document.getElementById("trouble").textContent = message; };
if (!gl) complain("This page needs WebGL 2.");

function compiled(kind, source) {
  const shader = gl.createShader(kind);
  gl.shaderSource(shader, source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) complain(gl.getShaderInfoLog(shader));
  return shader;
}

function linked() {
  const head = "#version 300 es\nprecision highp float;\nprecision highp int;\n";
  const corners = "void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }";
  const program = gl.createProgram();
  gl.attachShader(program, compiled(gl.VERTEX_SHADER, head + corners));
  gl.attachShader(program, compiled(gl.FRAGMENT_SHADER, head + text("diffraction") + text("scene")));
  gl.linkProgram(program);
  gl.useProgram(program);
  return program;
}

async function texels() {
  const packed = Uint8Array.from(atob(text("texels")), (letter) => letter.charCodeAt(0));
  const stream = new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint16Array(await new Response(stream).arrayBuffer());
}

function upload(halves) {
  gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 2);
  gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGB16F, table.columns, table.rows, 0, gl.RGB, gl.HALF_FLOAT, halves);
  for (const side of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) {
    gl.texParameteri(gl.TEXTURE_2D, side, gl.NEAREST);
  }
}

// The rows of yaw about y after pitch about x; WebGL takes matrices by columns, so they go in transposed.
function turned({ yaw, pitch }) {
  const [cy, sy, cp, sp] = [Math.cos(yaw), Math.sin(yaw), Math.cos(pitch), Math.sin(pitch)];
  return [cy, sy * sp, sy * cp, 0, cp, -sp, -sy, cy * sp, cy * cp];
}

function draw(program) {
  const ratio = state.bare ? 1 : window.devicePixelRatio;
  const [width, height] = state.size ?? [window.innerWidth, window.innerHeight];
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  canvas.style.width = `${width}px`;
  canvas.style.height = `${height}px`;
  gl.viewport(0, 0, canvas.width, canvas.height);
  const at = (name) => gl.getUniformLocation(program, name);
  gl.uniform2f(at("view_size"), canvas.width, canvas.height);
  gl.uniform1f(at("view_distance"), state.distance);
  gl.uniform1f(at("view_slope"), Math.tan(state.field_of_view / 2));
  gl.uniformMatrix3fv(at("turn"), true, turned(state));
  gl.uniform1i(at("shape"), SHAPES[state.shape]);
  gl.uniform2f(at("extent"), ...state.extents[state.shape]);
  gl.uniform3f(at("lamp"), ...state.lamp);
  gl.uniform1f(at("lamp_power"), state.lamp_power);
  gl.uniform1f(at("exposure"), 2 ** state.exposure);
  gl.uniform3f(at("f0"), ...state.f0);
  gl.uniform1f(at("specular"), state.specular);
  gl.uniform1f(at("roughness"), state.roughness);
  gl.uniform1f(at("diffraction"), state.diffraction);
  gl.uniform3f(at("diffuse"), ...state.diffuse);
  gl.uniform1f(at("aureole_scale"), table.scale);
  gl.uniform1f(at("aureole_half_range"), table.half_range);
  gl.uniform1f(at("aureole_warp"), table.warp);
  gl.drawArrays(gl.TRIANGLES, 0, 3);
}

function moved(event) {
  const [x, y] = [event.movementX / canvas.clientHeight, event.movementY / canvas.clientHeight];
  if (panel.drag.value === "lamp" || event.shiftKey) {
    const wide = 2 * state.distance * Math.tan(state.field_of_view / 2);
    state.lamp[0] += wide * x;
    state.lamp[1] -= wide * y;
  } else {
    state.yaw += Math.PI * x;
    state.pitch = Math.max(-1.5, Math.min(1.5, state.pitch + Math.PI * y));
  }
}

function listen(redraw) {
  panel.shape.value = state.shape;
  panel.exposure.value = state.exposure;
  panel.lamp_away.value = state.lamp[2];
  panel.distance.value = state.distance;
  document.getElementById("panel").addEventListener("input", () => {
    state.shape = panel.shape.value;
    state.exposure = Number(panel.exposure.value);
    state.lamp[2] = Number(panel.lamp_away.value);
    state.distance = Number(panel.distance.value);
    redraw();
  });
  canvas.addEventListener("pointerdown", (event) => canvas.setPointerCapture(event.pointerId));
  canvas.addEventListener("pointermove", (event) => { if (event.buttons) { moved(event); redraw(); } });
  canvas.addEventListener("wheel", (event) => {
    event.preventDefault();
    state.exposure -= event.deltaY / 400;
    panel.exposure.value = state.exposure;
    redraw();
  }, { passive: false });
  window.addEventListener("resize", redraw);
}

if (gl) {
  const program = linked();
  upload(await texels());
  const redraw = () => requestAnimationFrame(() => draw(program));
  listen(redraw);
  draw(program);
  document.documentElement.dataset.ready = "yes";
}
