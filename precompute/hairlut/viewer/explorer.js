// SPDX-License-Identifier: BSD-3-Clause
"use strict";

const data = JSON.parse(document.getElementById("data").textContent);
const byId = id => document.getElementById(id);
const DEGREE = Math.PI / 180;
const HAIR = "hair"; // what the choice of a lobe calls the whole mixture
const key = k => `hsl(${(200 + 137.5 * k) % 360} 75% 68%)`; // a colour for each table or lobe
const STOPS = ["#0d1020", "#3a1d6e", "#8c2981", "#de4968", "#fe9f6d", "#fcfdbf"].map(
    hex => [1, 3, 5].map(k => parseInt(hex.slice(k, k + 2), 16) / 255));
const SHOWN = 3000;           // points on the sphere
const RADIUS = 0.86;
const THETA_BINS = 45, PHI_BINS = 48, CURVE = 361;
const MOST = 4000000;         // samples at which "keep drawing" stops
const MOST_PARAMETERS = 8;    // hairlut_max_parameters of the shader

const state = {
    model: Object.keys(data.models)[0],
    lobe: HAIR, size: "shipped", samples: 10000,
    theta_r: 20, phi_r: 0, offset: 0, u_theta: 0.5, u_phi: 0.5, u_lobe: 0.25, // angles in degrees
    yaw: 1.0, pitch: 0.35, keep: false,
    parameters: {}, // of each model: the values of its parameters
};

/* ---- random numbers: a 32-bit generator, the upper 24 bits of each state ------------------------------------- */

let seed = 1;

function randomNumbers(n) {
    const numbers = new Float32Array(3 * n);
    for (let k = 0; k < numbers.length; ++k) {
        seed = (seed + 0x9e3779b9) >>> 0;
        let x = seed;
        x = Math.imul(x ^ (x >>> 16), 0x21f0aaad);
        x = Math.imul(x ^ (x >>> 15), 0x735a2d97);
        numbers[k] = ((x ^ (x >>> 15)) >>> 8) / 16777216;
    }
    return numbers;
}

/* ---- WebGL2 --------------------------------------------------------------------------------------------------- */

const sphere = byId("sphere");
const gl = sphere.getContext("webgl2", { antialias: true, preserveDrawingBuffer: true });

const glsl = name => byId(name).textContent.replace(/^\n/, "");
const onModel = name => glsl("model.glsl").replace("//@hairlut", () => glsl("hairlut.glsl")) + glsl(name);

function compiled(kind, source) {
    const shader = gl.createShader(kind);
    gl.shaderSource(shader, source);
    gl.compileShader(shader);
    if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS))
        throw new Error(gl.getShaderInfoLog(shader));
    return shader;
}

/* A program whose varyings named in feedback, if any, are captured; set(name, value) sets a uniform. */
function linked(vertex, fragment, feedback = []) {
    const program = gl.createProgram();
    gl.attachShader(program, compiled(gl.VERTEX_SHADER, vertex));
    gl.attachShader(program, compiled(gl.FRAGMENT_SHADER, fragment));
    if (feedback.length)
        gl.transformFeedbackVaryings(program, feedback, gl.INTERLEAVED_ATTRIBS);
    gl.linkProgram(program);
    if (!gl.getProgramParameter(program, gl.LINK_STATUS))
        throw new Error(gl.getProgramInfoLog(program));
    const at = name => gl.getUniformLocation(program, name);
    return { program, at };
}

let drawing, evaluating, sharing, globe, dots, cloud, capture, source;

function prepare() {
    drawing = linked(onModel("draw.glsl"), glsl("nothing.glsl"), ["drawn"]);
    evaluating = linked(onModel("evaluate.glsl"), glsl("nothing.glsl"), ["evaluated"]);
    sharing = linked(onModel("shares.glsl"), glsl("nothing.glsl"), ["share"]);
    globe = linked(glsl("screen.glsl"), onModel("sphere.glsl"));
    dots = linked(glsl("point.glsl"), glsl("dot.glsl"));
    [cloud, capture, source] = [gl.createBuffer(), gl.createBuffer(), gl.createBuffer()];
    gl.bindTexture(gl.TEXTURE_2D, gl.createTexture());
    for (const filter of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER])
        gl.texParameteri(gl.TEXTURE_2D, filter, gl.NEAREST);
}

const model = () => data.models[state.model];
const tables = () => model().sizes[state.size].tables;
const lobes = () => model().lobes;
const lobeNames = () => [...(lobes().length > 1 ? [HAIR] : []), ...lobes().map(l => l.name)];

/* Numbers of the lobes that are shown. */
function parts() {
    const all = lobes().map((_, k) => k);
    return state.lobe === HAIR ? all : all.filter(k => lobes()[k].name === state.lobe);
}

const used = () => new Set(parts().flatMap(k => lobes()[k].tables));

async function unpacked(text) {
    const bytes = Uint8Array.from(atob(text), c => c.charCodeAt(0));
    const plain = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
    return new Float32Array(await new Response(plain).arrayBuffer());
}

/* Every stream and table as floats, once. */
async function unpackAll() {
    for (const { sizes } of Object.values(data.models))
        for (const size of Object.values(sizes)) {
            size.stream = await unpacked(size.stream);
            for (const table of size.tables)
                table.decoded = await unpacked(table.texels);
        }
}

function upload() {
    const texels = model().sizes[state.size].stream;
    gl.pixelStorei(gl.UNPACK_ALIGNMENT, 4);
    gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, 1024, texels.length / 4096, 0, gl.RGBA, gl.FLOAT, texels);
}

const values = () => state.parameters[state.model] ??= model().parameters.map(each => each.standard);
const viewer = () => [state.theta_r * DEGREE, state.phi_r * DEGREE, state.offset];

function use(p) {
    gl.useProgram(p.program);
    gl.uniform1i(p.at("hairs"), 0);
    gl.uniform3fv(p.at("viewer"), viewer());
    gl.uniform1fv(p.at("parameters"), [...values(), ...Array(MOST_PARAMETERS - values().length).fill(0)]);
    gl.uniform1i(p.at("lobe"), state.lobe === HAIR ? -1 : parts()[0]);
}

/* Runs a vertex shader over n inputs of `size` floats; returns the n outputs of `floats` floats, left in `target`. */
function run(p, name, input, size, floats, target, part = 0) {
    const n = input.length / size;
    use(p);
    gl.uniform1i(p.at("part"), part);
    gl.bindBuffer(gl.ARRAY_BUFFER, source);
    gl.bufferData(gl.ARRAY_BUFFER, input, gl.STREAM_DRAW);
    const slot = gl.getAttribLocation(p.program, name);
    gl.enableVertexAttribArray(slot);
    gl.vertexAttribPointer(slot, size, gl.FLOAT, false, 0, 0);
    gl.bindBuffer(gl.ARRAY_BUFFER, null);
    gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, target);
    gl.bufferData(gl.TRANSFORM_FEEDBACK_BUFFER, n * floats * 4, gl.DYNAMIC_READ);
    gl.enable(gl.RASTERIZER_DISCARD);
    gl.beginTransformFeedback(gl.POINTS);
    gl.drawArrays(gl.POINTS, 0, n);
    gl.endTransformFeedback();
    gl.disable(gl.RASTERIZER_DISCARD);
    const out = new Float32Array(n * floats);
    gl.getBufferSubData(gl.TRANSFORM_FEEDBACK_BUFFER, 0, out);
    gl.bindBufferBase(gl.TRANSFORM_FEEDBACK_BUFFER, 0, null);
    gl.disableVertexAttribArray(slot);
    return out;
}

const draws = numbers => run(drawing, "numbers", numbers, 3, 4, cloud);
const drawOne = numbers => run(drawing, "numbers", numbers, 3, 4, capture);
const evaluate = (directions, part) => run(evaluating, "direction", directions, 2, 3, capture, part);

/* (share, turn, side) of lobe k at each offset. */
const sharesAt = (offsets, k) => run(sharing, "place", Float32Array.from(offsets.flatMap(h => [h, k])), 2, 3, capture);

/* ---- samples, histograms, chi^2 --------------------------------------------------------------------------------- */

let shown = 0, brightest = 1;
const counted = { n: 0, theta: new Float64Array(THETA_BINS), phi: new Float64Array(PHI_BINS) };

function clearCounts() {
    counted.n = 0;
    counted.theta.fill(0);
    counted.phi.fill(0);
}

function drawSamples() {
    const out = draws(randomNumbers(state.samples));
    shown = Math.min(SHOWN, state.samples);
    const solid = [];
    for (let k = 0; k < out.length; k += 4) {
        const theta = (out[k] / Math.PI + 0.5) * THETA_BINS, phi = (out[k + 1] / Math.PI + 1) / 2 * PHI_BINS;
        counted.theta[Math.min(Math.max(Math.floor(theta), 0), THETA_BINS - 1)] += 1;
        counted.phi[Math.min(Math.max(Math.floor(phi), 0), PHI_BINS - 1)] += 1;
        if (k < 4 * SHOWN)
            solid.push(out[k + 3]);
    }
    counted.n += state.samples;
    solid.sort((a, b) => a - b);
    brightest = solid[Math.floor(0.98 * solid.length)];
}

const edges = (n, low, high) => Float64Array.from({ length: n + 1 }, (_, k) => low + (high - low) * k / n);

/* Probability of each bin between the edges along one angle, from the shader's inverse: a difference of two numbers u. The
 * azimuth's numbers start again within the bin where the relative azimuth passes 0, and fall where the hair is mirrored. */
function probabilities(along, at) {
    const directions = new Float32Array(2 * at.length), p = new Float64Array(at.length - 1);
    at.forEach((x, k) => { directions[2 * k + along] = x; });
    for (const part of parts()) {
        const [share, , side] = state.lobe === HAIR ? sharesAt([state.offset], part) : [1, 0, 1];
        const uniform = lobes()[part].tables.length === 1;
        const sign = along === 1 && !uniform && state.lobe === HAIR ? side : 1;
        const u = evaluate(directions, part).filter((_, k) => k % 3 === along);
        let sum = 0;
        for (let k = 0; k < p.length; ++k) {
            let mass = sign * (u[k + 1] - u[k]);
            if (along === 1 && mass < 0)
                mass += 1;
            if (along === 1 && uniform && k === p.length - 1) // the last edge is the first
                mass = Math.max(0, 1 - sum);
            sum += mass;
            p[k] += share * mass;
        }
    }
    return p;
}

function expected(along) {
    return probabilities(along, along ? edges(PHI_BINS, -Math.PI, Math.PI) : edges(THETA_BINS, -Math.PI / 2, Math.PI / 2));
}

/* Pearson's chi^2, neighbouring bins joined until at least five samples are expected. */
function chiSquare(observed, p, n) {
    const bins = [];
    let o = 0, e = 0;
    observed.forEach((count, k) => {
        o += count;
        e += n * p[k];
        if (e >= 5) {
            bins.push([o, e]);
            o = e = 0;
        }
    });
    if (bins.length) {
        bins[bins.length - 1][0] += o;
        bins[bins.length - 1][1] += e;
    }
    const value = bins.reduce((sum, [a, b]) => sum + (a - b) ** 2 / b, 0);
    const degrees = Math.max(bins.length - 1, 1);
    return { value, degrees, p: upperTail(value, degrees) };
}

/* Probability that chi^2 exceeds a value: 1 - P(k/2, x/2), by the series of the lower incomplete gamma function. */
function upperTail(value, degrees) {
    const a = degrees / 2, x = value / 2;
    let logGamma = degrees % 2 ? Math.log(Math.PI) / 2 : 0; // of a, then of a + 1
    for (let g = degrees % 2 ? 0.5 : 1; g <= a; ++g)
        logGamma += Math.log(g);
    let term = Math.exp(a * Math.log(Math.max(x, 1e-300)) - x - logGamma), sum = 0;
    if (term === 0 && x > a) // beyond what a double can tell from 0
        return 0;
    for (let k = 1; k < 5000 && term > 1e-17 * sum; ++k) {
        sum += term;
        term *= x / (a + k);
    }
    return Math.min(Math.max(1 - sum, 0), 1);
}

/* Density per radian along one angle on a fine grid, as differences of the inverse. */
function marginal(along) {
    const [low, high] = along ? [-Math.PI, Math.PI] : [-Math.PI / 2, Math.PI / 2];
    return probabilities(along, edges(CURVE, low, high)).map(p => p * CURVE / (high - low));
}

/* ---- pictures ------------------------------------------------------------------------------------------------- */

/* A canvas's 2D context, sized to the screen's pixels and scaled to CSS pixels. */
function sheet(canvas) {
    const ratio = window.devicePixelRatio || 1, { width, height } = canvas.getBoundingClientRect();
    canvas.width = Math.max(1, Math.round(width * ratio));
    canvas.height = Math.max(1, Math.round(height * ratio));
    const g = canvas.getContext("2d");
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, width, height);
    g.font = "12px system-ui, sans-serif";
    return { g, width, height };
}

function colour(t) {
    const x = Math.min(Math.max(t, 0), 1) * 5, i = Math.min(Math.floor(x), 4);
    return STOPS[i].map((c, k) => 255 * (c + (x - i) * (STOPS[i + 1][k] - c)));
}

function turn() { // world to view, row by row
    const [c, s] = [Math.cos(state.yaw), Math.sin(state.yaw)], [d, t] = [Math.cos(state.pitch), Math.sin(state.pitch)];
    return [c, 0, s, t * s, d, -t * c, -d * s, t, d * c];
}

function onScreen(theta, phi, size) {
    const m = turn(), a = Math.cos(theta);
    const w = [a * Math.cos(phi), Math.sin(theta), -a * Math.sin(phi)];
    const v = [0, 3, 6].map(k => m[k] * w[0] + m[k + 1] * w[1] + m[k + 2] * w[2]);
    const half = size / 2;
    return { x: half + v[0] * RADIUS * half, y: half - v[1] * RADIUS * half, front: v[2] > 0 };
}

function paintSphere() {
    const ratio = window.devicePixelRatio || 1, side = Math.max(1, Math.round(sphere.getBoundingClientRect().width * ratio));
    if (sphere.width !== side)
        sphere.width = sphere.height = side;
    const m = turn(), columns = [0, 3, 6, 1, 4, 7, 2, 5, 8].map(k => m[k]);
    gl.viewport(0, 0, side, side);
    use(globe);
    gl.uniformMatrix3fv(globe.at("turn"), false, columns);
    gl.uniform1f(globe.at("radius"), RADIUS);
    gl.uniform1f(globe.at("pixel"), 2 / (side * RADIUS));
    gl.uniform1f(globe.at("top"), brightest);
    gl.uniform3fv(globe.at("colours"), STOPS.flat());
    gl.disable(gl.BLEND);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    gl.useProgram(dots.program);
    gl.uniformMatrix3fv(dots.at("turn"), false, columns);
    gl.uniform1f(dots.at("radius"), RADIUS);
    gl.uniform1f(dots.at("size"), 2.6 * ratio);
    const slot = gl.getAttribLocation(dots.program, "drawn");
    gl.bindBuffer(gl.ARRAY_BUFFER, cloud);
    gl.enableVertexAttribArray(slot);
    gl.vertexAttribPointer(slot, 4, gl.FLOAT, false, 0, 0);
    gl.enable(gl.BLEND);
    gl.blendFunc(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA);
    gl.drawArrays(gl.POINTS, 0, shown);
    gl.disableVertexAttribArray(slot);
    gl.bindBuffer(gl.ARRAY_BUFFER, null);
    paintMarks();
}

function paintMarks() {
    const { g, width } = sheet(byId("marks"));
    g.lineWidth = 1.5;
    for (const theta of [Math.PI / 2, -Math.PI / 2]) { // the fibre, where it leaves the sphere
        const p = onScreen(theta, 0, width), dx = p.x - width / 2, dy = p.y - width / 2;
        g.strokeStyle = p.front ? "#cfd6df" : "rgba(160,170,185,0.45)";
        g.beginPath();
        g.moveTo(p.front ? p.x : width / 2 + dx * 1.02, p.front ? p.y : width / 2 + dy * 1.02);
        g.lineTo(width / 2 + dx * 1.12, width / 2 + dy * 1.12);
        g.stroke();
    }
    mark(g, onScreen(...viewer().slice(0, 2), width), "viewer", "#ffb454", width);
    mark(g, onScreen(one.theta_i, one.phi_i, width), "sample", "#ffffff", width);
}

function mark(g, p, text, style, width) {
    g.globalAlpha = p.front ? 1 : 0.6;
    g.strokeStyle = g.fillStyle = style;
    g.lineWidth = 2;
    g.setLineDash(p.front ? [] : [3, 3]);
    g.beginPath();
    g.arc(p.x, p.y, 6, 0, 2 * Math.PI);
    g.stroke();
    g.setLineDash([]);
    const label = p.front ? text : `${text}, behind`, w = g.measureText(label).width;
    const x = Math.min(p.x + 11, width - w - 4);
    g.lineWidth = 3;
    g.strokeStyle = "rgba(16,19,24,0.85)";
    g.strokeText(label, x, p.y + 4);
    g.fillText(label, x, p.y + 4);
    g.globalAlpha = 1;
}

function paintRamp() {
    const { g, width, height } = sheet(byId("ramp"));
    for (let x = 0; x < width; ++x) {
        g.fillStyle = `rgb(${colour(x / width)})`;
        g.fillRect(x, 0, 1.5, height);
    }
    byId("top").textContent = `of ${brightest.toPrecision(3)} / sr and more`;
}

/* Axes of a chart; returns maps from values to CSS pixels. */
function axesOf(sheetOf, x, y) {
    const { g, width, height } = sheetOf, left = 44, right = 16, head = 8, foot = 22;
    const px = v => left + (v - x.low) / (x.high - x.low) * (width - left - right);
    const py = v => height - foot - (v - y.low) / (y.high - y.low) * (height - foot - head);
    g.fillStyle = "#9ba6b5";
    g.strokeStyle = "#2a313c";
    g.lineWidth = 1;
    for (const v of y.ticks) {
        g.beginPath();
        g.moveTo(left, py(v));
        g.lineTo(width - right, py(v));
        g.stroke();
        g.textAlign = "right";
        g.fillText(y.text(v), left - 6, py(v) + 4);
    }
    for (const v of x.ticks) {
        g.textAlign = "center";
        g.fillText(x.text ? x.text(v) : `${v}°`.replace("-", "−"), px(v), height - 6);
    }
    g.textAlign = "left";
    return { px, py };
}

function niceTicks(high, count) {
    const raw = high / count, power = 10 ** Math.floor(Math.log10(raw));
    const step = [1, 2, 5, 10].map(k => k * power).find(s => s >= raw * 0.999);
    return Array.from({ length: Math.floor(high / step) + 1 }, (_, k) => k * step);
}

function paintHistogram(canvas, observed, curve, low, high, step) {
    const s = sheet(canvas), bins = observed.length, width = (high - low) / bins;
    const bars = Array.from(observed, c => c / (counted.n * width * DEGREE));
    const top = 1.08 * Math.max(...bars, ...curve);
    const ticks = [];
    for (let v = low; v <= high; v += step)
        ticks.push(v);
    const y = { low: 0, high: top, ticks: niceTicks(top, 4), text: v => String(+v.toPrecision(3)) };
    const { px, py } = axesOf(s, { low, high, ticks }, y);
    s.g.fillStyle = "rgba(255,180,84,0.55)";
    bars.forEach((b, k) => s.g.fillRect(px(low + k * width) + 0.5, py(b), px(low + width) - px(low) - 1, py(0) - py(b)));
    s.g.strokeStyle = "#6fd3ff";
    s.g.lineWidth = 1.8;
    s.g.beginPath();
    curve.forEach((q, k) => s.g.lineTo(px(low + (high - low) * (k + 0.5) / curve.length), py(q)));
    s.g.stroke();
}

function tellFit(id, fit) {
    const p = fit.p < 1e-12 ? "< 1e−12" : `= ${fit.p.toPrecision(3)}`;
    byId(id).innerHTML = `χ² = <b>${fit.value.toFixed(1)}</b> on <b>${fit.degrees}</b> degrees of freedom, `
        + `<span class="${fit.p < 1e-4 ? "bad" : ""}">p <b>${p}</b></span>; ${counted.n.toLocaleString("en")} samples`;
    Object.assign(byId(id).dataset, { value: fit.value, degrees: fit.degrees, p: fit.p });
}

function paintCharts() {
    const [theta, phi] = [marginal(0), marginal(1)];
    paintHistogram(byId("theta_chart"), counted.theta, theta, -90, 90, 30);
    paintHistogram(byId("phi_chart"), counted.phi, phi, -180, 180, 60);
    tellFit("theta_fit", chiSquare(counted.theta, expected(0), counted.n));
    tellFit("phi_fit", chiSquare(counted.phi, expected(1), counted.n));
}

function rowAt(table) {
    const [low, high] = table.theta_r, last = table.height - 1;
    return Math.min(Math.max((viewer()[0] - low) / (high - low) * last, 0), last);
}

/* The node of a table that is nearest to the parameters' values. */
function nodeAt(table) {
    return table.axes.reduce((node, { parameter, nodes }) => {
        const off = nodes.map(x => Math.abs(x - values()[parameter]));
        return node * nodes.length + off.indexOf(Math.min(...off));
    }, 0);
}

/* What a table's picture shows: for one with parameters, the rows of the nearest node. */
function sizeOf(table) {
    const names = table.axes.map(({ parameter, nodes }) => `${nodes.length} ${model().parameters[parameter].name}`);
    const bytes = 8 * table.decoded.length, size = bytes < 1024 ? `${bytes} B` : `${(bytes / 1024).toFixed(1)} KB`;
    return `${table.width}×${table.height}${names.length ? ` for each of ${names.join(" × ")}` : ""}, ${size}`;
}

function paintTextures() {
    const section = byId("textures"), shownTables = used();
    section.innerHTML = tables().map((_, k) => `<figure><figcaption></figcaption><canvas id="texture_${k}" role="img"></canvas>`
        + `<p class="note" id="row_${k}"></p></figure>`).join("");
    tables().forEach((table, k) => {
        const figure = section.children[k], canvas = byId(`texture_${k}`), row = rowAt(table), [low, high] = table.domain;
        const texels = table.width * table.height, x = table.decoded.subarray(nodeAt(table) * texels, (nodeAt(table) + 1) * texels);
        figure.className = shownTables.has(k) ? "" : "unused";
        figure.querySelector("figcaption").innerHTML = `<b>${table.name}</b><br>${sizeOf(table)}`;
        canvas.setAttribute("aria-label", `Angles of ${table.name}: u to the right, theta_r upwards`);
        const image = new ImageData(table.width, table.height);
        x.forEach((value, at) => {
            const j = table.height - 1 - Math.floor(at / table.width), i = at % table.width;
            image.data.set([...colour((value - low) / (high - low)), 255], 4 * (j * table.width + i));
        });
        const small = new OffscreenCanvas(table.width, table.height);
        small.getContext("2d").putImageData(image, 0, 0);
        const { g, width, height } = sheet(canvas);
        g.imageSmoothingEnabled = false;
        g.drawImage(small, 0, 0, width, height);
        const y = (1 - (row + 0.5) / table.height) * height;
        g.strokeStyle = "rgba(16,19,24,0.8)";
        g.lineWidth = 4;
        g.strokeRect(-4, y, width + 8, 0.01);
        g.strokeStyle = "#6fd3ff";
        g.lineWidth = 1.8;
        g.strokeRect(-4, y, width + 8, 0.01);
        byId(`row_${k}`).textContent = `row ${row.toFixed(2)} of ${table.height - 1}; ${degrees(low, 0)} dark to ${degrees(high, 0)} bright`;
    });
}

/* Shares, one upon another, over the offset; beside them a table of those at this offset. */
function paintShares() {
    byId("shares").hidden = lobes().length < 2;
    if (lobes().length < 2)
        return;
    const n = 201, offsets = Array.from({ length: n }, (_, k) => 2 * k / (n - 1) - 1);
    const s = sheet(byId("share_chart"));
    const x = { low: -1, high: 1, ticks: [-1, -0.5, 0, 0.5, 1], text: v => String(v).replace("-", "−") };
    const { px, py } = axesOf(s, x, { low: 0, high: 1, ticks: [0, 0.5, 1], text: String });
    const below = new Float64Array(n);
    lobes().forEach((_, lobe) => {
        const share = sharesAt(offsets, lobe).filter((_, k) => k % 3 === 0), above = below.map((y, k) => y + share[k]);
        s.g.fillStyle = key(lobe);
        s.g.globalAlpha = parts().includes(lobe) ? 0.85 : 0.3;
        s.g.beginPath();
        offsets.forEach((h, k) => s.g.lineTo(px(h), py(above[k])));
        [...offsets].reverse().forEach((h, k) => s.g.lineTo(px(h), py(below[n - 1 - k])));
        s.g.fill();
        below.set(above);
    });
    s.g.globalAlpha = 1;
    s.g.strokeStyle = "#ffb454";
    s.g.lineWidth = 1.6;
    s.g.beginPath();
    s.g.moveTo(px(state.offset), py(0));
    s.g.lineTo(px(state.offset), py(1));
    s.g.stroke();
    byId("share_table").tBodies[0].innerHTML = lobes().map((lobe, k) => {
        const [share, turn, side] = sharesAt([state.offset], k);
        const turned = lobe.tables.length > 1 ? degrees(side * turn, 1) : "–";
        return `<tr class="${parts().includes(k) ? "" : "unused"}" style="--key:${key(k)}"><td>${lobe.name}</td>`
            + `<td id="share_${k}">${share.toFixed(4)}</td><td id="turn_${k}">${turned}</td></tr>`;
    }).join("");
}

/* The measured error nearest to this theta_r: every row and three places between two rows were measured. */
function errorAt(table) {
    const last = table.variance.length - 1;
    const k = Math.round(rowAt(table) / (table.height - 1) * last);
    return { variance: table.variance[k], weight: table.weight[k] };
}

function paintErrors() {
    const known = tables().filter(t => t.variance);
    byId("errors").hidden = !known.length;
    if (!known.length)
        return;
    const logs = known.flatMap(t => t.variance.map(v => Math.log10(Math.max(v, 1e-9))));
    const low = Math.floor(Math.min(...logs)), high = Math.max(Math.ceil(Math.max(...logs)), low + 1);
    const powers = Array.from({ length: high - low + 1 }, (_, k) => low + k);
    const y = { low, high, ticks: powers, text: v => v < 0 ? `1e−${-v}` : `1e${v}` };
    const s = sheet(byId("error_chart"));
    const { px, py } = axesOf(s, { low: -90, high: 90, ticks: [-90, -60, -30, 0, 30, 60, 90] }, y);
    tables().forEach((table, k) => {
        if (!table.variance)
            return;
        s.g.strokeStyle = key(k);
        s.g.globalAlpha = used().has(k) ? 1 : 0.3;
        s.g.lineWidth = 1.6;
        s.g.beginPath();
        table.variance.forEach((v, n) => s.g.lineTo(px(-90 + 180 * n / (table.variance.length - 1)), py(Math.log10(Math.max(v, 1e-9)))));
        s.g.stroke();
    });
    s.g.globalAlpha = 1;
    s.g.strokeStyle = "#ffb454";
    s.g.lineWidth = 1.4;
    s.g.beginPath();
    s.g.moveTo(px(state.theta_r), py(low));
    s.g.lineTo(px(state.theta_r), py(high));
    s.g.stroke();
    byId("error_table").tBodies[0].innerHTML = tables().map((table, k) => {
        const { variance, weight } = errorAt(table);
        return `<tr class="${used().has(k) ? "" : "unused"}" style="--key:${key(k)}"><td>${table.name}</td>`
            + `<td>${rowAt(table).toFixed(2)}</td><td id="variance_${k}">${variance.toExponential(2)}</td>`
            + `<td id="weight_${k}">${weight.toFixed(3)}</td></tr>`;
    }).join("");
}

/* ---- one sample ----------------------------------------------------------------------------------------------- */

let one = { theta_i: 0, phi_i: 0 };

const degrees = (angle, digits) => `${(angle / DEGREE).toFixed(digits)}°`.replace("-", "−");

function tellOne() {
    const s = drawOne(new Float32Array([state.u_theta, state.u_phi, state.u_lobe]));
    one = { theta_i: s[0], phi_i: s[1], pdf_angle: s[2], pdf_solid_angle: s[3] };
    for (const [name, value] of Object.entries(one))
        byId(name).textContent = value.toPrecision(7).replace("-", "−");
    for (const name of ["theta_i", "phi_i"])
        byId(`${name}_degrees`).textContent = degrees(one[name], 3);
    const [u_theta, u_phi, density] = evaluate(new Float32Array([s[0], s[1]]), parts()[0]);
    byId("back").textContent = state.lobe === HAIR ? "–" : `u = (${u_theta.toFixed(6)}, ${u_phi.toFixed(6)})`;
    one.inverted = [u_theta, u_phi];
    one.density = density;
}

/* ---- controls ------------------------------------------------------------------------------------------------- */

const SLIDERS = {
    theta_r: v => `${v.toFixed(1)}°`, phi_r: v => `${v.toFixed(0)}°`, offset: v => `${v.toFixed(2)} = sin ${degrees(Math.asin(v), 1)}`,
    u_theta: v => v.toFixed(3), u_phi: v => v.toFixed(3), u_lobe: v => v.toFixed(3),
};

function radios(name, values, text) {
    if (!values.includes(state[name]))
        state[name] = values[0];
    byId(name).innerHTML = values.map(v => `<label><input type="radio" name="${name}" value="${v}"`
        + `${state[name] === v ? " checked" : ""}>${text(v)}</label>`).join("");
}

/* A slider for each parameter of the model. */
function parameterSliders() {
    byId("parameters").hidden = !model().parameters.length;
    byId("parameter_sliders").innerHTML = model().parameters.map((each, p) =>
        `<label class="slider"><span>${each.name}</span> <output id="parameter_${p}_text"></output>`
        + `<input type="range" id="parameter_${p}" min="${each.least}" max="${each.most}" step="any">`
        + `<span class="note">${each.least} to ${each.most}, standard ${each.standard}</span></label>`).join("");
    model().parameters.forEach((_, p) => {
        const slider = byId(`parameter_${p}`);
        slider.value = values()[p];
        slider.addEventListener("input", () => {
            values()[p] = Number(slider.value);
            changed();
        });
    });
}

/* What a model offers to choose from. */
function offered() {
    radios("lobe", lobeNames(), v => v);
    const order = (a, b) => (b === "shipped") - (a === "shipped") || a - b;
    radios("size", Object.keys(model().sizes).sort(order), v => v === "shipped" ? v : `${v}²`);
    parameterSliders();
}

function controls() {
    radios("model", Object.keys(data.models), v => v);
    radios("samples", [1000, 10000, 100000], v => v.toLocaleString("en"));
    offered();
    for (const name of ["model", "lobe", "size", "samples"])
        byId(name).addEventListener("change", event => {
            state[name] = name === "samples" ? Number(event.target.value) : event.target.value;
            if (name === "model")
                offered();
            changed();
        });
    for (const name of Object.keys(SLIDERS)) {
        byId(name).value = state[name];
        byId(name).addEventListener("input", event => {
            state[name] = Number(event.target.value);
            changed();
        });
    }
    byId("again").addEventListener("click", changed);
    byId("keep").addEventListener("change", event => {
        state.keep = event.target.checked;
        schedule();
    });
    sphere.addEventListener("pointerdown", event => sphere.setPointerCapture(event.pointerId));
    sphere.addEventListener("pointermove", event => {
        if (event.buttons)
            turnBy(event.movementX * 0.008, event.movementY * 0.008);
    });
    sphere.addEventListener("keydown", event => {
        const step = { ArrowLeft: [-0.1, 0], ArrowRight: [0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
        if (step) {
            turnBy(...step);
            event.preventDefault();
        }
    });
    new ResizeObserver(() => schedule("paint")).observe(document.body);
}

function turnBy(yaw, pitch) {
    state.yaw += yaw;
    state.pitch = Math.min(Math.max(state.pitch + pitch, -Math.PI / 2), Math.PI / 2);
    schedule("turn");
}

/* ---- from a change to a picture ------------------------------------------------------------------------------- */

let ready = false, waiting = null; // "turn" repaints the sphere, "paint" everything, "draw" also draws new samples

function schedule(what = state.keep ? "more" : "paint") {
    const order = ["turn", "paint", "more", "draw"];
    if (waiting === null)
        requestAnimationFrame(update);
    if (waiting === null || order.indexOf(what) > order.indexOf(waiting))
        waiting = what;
}

function changed() {
    schedule("draw");
}

function update() {
    const what = waiting;
    waiting = null;
    if (what === "draw")
        clearCounts();
    if (what === "draw")
        upload();
    if (what === "draw" || what === "more")
        drawSamples();
    if (what !== "turn") {
        for (const [name, text] of Object.entries(SLIDERS))
            byId(`${name}_text`).textContent = text(state[name]).replace("-", "−");
        values().forEach((value, p) => { byId(`parameter_${p}_text`).textContent = value.toPrecision(4).replace("-", "−"); });
        byId("offset_label").className = byId("u_lobe_label").className = state.lobe === HAIR ? "slider" : "slider off";
        byId("offset").disabled = byId("u_lobe").disabled = state.lobe !== HAIR;
        tellOne();
        paintRamp();
        paintCharts();
    }
    if (what === "draw" || what === "paint") {
        paintTextures();
        paintShares();
        paintErrors();
    }
    paintSphere();
    if (state.keep && counted.n < MOST)
        schedule("more");
}

async function start() {
    byId("version").textContent = data.version;
    window.explorer = { state, counted, one: () => one, idle: () => ready && waiting === null };
    if (!gl)
        throw new Error("this browser offers no WebGL2");
    await unpackAll();
    prepare();
    controls();
    changed();
    ready = true;
}

start().catch(error => {
    byId("trouble").textContent = `The explorer cannot run: ${error.message}`;
    byId("trouble").hidden = false;
});
