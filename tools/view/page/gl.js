// What WebGL2 needs for programs, buffers and the texture of positions.

function compile(gl, type, source) {
  const shader = gl.createShader(type);
  gl.shaderSource(shader, "#version 300 es\nprecision highp float;\nprecision highp sampler2D;\n" + source);
  gl.compileShader(shader);
  if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) throw new Error(gl.getShaderInfoLog(shader));
  return shader;
}

/** Returns a program with its uniforms by name. */
export function makeProgram(gl, vertex, fragment) {
  const program = gl.createProgram();
  gl.attachShader(program, compile(gl, gl.VERTEX_SHADER, vertex));
  gl.attachShader(program, compile(gl, gl.FRAGMENT_SHADER, fragment));
  gl.linkProgram(program);
  if (!gl.getProgramParameter(program, gl.LINK_STATUS)) throw new Error(gl.getProgramInfoLog(program));
  const uniforms = {};
  for (let i = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS); i > 0; --i) {
    const { name } = gl.getActiveUniform(program, i - 1);
    uniforms[name] = gl.getUniformLocation(program, name);
  }
  return { program, uniforms };
}

/** Points in a texture, so that whatever is drawn names them by number. */
export class PointTexture {
  static width = 1024;

  constructor(gl) {
    this.gl = gl;
    this.texture = gl.createTexture();
    this.rows = 0;
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    for (const key of [gl.TEXTURE_MIN_FILTER, gl.TEXTURE_MAG_FILTER]) gl.texParameteri(gl.TEXTURE_2D, key, gl.NEAREST);
  }

  /** Puts points in: x, y, z and a number of each. */
  fill(points) {
    const gl = this.gl, width = PointTexture.width;
    const rows = Math.max(1, Math.ceil(points.length / 4 / width));
    gl.bindTexture(gl.TEXTURE_2D, this.texture);
    if (rows !== this.rows) {
      gl.texImage2D(gl.TEXTURE_2D, 0, gl.RGBA32F, width, rows, 0, gl.RGBA, gl.FLOAT, null);
      this.rows = rows;
      this.padded = new Float32Array(4 * width * rows);
    }
    this.padded.set(points);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, width, rows, gl.RGBA, gl.FLOAT, this.padded);
  }
}

/** Returns a vertex array of instances. `lists` has attributes as [size, array, whether of whole numbers]. */
export function makeInstances(gl, lists) {
  const array = gl.createVertexArray();
  gl.bindVertexArray(array);
  const buffers = lists.map(([size, data, whole], i) => {
    const buffer = gl.createBuffer();
    gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
    gl.bufferData(gl.ARRAY_BUFFER, data, gl.DYNAMIC_DRAW);
    gl.enableVertexAttribArray(i);
    if (whole) gl.vertexAttribIPointer(i, size, gl.UNSIGNED_INT, 0, 0);
    else gl.vertexAttribPointer(i, size, gl.FLOAT, false, 0, 0);
    gl.vertexAttribDivisor(i, 1);
    return buffer;
  });
  gl.bindVertexArray(null);
  return { array, buffers, count: lists[0][1].length / lists[0][0] };
}

/** Returns a vertex array of triangles with a normal at each corner. */
export function makeTriangles(gl, corners) {
  const array = gl.createVertexArray(), buffer = gl.createBuffer();
  gl.bindVertexArray(array);
  gl.bindBuffer(gl.ARRAY_BUFFER, buffer);
  gl.bufferData(gl.ARRAY_BUFFER, corners, gl.DYNAMIC_DRAW);
  for (const i of [0, 1]) {
    gl.enableVertexAttribArray(i);
    gl.vertexAttribPointer(i, 3, gl.FLOAT, false, 24, 12 * i);
  }
  gl.bindVertexArray(null);
  return { array, buffer, count: corners.length / 6 };
}
